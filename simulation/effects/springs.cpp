#include "simulation/effects/springs.h"

#include "algorithms/kit/counted.h"

namespace delassus::simulation {

bool acts(const SceneMotion::Spring& s) { return s.stiffness != 0 || s.damping != 0; }

template <class T> Springs<T>::Springs(const Model& model, const std::vector<SceneMotion::Spring>& springs) {
  for (const auto& s : springs)
    if (acts(s)) springs_.push_back({model.first_dof[static_cast<std::size_t>(s.body)] + s.dof, SceneMotion::coordinate(model, s.body, s.dof), T(s.stiffness), T(s.rest), T(s.damping)});
}

template <class T> void Springs<T>::add_inertia(Moment<T>& now) {
  for (const Spring& s : springs_) now.problem->armature[s.dof] += now.h * (s.damping + now.h * s.stiffness);
}

template <class T> void Springs<T>::add_force(Moment<T>& now) {
  const VectorX<T>&q = now.state->q, &nu = now.state->nu;
  for (const Spring& s : springs_) {
    const T stretch = s.q < 0 ? T(0) : T(q[s.q] - s.rest + now.ahead * nu[s.dof]);
    (*now.force)[s.dof] -= s.stiffness * stretch + s.damping * nu[s.dof];
  }
}

template <class T> JointDamping<T>::JointDamping(const Model& model) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const std::vector<double>& d = model.bodies[i].joint.damping;
    for (std::size_t k = 0; k < d.size(); ++k)
      if (d[k] != 0) damped_.push_back({model.first_dof[i] + static_cast<Index>(k), T(d[k])});
  }
}

template <class T> void JointDamping<T>::add_inertia(Moment<T>& now) {
  for (const Damped& d : damped_) now.problem->armature[d.dof] += now.h * d.damping;
}

template <class T> void JointDamping<T>::add_force(Moment<T>& now) {
  for (const Damped& d : damped_) (*now.force)[d.dof] -= d.damping * now.state->nu[d.dof];
}

template class Springs<double>;
template class Springs<Counted>;
template class JointDamping<double>;
template class JointDamping<Counted>;

}  // namespace delassus::simulation
