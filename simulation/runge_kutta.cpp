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

const Tableau& classical() {
  static const Tableau t{4, {{}, {0.5}, {0, 0.5}, {0, 0, 1}}, {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6}, {}, false};
  return t;
}

const Tableau& dormand_prince() {
  static const Tableau t{7,
                         {{},
                          {1.0 / 5},
                          {3.0 / 40, 9.0 / 40},
                          {44.0 / 45, -56.0 / 15, 32.0 / 9},
                          {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
                          {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
                          {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}},
                         {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84, 0},
                         {71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40},
                         true};
  return t;
}

template <class T> RungeKutta<T>::RungeKutta(const Model& model, const Tableau& tableau) : tableau_(&tableau) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const JointType type = model.bodies[i].joint.type;
    joints_.push_back({type, model.first_q[i], model.first_dof[i], dof_count(type)});
  }
  zero_ = x_ = w_ = w_stage_ = VectorX<T>::Constant(model.dofs(), T(0));
  x_rate_.assign(static_cast<std::size_t>(tableau.stages), zero_);
  w_rate_ = x_rate_;
}

template <class T> void RungeKutta<T>::place(const VectorX<T>& x, const VectorX<T>& w, State<T>& out) const {
  out.q = q_;
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

template <class T> bool RungeKutta<T>::rates(const VectorX<T>& x, const VectorX<T>& w, const Acceleration& acceleration, int stage) {
  VectorX<T>&x_rate = x_rate_[static_cast<std::size_t>(stage)], &w_rate = w_rate_[static_cast<std::size_t>(stage)];
  place(x, w, at_);
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

template <class T> void RungeKutta<T>::start(const State<T>& state) {
  q_ = state.q;
  w_ = state.nu;
  for (const Joint& j : joints_)
    if (j.type == JointType::floating) w_.template segment<3>(j.dof + 3) = rotate(state.q.data() + j.q + 3, three_of(state.nu.data() + j.dof + 3), false);
  started_ = false;
}

/// x and w at y₀ + h Σ weight_j k_j.
template <class T> void RungeKutta<T>::sum(const double* weights, int stages) {
  x_ = zero_, w_stage_ = w_;
  for (int j = 0; j < stages; ++j) {
    if (weights[j] == 0) continue;
    const T by = h_ * T(weights[j]);
    x_ += by * x_rate_[static_cast<std::size_t>(j)];
    w_stage_ += by * w_rate_[static_cast<std::size_t>(j)];
  }
}

template <class T> bool RungeKutta<T>::attempt(const T& h, const Acceleration& acceleration) {
  h_ = h;
  started_ = started_ || rates(zero_, w_, acceleration, 0);
  if (!started_) return false;
  for (int k = 1; k < tableau_->stages; ++k) {
    sum(tableau_->a[k], k);
    if (!rates(x_, w_stage_, acceleration, k)) return false;
  }
  sum(tableau_->b, tableau_->stages);
  return true;
}

template <class T> T RungeKutta<T>::error() const {
  using std::abs;
  T largest(0);
  for (Index i = 0; i < zero_.size(); ++i) {
    T x(0), w(0);
    for (int k = 0; k < tableau_->stages; ++k) {
      x += T(tableau_->e[k]) * x_rate_[static_cast<std::size_t>(k)][i];
      w += T(tableau_->e[k]) * w_rate_[static_cast<std::size_t>(k)][i];
    }
    for (const T& part : {T(abs(h_ * x)), T(abs(h_ * w))}) {
      if (!(part == part)) return part;  // NaN
      if (part > largest) largest = part;
    }
  }
  return largest;
}

template <class T> void RungeKutta<T>::accept(State<T>& end) {
  place(x_, w_stage_, at_);
  q_ = end.q = at_.q;
  end.nu = at_.nu;
  w_ = w_stage_;
  started_ = tableau_->first_is_last;
  if (!started_) return;
  x_rate_[0] = w_;
  w_rate_[0] = w_rate_[static_cast<std::size_t>(tableau_->stages - 1)];
}

template class RungeKutta<double>;
template class RungeKutta<Counted>;

}  // namespace delassus::simulation
