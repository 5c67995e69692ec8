#include "simulation/runge_kutta.h"

#include "algorithms/kit/counted.h"
#include "simulation/rotations.h"

namespace delassus::simulation {
namespace {

/// u̇ of R = R₀ exp(û) that turns with ω in body axes.
template <class T> Vector3<T> tangent_rate(const Vector3<T>& u, const Vector3<T>& omega) {
  const Vector3<T> once = u.cross(omega), twice = u.cross(once);
  return omega + once / T(2) + twice / T(12);
}

}  // namespace

template <class T> RungeKutta<T>::RungeKutta(const Model& model) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const JointType type = model.bodies[i].joint.type;
    joints_.push_back({type, model.first_q[i], model.first_dof[i], dof_count(type)});
  }
  zero_ = x_ = w_ = w_stage_ = VectorX<T>::Constant(model.dofs(), T(0));
  for (int k = 0; k < 4; ++k) x_rate_[k] = w_rate_[k] = zero_;
}

template <class T> void RungeKutta<T>::place(const State<T>& start, const VectorX<T>& x, const VectorX<T>& w, State<T>& out) const {
  out.q = start.q;
  out.nu = w;
  for (const Joint& j : joints_) {
    T* const q = out.q.data() + j.q;
    T* const nu = out.nu.data() + j.dof;
    const T* const by = x.data() + j.dof;
    if (j.type == JointType::spherical) {
      turn(q, three_of(by));
    } else if (j.type == JointType::floating) {
      for (Index k = 0; k < 3; ++k) q[k] += by[3 + k];
      turn(q + 3, three_of(by));
      const Vector3<T> v = rotate(q + 3, three_of(nu + 3), true);
      for (Index k = 0; k < 3; ++k) nu[3 + k] = v[k];
    } else {
      for (Index k = 0; k < j.n; ++k) q[k] += by[k];
    }
  }
}

template <class T>
bool RungeKutta<T>::rates(const State<T>& start, const VectorX<T>& x, const VectorX<T>& w, const Acceleration& acceleration, VectorX<T>& x_rate,
                          VectorX<T>& w_rate) {
  place(start, x, w, at_);
  if (!acceleration(at_, w_rate)) return false;
  x_rate = w;
  for (const Joint& j : joints_) {
    if (j.type != JointType::spherical && j.type != JointType::floating) continue;
    x_rate.template segment<3>(j.dof) = tangent_rate(three_of(x.data() + j.dof), three_of(w.data() + j.dof));
    if (j.type == JointType::floating)
      w_rate.template segment<3>(j.dof + 3) = rotate(at_.q.data() + j.q + 3, three_of(w_rate.data() + j.dof + 3), false);
  }
  return true;
}

template <class T> bool RungeKutta<T>::operator()(const T& h, State<T>& state, const Acceleration& acceleration) {
  w_ = state.nu;
  for (const Joint& j : joints_)
    if (j.type == JointType::floating) w_.template segment<3>(j.dof + 3) = rotate(state.q.data() + j.q + 3, three_of(state.nu.data() + j.dof + 3), false);
  const T half = h / T(2), part[4] = {T(0), half, half, h};
  for (int k = 0; k < 4; ++k) {
    if (k == 0) x_ = zero_, w_stage_ = w_;
    else x_ = part[k] * x_rate_[k - 1], w_stage_ = w_ + part[k] * w_rate_[k - 1];
    if (!rates(state, x_, w_stage_, acceleration, x_rate_[k], w_rate_[k])) return false;
  }
  x_ = h / T(6) * (x_rate_[0] + T(2) * (x_rate_[1] + x_rate_[2]) + x_rate_[3]);
  w_stage_ = w_ + h / T(6) * (w_rate_[0] + T(2) * (w_rate_[1] + w_rate_[2]) + w_rate_[3]);
  place(state, x_, w_stage_, at_);
  state.q = at_.q;
  state.nu = at_.nu;
  ++state.steps;
  return true;
}

template class RungeKutta<double>;
template class RungeKutta<Counted>;

}  // namespace delassus::simulation
