#include "simulation/state.h"

#include "algorithms/kit/counted.h"
#include "simulation/rotations.h"

namespace delassus::simulation {

template <class T> Advance<T>::Advance(const Model& model) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const JointType type = model.bodies[i].joint.type;
    joints_.push_back({type, model.first_q[i], model.first_dof[i], dof_count(type)});
  }
}

template <class T> Advance<T>::Advance(const Model& model, const std::vector<Index>& bodies) {
  Index dof = 0;
  for (const Index i : bodies) {
    const JointType type = model.bodies[static_cast<std::size_t>(i)].joint.type;
    joints_.push_back({type, model.first_q[static_cast<std::size_t>(i)], dof, dof_count(type)});
    dof += dof_count(type);
  }
}

template <class T> void Advance<T>::operator()(const T& h, VectorX<T>& q, VectorX<T>& nu) const {
  for (const Joint& j : joints_) {
    T* const at = q.data() + j.q;
    T* const rate = nu.data() + j.dof;
    if (j.type == JointType::spherical) {
      turn(at, Vector3<T>(h * three_of(rate)));
    } else if (j.type == JointType::floating) {
      const Vector3<T> v = rotate(at + 3, three_of(rate + 3), false);
      for (Index k = 0; k < 3; ++k) at[k] += h * v[k];
      turn(at + 3, Vector3<T>(h * three_of(rate)));
      const Vector3<T> back = rotate(at + 3, v, true);
      for (Index k = 0; k < 3; ++k) rate[3 + k] = back[k];
    } else {
      for (Index k = 0; k < j.n; ++k) at[k] += h * rate[k];
    }
  }
}

template <class T> void Advance<T>::displace(const VectorX<T>& d, VectorX<T>& q) const {
  for (const Joint& j : joints_) {
    T* const at = q.data() + j.q;
    const T* const by = d.data() + j.dof;
    if (j.type == JointType::spherical) {
      turn(at, three_of(by));
    } else if (j.type == JointType::floating) {
      const Vector3<T> move = rotate(at + 3, three_of(by + 3), false);
      for (Index k = 0; k < 3; ++k) at[k] += move[k];
      turn(at + 3, three_of(by));
    } else {
      for (Index k = 0; k < j.n; ++k) at[k] += by[k];
    }
  }
}

template class Advance<double>;
template class Advance<Counted>;

}  // namespace delassus::simulation
