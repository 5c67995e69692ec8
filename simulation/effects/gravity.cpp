#include "simulation/effects/gravity.h"

#include "algorithms/kit/counted.h"

namespace delassus::simulation {

bool has_gravity(const Scene& scene) { return scene.has_gravity && (scene.gravity.array() != 0).any(); }

template <class T> void Gravity<T>::add_force(Moment<T>& now) {
  const Problem<T>& p = *now.problem;
  const Structure& s = *p.structure;
  for (Index i = 0; i < s.bodies(); ++i) {
    const Matrix6<T>& H = p.H[static_cast<std::size_t>(i)];
    const Vector3<T> mc(H(2, 4), H(0, 5), H(1, 3));
    wrench_[i] << mc.cross(g_), H(3, 3) * g_;
  }
  for (Index i = s.bodies(); i-- > 0;) {
    for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) (*now.force)[k] += p.S[k].dot(wrench_[i]);
    if (s.parent[i] != ground) wrench_[s.parent[i]] += wrench_[i];
  }
}

template class Gravity<double>;
template class Gravity<Counted>;

}  // namespace delassus::simulation
