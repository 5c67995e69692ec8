// The classical method of Runge and Kutta, order 4, on the manifold: for scenes without rows.
//
//   q = q₀ ⊕ x,   ẋ = ν but for rotations:   u̇ = ω + ½ u × ω + 1/12 u × (u × ω),  R = R₀ exp(û)     (the series ends at the order needed)
//   ν̇ = M⁻¹ f(q, ν), everything explicit: M̂ = M. Velocities of floating joints in the axes of the joint, as in state.h.
// Cost     four evaluations of the terms and four factors a step. Stable only where h is small against every spring and damper.
// Source   H. Munthe-Kaas 1998.
#pragma once

#include <functional>

#include "simulation/state.h"

namespace delassus::simulation {

template <class T> class RungeKutta {
 public:
  /// ν̇ at (q, ν), in the axes at q: what M⁻¹ f gives with ω × v of floating joints left to the axes. False where it fails.
  using Acceleration = std::function<bool(const State<T>& at, VectorX<T>& acceleration)>;

  explicit RungeKutta(const Model& model);
  /// One step of h. False, and the state as it was, where an evaluation fails.
  bool operator()(const T& h, State<T>& state, const Acceleration& acceleration);

 private:
  struct Joint {
    JointType type;
    Index q, dof, n;
  };
  /// The state at tangent x from the start and velocities w, floating ones in the axes of the joint.
  void place(const State<T>& start, const VectorX<T>& x, const VectorX<T>& w, State<T>& out) const;
  bool rates(const State<T>& start, const VectorX<T>& x, const VectorX<T>& w, const Acceleration& acceleration, VectorX<T>& x_rate, VectorX<T>& w_rate);

  std::vector<Joint> joints_;
  State<T> at_;
  VectorX<T> w_, x_, w_stage_, zero_;
  VectorX<T> x_rate_[4], w_rate_[4];
};

}  // namespace delassus::simulation
