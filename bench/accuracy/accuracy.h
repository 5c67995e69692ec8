// What accuracy costs: every rung on one problem, over a range of dampings: errors, certificate, time, operations.
//
// A rung is an operator that solves, in double; lcaba, the paper's formula, also in float, in Quad, and in double on the
// numbers about the origin of the world; and the sparse system in maximal coordinates by CHOLMOD (reference/kkt_cholmod.h). Errors are against truth.h's answer in Quad.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "algorithms/delassus.h"
#include "bench/accuracy/accuracy_subject.h"
#include "bench/accuracy/accuracy_truth.h"

namespace delassus::accuracy {

inline constexpr const char* fast_rung = "lcaba";              ///< what costs are relative to
inline constexpr const char* default_rung = "ladder";   ///< what the claims are about
inline constexpr const char* world_rung = "lcaba, world";
inline constexpr const char* sparse_rung = "sparse KKT";

inline constexpr double own_damping = -1;                      ///< a damping: the subject's own

enum class Arithmetic : std::uint8_t { in_double, in_float, in_quad, about_world_origin, by_cholmod };

struct Rung {
  std::string name;
  const OperatorRow* row;   ///< nullptr by CHOLMOD
  Arithmetic arithmetic = Arithmetic::in_double;
  int style = 0;   ///< of plots: the same for the same rung in all of them; −1: not drawn, in the table of costs only
  Accuracy wanted = Accuracy::full();
};

/// The named ones, or every operator that solves, lcaba's variants CHOLMOD and the default asked for fewer digits
/// when none is named.
/// @throws ModelError listing the accepted names.
[[nodiscard]] std::vector<Rung> rungs(const std::vector<std::string>& names = {});

/// One rung at one damping. NaN and −1: not measured.
struct Cell {
  std::string rung, status;
  int style = 0, iterations = 0;
  Errors errors;
  double error_bound = -1, error_estimate = -1;
  double time = 0, solve = 0;        ///< of update and solve, and of solve alone [µs]
  std::int64_t operations = -1;      ///< of update and solve, counted

  /// The bound was given and is not below the true error. False without one.
  [[nodiscard]] bool certificate_true() const { return error_bound >= 0 && errors.energy <= error_bound; }
};

/// Every rung at one damping.
struct Level {
  double damping = 0;            ///< of every row [1/kg], or own_damping
  double largest_eigenvalue = 0, condition = 0, reference_bound = 0, disagreement = 0;
  std::string no_reference;      ///< why errors are not known; empty: they are
  std::vector<Cell> cells;

  [[nodiscard]] const Cell* find(std::string_view rung) const;
};

/// One subject.
struct Table {
  std::string name;
  bool is_scene = false;
  Index dofs = 0, rows = 0;
  double away = 0;
  std::vector<Level> levels;
};

struct Options {
  std::vector<double> dampings;   ///< [1/kg], ascending; own_damping
  bool random_right_side = false; ///< instead of a = J ν
  std::uint64_t seed = 1;
  double budget = 0.01;           ///< seconds of timing per phase; 0: no times, no operations
  std::function<bool()> stop = {};///< looked at before every rung; what follows is left out
  double longest = 0.5;           ///< a rung whose update and solve take longer [s] is left out at further dampings
};

/// Counted operations of update and one solve with as many steps as in double, which a counting scalar, whose residual is no wider
/// than itself, might not stop at; −1: the row cannot count, or stopped before.
[[nodiscard]] std::int64_t operations(const OperatorRow& row, const Problem<double>& problem, const Damping<double>& damping,
                                      const VectorX<double>& a, Accuracy wanted, const Report& in_double);

/// 1e-14, 1e-12, … up to `largest`.
[[nodiscard]] std::vector<double> dampings_up_to(double largest);

/// @throws std::runtime_error when M is singular.
[[nodiscard]] Table measure(const Subject& subject, const std::vector<Rung>& rungs, const Options& options);

}  // namespace delassus::accuracy
