// An operator on the m rows of a problem, and its phases.
//
//   A = J M⁻¹ Jᵀ + R⁻¹            m × m, symmetric positive semidefinite
//   apply   a = A f               constraint forces to constraint accelerations
//   solve   f = A⁻¹ a = Λ_R a     the damped inverse
//   solve_kkt   (ν, λ) of M ν − Jᵀλ = r₁, J ν + R⁻¹λ = r₂: the primitive, of which solve is the case r₁ = 0
//
// Phases: analyze (structure: the tree, and rows up to a capacity; once) → update (numbers at q) → update_rows (rows that moved,
//         appeared or left at the same q) → update_damping (a new R⁻¹) → apply / solve / solve_kkt (vectors, or k columns).
//         A row is switched off by R⁻¹ = ∞ (Damping).
// After analyze nothing allocates (OperatorRow::grows: but what is needed for the first time). Instances share nothing: use one
// per thread; apply and solve are const and may run concurrently with a Workspace each.
#pragma once

#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "algorithms/problem/problem.h"

namespace delassus {

/// The instruction set this library's kernels were compiled for: "AVX-512", "AVX2 and FMA" or "baseline".
[[nodiscard]] std::string_view kernels();

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

/// Where solve_kkt begins: at zero, or at the pair that nu and lambda hold.
enum class Start : std::uint8_t { zero, given };

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
  /// Numeric phase of rows that moved, appeared (a finite R⁻¹) or left (∞) at the configuration of the last update: of `problem`
  /// only K and joint_K may differ from what that saw, and the factor of M is kept. @throws std::logic_error before update.
  [[nodiscard]] Report update_rows(const Problem<T>& problem, const Damping<T>& damping);
  /// Numeric phase at a new damping; everything that does not depend on it is kept.
  [[nodiscard]] Report update_damping(const Damping<T>& damping);

  /// a = A f. Shapes m×k; f and a must not overlap. NaN in ⇒ NaN out.
  [[nodiscard]] Report apply(ConstRef<T> f, Ref<T> a, Workspace<T>& workspace) const;
  /// f = A⁻¹ a. Shapes m×k. When the report is not ok, f holds NaN (or the best iterate for not_converged).
  [[nodiscard]] Report solve(ConstRef<T> a, Ref<T> f, Workspace<T>& workspace) const;
  /// The same, to a wanted accuracy: no more work than its certificate asks for, and not_converged when it stays above.
  /// Operators without a certificate solve as they always do.
  [[nodiscard]] Report solve(ConstRef<T> a, Ref<T> f, Accuracy wanted, Workspace<T>& workspace) const;

  /// (ν, λ) of  M ν − Jᵀλ = r₁,  J ν + R⁻¹λ = r₂: motion and forces of constrained dynamics (paper, equations 2–5). Shapes:
  /// r1, nu n×k; r2, lambda m×k; outputs must not overlap inputs. Rows that are off have λ = 0, whatever r2 holds there. Operators
  /// that refine or iterate begin at the pair given, which comes back as it is where it is as accurate as wanted; the others need
  /// no start. The report speaks of the pair: error_bound relative in ‖ν‖²_M + ‖λ‖²_{R⁻¹} (= νᵀr₁ + λᵀr₂). For operators that solve.
  [[nodiscard]] Report solve_kkt(ConstRef<T> r1, ConstRef<T> r2, Ref<T> nu, Ref<T> lambda, Accuracy wanted, Workspace<T>& workspace,
                                 Start start = Start::zero) const;

  [[nodiscard]] Index size() const { return structure_ ? structure_->rows : 0; }   ///< rows m
  /// Scalars a Workspace needs for `columns` columns.
  [[nodiscard]] Index workspace(Index columns = 1) const;
  /// Scalars a Workspace needs for solve_kkt.
  [[nodiscard]] Index kkt_workspace() const;
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
  virtual Report do_update_rows(const Problem<T>& problem, const Damping<T>& damping) { return do_update(problem, damping); }
  virtual Report do_update_damping(const Damping<T>& damping) = 0;
  virtual Report do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const;
  virtual Report do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const;
  virtual Report do_solve_to(ConstRef<T> a, Ref<T> f, Accuracy, T* workspace) const { return do_solve(a, f, workspace); }
  /// One column; nu and lambda hold the pair to start from when `start` says so.
  virtual Report do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy wanted, Start start, T* workspace) const;
  [[nodiscard]] virtual Index do_workspace(Index columns) const = 0;
  [[nodiscard]] virtual Index do_kkt_workspace() const { return do_workspace(1); }
  [[nodiscard]] virtual Index do_bytes() const = 0;

 private:
  void check(ConstRef<T> in, Ref<T> out, const Workspace<T>& w) const;
  Report damped(const Damping<T>& damping, const Report& updated);
  std::shared_ptr<const Structure> structure_;
  bool updated_ = false;
  std::vector<T> scratch_;  // the largest block
  Report damping_;          // bad_damping, or ok
};

}  // namespace delassus
