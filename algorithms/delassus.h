// The public header: what an operator is, and the table of all of them.
//
//   A = J M⁻¹ Jᵀ + R⁻¹            m × m, symmetric positive semidefinite
//   apply   a = A f               constraint forces to constraint accelerations
//   solve   f = A⁻¹ a = Λ_R a     the damped inverse
//
// Phases: analyze (structure; once) → update (numbers at q) → update_damping (numbers at a new R⁻¹, kinematics kept)
//         → apply / solve (vectors, or k columns at once).
// After analyze nothing allocates (OperatorRow::grows: but what is needed for the first time). Instances share nothing: use one
// per thread; apply and solve are const and may run concurrently with a Workspace each.
#pragma once

#include <limits>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "algorithms/problem.h"
#include "algorithms/scalars.h"

namespace delassus {

/// The instruction set this library's kernels were compiled for: "AVX-512", "AVX2 and FMA" or "baseline".
[[nodiscard]] std::string_view kernels();

/// Columns of m numbers with unit inner stride.
template <class T> using ConstRef = const Eigen::Ref<const MatrixX<T>, 0, Eigen::OuterStride<>>&;
template <class T> using Ref = Eigen::Ref<MatrixX<T>, 0, Eigen::OuterStride<>>;

/// Scratch memory of apply and solve; its contents never matter. Allocated by its constructor only. One per thread: it moves,
/// but is not copied.
template <class T> class Workspace {
 public:
  explicit Workspace(Index scalars);
  /// A part of another one, from a multiple of eight scalars (at most 64 bytes) on. @throws std::logic_error where it is not.
  Workspace(T* begin, Index scalars);
  Workspace(Workspace&& other) noexcept
      : storage_(std::move(other.storage_)), begin_(std::exchange(other.begin_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  Workspace& operator=(Workspace&& other) noexcept {
    std::swap(storage_, other.storage_);
    std::swap(begin_, other.begin_);
    std::swap(size_, other.size_);
    return *this;
  }
  [[nodiscard]] T* data() { return begin_; }
  [[nodiscard]] Index size() const { return size_; }
  void fill(const T& value) { std::fill(begin_, begin_ + size_, value); }

 private:
  std::vector<T> storage_;
  T* begin_ = nullptr;  // 64-byte aligned
  Index size_ = 0;
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

template <class T> class Operator {
 public:
  Operator() = default;
  Operator(const Operator&) = delete;  // what it made in analyze points into itself
  Operator& operator=(const Operator&) = delete;
  virtual ~Operator() = default;

  /// Symbolic phase: elimination order, fill, layout. Allocates everything. @throws ModelError for a bad structure; after any
  /// exception the operator is as if never analysed.
  void analyze(std::shared_ptr<const Structure> structure);
  /// Numeric phase at a configuration. bad_damping: R⁻¹ cannot be right (Damping::judged); apply and solve then say so too,
  /// until update_damping gives another. @throws std::logic_error before analyze or with another structure.
  [[nodiscard]] Report update(const Problem<T>& problem, const Damping<T>& damping);
  /// Numeric phase at a new damping; everything that does not depend on it is kept.
  [[nodiscard]] Report update_damping(const Damping<T>& damping);

  /// a = A f. Shapes m×k; f and a must not overlap. NaN in ⇒ NaN out.
  [[nodiscard]] Report apply(ConstRef<T> f, Ref<T> a, Workspace<T>& workspace) const;
  /// f = A⁻¹ a. Shapes m×k. When the report is not ok, f holds NaN (or the best iterate for not_converged).
  [[nodiscard]] Report solve(ConstRef<T> a, Ref<T> f, Workspace<T>& workspace) const;
  /// The same, to a wanted accuracy: no more work than its certificate asks for, and not_converged when it stays above.
  /// Operators without a certificate solve as they always do.
  [[nodiscard]] Report solve(ConstRef<T> a, Ref<T> f, Accuracy wanted, Workspace<T>& workspace) const;

  [[nodiscard]] Index size() const { return structure_ ? structure_->rows : 0; }   ///< rows m
  /// Scalars a Workspace needs for `columns` columns.
  [[nodiscard]] Index workspace(Index columns = 1) const;
  /// Bytes held by the operator after analyze, workspace not counted.
  [[nodiscard]] Index bytes() const;
  [[nodiscard]] const std::shared_ptr<const Structure>& structure() const { return structure_; }
  /// Rows left out by the last update because they depend on the others and are hard (R⁻¹ = 0), ascending; empty for an
  /// operator that does not decide ranks (see its row in the table).
  [[nodiscard]] virtual const std::vector<Index>& dependent_rows() const;

 protected:
  // What an author writes. Shapes, phase and aliasing are already checked.
  virtual void do_analyze() = 0;
  virtual Report do_update(const Problem<T>& problem, const Damping<T>& damping) = 0;
  virtual Report do_update_damping(const Damping<T>& damping) = 0;
  virtual Report do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const;
  virtual Report do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const;
  virtual Report do_solve_to(ConstRef<T> a, Ref<T> f, Accuracy, T* workspace) const { return do_solve(a, f, workspace); }
  [[nodiscard]] virtual Index do_workspace(Index columns) const = 0;
  [[nodiscard]] virtual Index do_bytes() const = 0;

 private:
  void check(ConstRef<T> in, Ref<T> out, const Workspace<T>& w) const;
  std::shared_ptr<const Structure> structure_;
  bool updated_ = false;
  std::vector<T> scratch_;  // the largest block
  Report damping_;          // bad_damping, or ok
};

/// How the rounding error of a function grows; the laws pick their bound from it (docs/verification.md).
enum class ErrorClass : std::uint8_t {
  componentwise,  ///< forward error within the data's own componentwise sensitivity
  normwise,       ///< forward error within κ(A) · eps
  refined,        ///< componentwise, or eps of the largest entry and eps in the energy norm, whichever is larger
  amplified,      ///< forward error R·λmax(Λ⁻¹) larger: the direct inversion-lemma formula
};
[[nodiscard]] std::string_view name(ErrorClass e);

template <class T> using Maker = std::unique_ptr<Operator<T>> (*)();

/// One row of the table of operators.
struct OperatorRow {
  std::string_view name, summary, formula, source, cost;
  bool applies, solves;
  bool zero_damping;          ///< solve is defined when rows of R⁻¹ are zero (and A is regular)
  bool terminates_exactly;    ///< exact in exact arithmetic
  bool decides_rank = false;  ///< solves a singular A too when a is in its range, and names the dependent rows
  ErrorClass apply_error, solve_error;
  bool grows = false;         ///< allocates when it first needs a part of itself; never again
  double factor_eps = 0x1p-53;  ///< unit roundoff of the arithmetic its factor runs in: where 1/κ(A) is not far above it,
                                ///< the operator may give up, and says so
  std::tuple<Maker<double>, Maker<float>, Maker<Quad>, Maker<Counted>, Maker<Rational>,
             Maker<PrimeField>>
      makers;  ///< nullptr where a scalar is not served

  /// @throws std::logic_error where the scalar is not served.
  template <class T> [[nodiscard]] std::unique_ptr<Operator<T>> make() const {
    require(std::get<Maker<T>>(makers) != nullptr, "OperatorRow::make: this operator does not serve this scalar (delassus list operators)");
    return std::get<Maker<T>>(makers)();
  }
};

[[nodiscard]] const std::vector<OperatorRow>& operators();
/// @throws ModelError listing the accepted names.
[[nodiscard]] const OperatorRow& find_operator(std::string_view name);

}  // namespace delassus
