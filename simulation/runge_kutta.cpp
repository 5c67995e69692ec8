#include "simulation/runge_kutta.h"

#include <algorithm>

#include "algorithms/kit/counted.h"
#include "simulation/rotations.h"

namespace delassus::simulation {
namespace {

/// u̇ of R = R₀ exp(û) that turns with ω in body axes.
template <class T> Vector3<T> tangent_rate(const Vector3<T>& u, const Vector3<T>& omega) {
  const Vector3<T> once = u.cross(omega), twice = u.cross(once);
  return omega + once / T(2) + twice / T(12);
}

/// Largest |after − before|.
template <class T> T largest_change(const VectorX<T>& before, const VectorX<T>& after) {
  using std::abs;
  T out(0);
  for (Index k = 0; k < before.size(); ++k) {
    const T by = abs(after[k] - before[k]);
    if (!(by == by)) return by;  // NaN
    if (by > out) out = by;
  }
  return out;
}

}  // namespace

template <class T> RungeKutta<T>::RungeKutta(const Model& model, const Tableau& tableau) : tableau_(&tableau) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const JointType type = model.bodies[i].joint.type;
    joints_.push_back({type, model.first_q[i], model.first_dof[i], dof_count(type)});
  }
  zero_ = x_ = w_ = w_stage_ = VectorX<T>::Constant(model.dofs(), T(0));
  if (tableau.implicit()) x_base_ = w_base_ = x_then_ = w_then_ = zero_;
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

/// ẋ = A(x) w.
template <class T> void RungeKutta<T>::tangent(const VectorX<T>& x, const VectorX<T>& w, VectorX<T>& out) const {
  out = w;
  for (const Joint& j : joints_)
    if (j.type == JointType::spherical || j.type == JointType::floating)
      out.template segment<3>(j.dof) = tangent_rate(three_of(x.data() + j.dof), three_of(w.data() + j.dof));
}

/// ẇ at x and w, floating joints in the axes of the joint; of implicit stages what was there is the guess.
template <class T> bool RungeKutta<T>::rate(const VectorX<T>& x, const VectorX<T>& w, const T& g, bool again, const Acceleration& acceleration, VectorX<T>& out) {
  place(x, w, at_);
  const auto turn_all = [&](bool inverse) {
    for (const Joint& j : joints_)
      if (j.type == JointType::floating) out.template segment<3>(j.dof + 3) = rotate(at_.q.data() + j.q + 3, three_of(out.data() + j.dof + 3), inverse);
  };
  if (g != T(0)) turn_all(true);
  if (!acceleration(at_, {g, again}, out)) return false;
  turn_all(false);
  return true;
}

template <class T> bool RungeKutta<T>::explicit_stage(int stage, const Acceleration& acceleration) {
  tangent(x_, w_stage_, x_rate_[static_cast<std::size_t>(stage)]);
  return rate(x_, w_stage_, T(0), false, acceleration, w_rate_[static_cast<std::size_t>(stage)]);
}

template <class T> bool RungeKutta<T>::implicit_stage(int stage, const Acceleration& acceleration) {
  const T g = h_ * T(tableau_->a[stage][stage]);
  VectorX<T>&x_rate = x_rate_[static_cast<std::size_t>(stage)], &a = w_rate_[static_cast<std::size_t>(stage)];
  x_base_ = x_, w_base_ = w_stage_;
  a = stage > 0 ? w_rate_[static_cast<std::size_t>(stage - 1)] : zero_;
  w_stage_ = w_base_ + g * a, x_ = x_base_ + g * w_stage_;
  T before(0);
  for (int k = 0; k < most_iterations; ++k) {
    // a ← M̂⁻¹(f + D a), D = M̂ − M
    if (!rate(x_, w_stage_, g, k > 0, acceleration, a)) return false;
    ++iterations_;
    w_then_ = w_base_ + g * a;
    tangent(x_, w_then_, x_rate);
    x_then_ = x_base_ + g * x_rate;
    const T change = std::max(largest_change(w_stage_, w_then_), largest_change(x_, x_then_)), size = std::max(T(1), largest_change(zero_, w_then_));
    x_.swap(x_then_), w_stage_.swap(w_then_);
    change_ = change / size;
    if (change_ <= T(settled) || (k > 0 && change_ <= T(within) && change + change >= before)) {
      left_ = std::max(left_, change_);
      return true;
    }
    before = change;
  }
  return false;
}

template <class T> void RungeKutta<T>::start(const State<T>& state) {
  q_ = state.q;
  w_ = state.nu;
  for (const Joint& j : joints_)
    if (j.type == JointType::floating) w_.template segment<3>(j.dof + 3) = rotate(state.q.data() + j.q + 3, three_of(state.nu.data() + j.dof + 3), false);
  started_ = tableau_->implicit();
  iterations_ = 0;
  left_ = T(0);
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
  stage_ = 0;
  if (!started_) {
    sum(tableau_->a[0], 0);
    started_ = explicit_stage(0, acceleration);
    if (!started_) return false;
  }
  for (stage_ = tableau_->implicit() ? 0 : 1; stage_ < tableau_->stages; ++stage_) {
    sum(tableau_->a[stage_], stage_);
    if (!(tableau_->implicit() ? implicit_stage(stage_, acceleration) : explicit_stage(stage_, acceleration))) return false;
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
  started_ = tableau_->first_is_last || tableau_->implicit();
  if (!tableau_->first_is_last) return;
  x_rate_[0] = w_;
  w_rate_[0] = w_rate_[static_cast<std::size_t>(tableau_->stages - 1)];
}

template class RungeKutta<double>;
template class RungeKutta<Counted>;

}  // namespace delassus::simulation
