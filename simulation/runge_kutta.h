// Explicit methods of Runge and Kutta on the manifold, by their tableau: for scenes without rows.
//
//   q = q₀ ⊕ x,   ẋ = ν but for rotations:   u̇ = ω + ½ u × ω + 1/12 u × (u × ω),  R = R₀ exp(û)
//              as u × ω is of order h², the series is off by h⁵, a step by h⁶: enough for order 5
//   ν̇ = M⁻¹ f(q, ν), everything explicit: M̂ = M. Velocities of floating joints in the axes of the joint, as in state.h.
//   stages     k_i = f(y₀ + h Σ a_ij k_j),   y = y₀ + h Σ b_i k_i
//   error      h Σ e_i k_i, the difference from the answer of lower order: of pairs only
// Cost     an evaluation of the terms and a factor for each stage. Stable only where h is small against every spring and damper.
// Source   H. Munthe-Kaas 1998; W. Kutta 1901; J. Dormand, P. Prince 1980.
#pragma once

#include <functional>

#include "simulation/state.h"

namespace delassus::simulation {

/// c_i = Σ a_ij is not needed: nothing depends on time.
struct Tableau {
  int stages;
  double a[7][6];
  double b[7];
  double e[7];         ///< b − b̂; all zero: no pair
  bool first_is_last;  ///< the last stage is the first of the next step
};

[[nodiscard]] const Tableau& classical();       ///< order 4
[[nodiscard]] const Tableau& dormand_prince();  ///< order 5, its error by order 4

template <class T> class RungeKutta {
 public:
  /// ν̇ at (q, ν), in the axes at q: what M⁻¹ f gives with ω × v of floating joints left to the axes. False where it fails.
  using Acceleration = std::function<bool(const State<T>& at, VectorX<T>& acceleration)>;

  RungeKutta(const Model& model, const Tableau& tableau);
  /// Where the steps go on from.
  void start(const State<T>& state);
  /// A step of h from there, not taken yet; may be repeated with another h. False where an evaluation fails.
  bool attempt(const T& h, const Acceleration& acceleration);
  /// The evaluation at the start did not fail.
  [[nodiscard]] bool started() const { return started_; }
  /// Largest error of the last attempt [m, rad, m/s, rad/s].
  [[nodiscard]] T error() const;
  /// Takes the last attempt: its end, q and ν, is where the next one starts.
  void accept(State<T>& end);

 private:
  struct Joint {
    JointType type;
    Index q, dof, n;
  };
  /// The state at tangent x from the start and velocities w, floating ones in the axes of the joint.
  void place(const VectorX<T>& x, const VectorX<T>& w, State<T>& out) const;
  bool rates(const VectorX<T>& x, const VectorX<T>& w, const Acceleration& acceleration, int stage);
  void sum(const double* weights, int stages);

  const Tableau* tableau_;
  std::vector<Joint> joints_;
  State<T> at_;
  T h_{};
  bool started_ = false;
  VectorX<T> q_, w_, x_, w_stage_, zero_;
  std::vector<VectorX<T>> x_rate_, w_rate_;
};

}  // namespace delassus::simulation
