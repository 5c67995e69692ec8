// Internals of loop closing: the unknowns of assembly, and Newton's method on them.
#pragma once

#include "algorithms/mechanism/loop_closing.h"

namespace delassus {

/// Leading rows of a kind that are angles.
[[nodiscard]] Index angles_of(Constraint::Kind kind);
/// Largest magnitude; NaN when an entry is NaN.
[[nodiscard]] double largest(const VectorX<double>& x);

/// The loop constraints of a model on their own, the couplings, and the unknowns: a column for each.
struct Loops {
  Model model;                    // the same bodies; loop constraints only
  std::shared_ptr<const Structure> structure;
  std::vector<Index> constraint;  // per loop: its index in the whole model
  std::vector<Index> column;      // per degree of freedom: its column, −1 where it does not move
  std::vector<Index> coordinate;  // per column: its entry of q, −1 of spherical and floating joints
  VectorX<double> lower, upper;   // per column; infinite where there is no limit
  MatrixX<double> C;              // couplings × columns
  VectorX<double> kept;           // what they keep: C times the columns' coordinates at the start
  Index columns = 0;
  Loops(const Model& whole, const VectorX<double>& q, const AssemblyOptions& options);

 private:
  void number_columns(const Model& whole, const std::vector<bool>& held);
  void set_limits(const VectorX<double>& q);
  void set_couplings(const Model& whole, const VectorX<double>& q);
};

/// Position errors of every loop constraint at q, one after the other.
[[nodiscard]] VectorX<double> loop_errors(const Loops& loops, const VectorX<double>& q, Poses<double>& at);

/// Directions whose errors answer more weakly, against the strongest, are left alone at first.
inline constexpr double strong_directions = 1e-3;
/// √u: a direction that answers with σ below it needs a step δ > √u to matter, and then δ² outweighs σ δ.
inline constexpr double all_directions = 0x1p-27;

/// A configuration on its way to closure.
class Closing {
 public:
  Closing(const Loops& loops, const VectorX<double>& start);
  /// Newton steps until the error falls no more.
  void descend(double threshold, bool limits);

  VectorX<double> q;
  VectorX<double> e;           ///< φ at q
  VectorX<double> weights;     ///< of its entries
  std::vector<double> levers;  ///< per loop: the largest entry of its linear rows of J at the start [m or 1]
  int steps = 0;
  /// Σ coefficient q of each coupling less what it keeps.
  [[nodiscard]] VectorX<double> coupling_error() const;

 private:
  [[nodiscard]] double norm_of(const VectorX<double>& error) const { return weights.cwiseProduct(error).norm(); }
  [[nodiscard]] VectorX<double> step(double threshold, bool limits);
  [[nodiscard]] VectorX<double> free_step(const MatrixX<double>& J, VectorX<double> x, const std::vector<Index>& free, double threshold) const;
  [[nodiscard]] VectorX<double> on_all(const VectorX<double>& x) const;

  const Loops* loops_;
  Problem<double> problem_;
  Poses<double> at_;
};

}  // namespace delassus
