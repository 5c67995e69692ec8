#include "simulation/effects/wrenches.h"

#include "algorithms/kit/counted.h"

namespace delassus::simulation {

template <class T> Wrenches<T>::Wrenches(const std::vector<SceneMotion::Wrench>& wrenches) {
  for (const auto& w : wrenches)
    acting_.push_back({w.at.body, w.at.placement.translation.cast<T>(), w.force.cast<T>(), w.moment.cast<T>()});
}

template <class T> void Wrenches<T>::add_force(Moment<T>& now) {
  const Problem<T>& p = *now.problem;
  const Structure& s = *p.structure;
  for (const Acting& a : acting_) {
    const Poses<T>& at = now.poses();
    const Vector3<T> point = at.position[a.body] + at.rotation[a.body] * a.point;
    Vector6<T> wrench;
    wrench << point.cross(a.force) + a.moment, a.force;
    for (Index i = a.body; i != ground; i = s.parent[i])
      for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) (*now.force)[k] += p.S[k].dot(wrench);
  }
}

template class Wrenches<double>;
template class Wrenches<Counted>;

}  // namespace delassus::simulation
