#include "simulation/effects/actuation.h"

#include "algorithms/kit/counted.h"

namespace delassus::simulation {

bool acts(const SceneMotion::Motor& m) { return m.effort > 0 && (m.torque != 0 || m.stiffness != 0 || m.damping != 0); }

template <class T> Motors<T>::Motors(const Model& model, const std::vector<SceneMotion::Motor>& motors) {
  for (const auto& m : motors)
    if (acts(m))
      motors_.push_back({model.first_dof[static_cast<std::size_t>(m.body)] + m.dof, SceneMotion::coordinate(model, m.body, m.dof), T(m.torque),
                         T(m.stiffness), T(m.damping), T(m.target), T(m.effort), T(0)});
}

template <class T> void Motors<T>::add_inertia(Moment<T>& now) {
  const VectorX<T>&q = now.state->q, &nu = now.state->nu;
  for (Motor& m : motors_) {
    const T missing = m.q < 0 ? T(0) : T(m.target - q[m.q] - now.ahead * nu[m.dof]);
    const T then = m.now;
    m.now = m.torque + m.stiffness * missing - m.damping * nu[m.dof];
    if (m.now > m.effort && !(now.again && then <= -m.effort)) m.now = m.effort;
    else if (m.now < -m.effort && !(now.again && then >= m.effort)) m.now = -m.effort;
    else now.problem->armature[m.dof] += now.h * (m.damping + now.h * m.stiffness);
  }
}

template <class T> void Motors<T>::add_force(Moment<T>& now) {
  for (const Motor& m : motors_) (*now.force)[m.dof] += m.now;
}

template class Motors<double>;
template class Motors<Counted>;

}  // namespace delassus::simulation
