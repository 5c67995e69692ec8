// Steps that follow their error: a pair of methods with stages, for scenes without rows in cones.
//
//   ‖e‖∞ ≤ tolerance · τ                   a step τ is taken; e its estimated error in q [m, rad] and ν [m/s, rad/s], tolerance per second
//   τ ← τ · clamp(0.9 (tolerance τ/‖e‖∞)^(1/p), 0.2, 5)   the next one: e falls with τ^(p+1), p the order of the lower answer
// So what the steps add in a second is at most the tolerance; what the motion makes of it is the motion's own. The answer of the higher
// order goes on. The last step of an interval ends at its end. A step whose evaluation fails, or whose stage does not converge, is tried
// again five times shorter. Of stiff springs what rings at the start asks for short steps, until it has died out; their forces are rounded
// to ε k |q|, so that tolerances below some 20 ε ω² |q| where τ ω < 1, 20 ε |q|/τ² where it is not, are not reached.
// Cost     of explicit pairs six evaluations a step, taken or not, and one for each interval; of implicit ones those of its iterations.
// Source   J. Dormand, P. Prince 1980; E. Hairer, S. Nørsett, G. Wanner 1993, II.4; E. Hairer, G. Wanner 1996, IV.8.
#pragma once

#include "simulation/runge_kutta.h"

namespace delassus::simulation {

template <class T> class ErrorControl {
 public:
  static constexpr double shortest = 1e-10;  ///< step, of the interval: below it the tolerance is within rounding, or the motion has no smooth end

  enum class End : std::uint8_t { reached, evaluation_failed, too_short };
  struct Spent {
    int taken = 0, rejected = 0;  ///< steps
    double error = 0;             ///< largest ‖e‖∞/τ of those taken
    int iterations = 0;           ///< of implicit stages
    double left = 0;              ///< their largest last change (runge_kutta.h)
  };

  ErrorControl(const Model& model, const Tableau& pair, double tolerance) : method_(model, pair), tolerance_(tolerance), falls_(1.0 / pair.estimate) {}
  /// Over an interval of h; where it does not end well the state is as it was. state.trial is the first step tried, 0: all of h.
  End operator()(const T& h, State<T>& state, const typename RungeKutta<T>::Acceleration& acceleration);
  [[nodiscard]] const Spent& spent() const { return spent_; }  ///< in the last interval

 private:
  RungeKutta<T> method_;
  double tolerance_, falls_;
  Spent spent_;
  State<T> end_;
};

}  // namespace delassus::simulation
