// Methods of Runge and Kutta on the manifold, by their tableau: for scenes without rows in cones.
//
//   q = q₀ ⊕ x,   ẋ = A(x) w = ν but for rotations:   u̇ = ω + ½ u × ω + 1/12 u × (u × ω),  R = R₀ exp(û)
//              as u × ω is of order h², the series is off by h⁵, a step by h⁶: enough for order 5; by the midpoint u × ω = 0
//   w          ν, of floating joints in the axes of the joint, as in state.h;  ẇ = a = M⁻¹ f(q, ν)
//   stages     k_i = f(y₀ + h Σ a_ij k_j),   y = y₀ + h Σ b_i k_i
//   error      h Σ e_i k_i, the difference from the answer of lower order: of pairs only
// Explicit stages: M̂ = M. An evaluation of the terms and a factor each. Stable only where h is small against every spring and damper.
// Implicit stages, g = h a_ii:
//   w = w* + g a,   x = x* + g A(x) w                    * : what earlier stages add
//   M̂ a⁺ = f(x, w) + D a,   M̂ = M + D,  D = g d + g² k    of springs, dampers, motors: the diagonal of the joints
//              Newton with the derivative of what is stiff and linear alone, M̂ that of the last x: as exact as one step of it where
//              nothing else depends on the state, else a contraction of order g |ν| – of g² ∂²/∂q² of potentials, of the stretch of
//              stiff springs in loops. Begins at the a of the stage before, at 0 in the first: nothing of older steps.
//   ends       when no entry of w and x changes by more than 1e-15 of the largest |w|, at least of 1 m/s or rad/s; or within 1e-10 of it
//              when changes no longer halve, which is rounding; ends ill after 50
// Cost     an evaluation of the terms and a factor for each iteration: 4 to 10, by how small h |ν| is.
// Source   H. Munthe-Kaas 1998; E. Hairer, G. Wanner 1996, IV.8; tableaus.h.
#pragma once

#include <functional>

#include "simulation/state.h"
#include "simulation/tableaus.h"

namespace delassus::simulation {

template <class T> class RungeKutta {
 public:
  static constexpr double settled = 1e-15, within = 1e-10;  ///< a change: of the largest |w|, at least of 1 [m/s, rad/s]
  static constexpr int most_iterations = 50;                ///< of an implicit stage

  /// What an evaluation is for.
  struct Stage {
    T g;         ///< [s]; 0: an explicit one
    bool again;  ///< not the first evaluation of an implicit one
  };
  /// ν̇ at (q, ν), in the axes at q: what M⁻¹ f gives with ω × v of floating joints left to the axes. False where it fails.
  /// g > 0: M̂⁻¹(f + D a) with M̂ of g, a what stands in `acceleration`.
  using Acceleration = std::function<bool(const State<T>& at, const Stage& stage, VectorX<T>& acceleration)>;

  RungeKutta(const Model& model, const Tableau& tableau);
  /// Where the steps go on from.
  void start(const State<T>& state);
  /// A step of h from there, not taken yet; may be repeated with another h. False where an evaluation fails.
  bool attempt(const T& h, const Acceleration& acceleration);
  /// The evaluation at the start, where there is one, did not fail.
  [[nodiscard]] bool started() const { return started_; }
  [[nodiscard]] int stage() const { return stage_; }            ///< of the last attempt, where it failed; from 0
  [[nodiscard]] int iterations() const { return iterations_; }  ///< of implicit stages, since the start
  [[nodiscard]] T left() const { return left_; }                ///< largest last change of a stage since the start, as `within` measures
  [[nodiscard]] T change() const { return change_; }            ///< the last one of all
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
  void tangent(const VectorX<T>& x, const VectorX<T>& w, VectorX<T>& out) const;
  bool rate(const VectorX<T>& x, const VectorX<T>& w, const T& g, bool again, const Acceleration& acceleration, VectorX<T>& out);
  bool explicit_stage(int stage, const Acceleration& acceleration);
  bool implicit_stage(int stage, const Acceleration& acceleration);
  void sum(const double* weights, int stages);

  const Tableau* tableau_;
  std::vector<Joint> joints_;
  State<T> at_;
  T h_{}, left_{}, change_{};
  bool started_ = false;
  int stage_ = 0, iterations_ = 0;
  VectorX<T> q_, w_, x_, w_stage_, zero_;
  VectorX<T> x_base_, w_base_, x_then_, w_then_;  // of implicit stages
  std::vector<VectorX<T>> x_rate_, w_rate_;
};

}  // namespace delassus::simulation
