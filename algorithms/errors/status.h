// Error channels of the library.
//   misuse      wrong size, phase or aliasing           std::logic_error, thrown at the public layer
//   bad input   a file or a model that cannot be right  ModelError, naming file, element, value, unit, accepted
//   numbers     what a computation came to              Report, a value: never an exception, a print or a repair
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>

namespace delassus {

/// Numerical outcome of a factorisation or a solve.
enum class Status : std::uint8_t {
  ok,
  lost_pivot,        ///< a pivot was not positive: M (or M_R) is singular or indefinite in this arithmetic
  zero_damping,      ///< this form needs R⁻¹ > 0 and a row (or block) has a zero or singular one
  bad_damping,       ///< R⁻¹ is negative, infinite or NaN in a row, or a block is not symmetric positive semidefinite
  not_converged,     ///< an iteration ended above its target; the result is the best iterate
  not_finite,        ///< NaN or infinity in the data or in the right-hand side
  inconsistent,      ///< A is singular and a is not in its range: dependent hard rows ask for different accelerations
  not_supported,     ///< the operator has no such function (see its row in the table)
};

[[nodiscard]] constexpr std::string_view name(Status s) {
  switch (s) {
    case Status::ok: return "ok";
    case Status::lost_pivot: return "lost_pivot";
    case Status::zero_damping: return "zero_damping";
    case Status::bad_damping: return "bad_damping";
    case Status::not_converged: return "not_converged";
    case Status::not_finite: return "not_finite";
    case Status::inconsistent: return "inconsistent";
    case Status::not_supported: return "not_supported";
  }
  return "unknown";
}

/// What a numeric phase or a solve came to.
struct Report {
  Status status = Status::ok;
  std::int64_t where = -1;       ///< the row or degree of freedom concerned (see at_row), −1: none
  int iterations = 0;            ///< refinement or Krylov steps taken; of the ladder: on all rungs tried
  double backward_error = -1;    ///< normwise relative residual; −1: not computed
  double error_bound = -1;       ///< rigorous bound on the error, relative, in the energy norm; −1: not computed
  double error_estimate = -1;    ///< size of the last correction, relative: the error before it; −1: not computed
  double rcond_estimate = -1;    ///< estimate of 1/κ; −1: not computed
  std::string_view rung = {};    ///< of the ladder: the operator that answered
  int rungs_tried = 0;           ///< of the ladder: how many operators it asked
  bool of_A = false;             ///< lost_pivot: of A = J M⁻¹Jᵀ + R⁻¹, at a row; else of M or M + JᵀRJ, at a degree of freedom

  [[nodiscard]] bool ok() const { return status == Status::ok; }
  /// Whether `where` counts rows of J; else it counts degrees of freedom.
  [[nodiscard]] bool at_row() const { return status != Status::lost_pivot || of_A; }
};

/// What a solve is asked for: a bound on its error, relative, in the energy norm ‖ν‖²_M + ‖λ‖²_{R⁻¹} (= λᵀa).
struct Accuracy {
  double error = 0;
  int steps = std::numeric_limits<int>::max();  ///< refinement or Krylov steps at most; not_converged when they do not suffice
  /// All the digits the arithmetic has.
  static constexpr Accuracy full() { return {0}; }
  /// One evaluation: no residual, no certificate.
  static constexpr Accuracy fastest() { return {std::numeric_limits<double>::infinity()}; }
};

/// Of the reports of two columns: the larger numbers, and the status of the first that is not ok.
[[nodiscard]] inline Report worse(Report a, const Report& b) {
  if (a.ok() && !b.ok()) {
    a.status = b.status;
    a.where = b.where;
    a.of_A = b.of_A;
  }
  a.iterations = std::max(a.iterations, b.iterations);
  a.backward_error = std::max(a.backward_error, b.backward_error);
  a.error_bound = std::max(a.error_bound, b.error_bound);
  a.error_estimate = std::max(a.error_estimate, b.error_estimate);
  if (!b.rung.empty()) a.rung = b.rung;
  a.rungs_tried = std::max(a.rungs_tried, b.rungs_tried);
  return a;
}

/// Input that cannot be right. The message reads `file: element: what is wrong (accepted: …)`.
class ModelError : public std::runtime_error {
 public:
  explicit ModelError(const std::string& message) : std::runtime_error(message) {}
  ModelError(const std::string& file, const std::string& element, const std::string& problem,
             const std::string& accepted);
};

/// Throws std::logic_error when a precondition of the public layer does not hold.
inline void require(bool condition, const char* message) {
  if (!condition) throw std::logic_error(message);
}

}  // namespace delassus
