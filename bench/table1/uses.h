// What is asked of an operator again and again, one call each: the columns of the paper's Table I.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "algorithms/delassus.h"

namespace delassus::bench {

enum class Use : std::uint8_t {
  first_apply,       ///< update and one product: a new configuration
  first_solve,       ///< update and one solve
  apply,             ///< one product more
  solve,             ///< one solve more
  new_damping,       ///< another R⁻¹ and one solve
  damping_alone,     ///< another R⁻¹
  fast_first_solve,  ///< first_solve without refinement and certificate, by operators that have them
  fast_solve,        ///< solve likewise
};
inline constexpr std::size_t use_count = 8;
[[nodiscard]] const char* name(Use use);
[[nodiscard]] inline Use use(std::size_t i) { return static_cast<Use>(i); }

/// One operator on one problem with its vectors. Problem, damping and right-hand side must outlive it.
class Asked {
 public:
  /// Analyses, updates, and takes one answer of each kind. Shape of the right-hand side `x`: m × 1.
  Asked(const OperatorRow& row, const Problem<double>& problem, const Damping<double>& damping, const MatrixX<double>& x);

  /// Why the operator has no answer to this: "has no apply", the status of a report, or the refusal of its structure. Empty: it has.
  [[nodiscard]] const std::string& why_not(Use use) const { return why_not_[static_cast<std::size_t>(use)]; }
  /// Does it once. Two dampings are taken in turn by those that change it, so that no call finds the numbers it already has.
  void ask(Use use);

  [[nodiscard]] const MatrixX<double>& product() const { return product_; }   ///< A x
  [[nodiscard]] const MatrixX<double>& solution() const { return solution_; } ///< A⁻¹ x
  [[nodiscard]] const Report& solved() const { return solved_; }
  [[nodiscard]] std::int64_t bytes() const { return op_ ? op_->bytes() : -1; }
  [[nodiscard]] const OperatorRow& row() const { return row_; }

 private:
  void update();
  void take_answers();

  const OperatorRow& row_;
  const Problem<double>& problem_;
  const Damping<double>& damping_;
  const Damping<double> other_;
  const MatrixX<double>& x_;
  MatrixX<double> out_, product_, solution_;
  std::unique_ptr<Operator<double>> op_;
  std::unique_ptr<Workspace<double>> workspace_;
  std::array<std::string, use_count> why_not_;
  Report report_, solved_;
  bool odd_ = false;
};

/// The vector every timing uses: entries in [−1/2, 1/2), the multiples of the golden ratio modulo 1. Shape n.
[[nodiscard]] VectorX<double> sample_vector(Index n);

/// The same damping, every entry half as large again.
[[nodiscard]] Damping<double> other_damping(Damping<double> damping);

}  // namespace delassus::bench
