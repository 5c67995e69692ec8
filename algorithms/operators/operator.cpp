// The public layer of every operator: phases, shapes, aliasing, non-finite results. Nothing here touches the numerics.
#include <algorithm>
#include <cstdint>
#include <functional>

#include "algorithms/kit/instantiate.h"
#include "algorithms/kit/lanes.h"
#include "algorithms/kit/scalars.h"
#include "algorithms/operators/operator.h"

namespace delassus {

#ifndef DELASSUS_EXACT
std::string_view kernels() {
#if defined __AVX512F__
  return "AVX-512";
#elif defined __AVX2__ && defined __FMA__
  return "AVX2 and FMA";
#else
  return "baseline";
#endif
}
#endif

// What sweeps load at a time: eight scalars, but no more than 64 bytes.
template <class T> inline constexpr std::size_t alignment =
    std::is_trivially_copyable_v<T> && 64 % sizeof(T) == 0 ? std::min<std::size_t>(64, 8 * sizeof(T)) : alignof(T);

template <class T> Workspace<T>::Workspace(Index scalars)
    : storage_(static_cast<std::size_t>(scalars) + 64 / sizeof(T) + 1), begin_(storage_.data()), size_(scalars) {
  if constexpr (alignment<T> > alignof(T))
    while (reinterpret_cast<std::uintptr_t>(begin_) % 64 != 0) ++begin_;
}

template <class T> Workspace<T>::Workspace(T* begin, Index scalars) : begin_(begin), size_(scalars) {
  require(reinterpret_cast<std::uintptr_t>(begin) % alignment<T> == 0, "Workspace: memory must begin at a multiple of eight scalars, at most 64 bytes");
}

template <class T> void Operator<T>::analyze(std::shared_ptr<const Structure> structure) {
  require(structure != nullptr, "Operator::analyze: no structure");
  structure->validate();
  updated_ = false;
  structure_ = std::move(structure);
  try {
    Index largest = 0;
    for (const auto& c : structure_->link_constraints) largest = std::max(largest, c.rows);
    for (const auto& c : structure_->joint_constraints) largest = std::max(largest, c.rows);
    scratch_.assign(static_cast<std::size_t>(largest * largest), T(0));
    do_analyze();
  } catch (...) {
    structure_ = nullptr;
    throw;
  }
}

template <class T> Report Operator<T>::update(const Problem<T>& problem, const Damping<T>& damping) {
  require(structure_ != nullptr, "Operator::update: call analyze first");
  require(problem.structure == structure_, "Operator::update: the problem has another structure than analyze saw");
  problem.check_sizes();
  damping.check_sizes(*structure_);
  updated_ = true;
  return damped(damping, do_update(problem, damping));
}

template <class T> Report Operator<T>::update_rows(const Problem<T>& problem, const Damping<T>& damping) {
  require(updated_, "Operator::update_rows: call update first");
  require(problem.structure == structure_, "Operator::update_rows: the problem has another structure than analyze saw");
  problem.check_sizes();
  damping.check_sizes(*structure_);
  return damped(damping, do_update_rows(problem, damping));
}

template <class T> Report Operator<T>::damped(const Damping<T>& damping, const Report& updated) {
  damping_ = damping.judged(scratch_);
  return damping_.ok() ? updated : damping_;
}

template <class T> Report Operator<T>::update_damping(const Damping<T>& damping) {
  require(updated_, "Operator::update_damping: call update first");
  damping.check_sizes(*structure_);
  return damped(damping, do_update_damping(damping));
}

namespace {
// Whether columns of `rows` numbers, `a_stride` and `b_stride` apart, share one; rows of one matrix above each other do not.
template <class T> bool overlap(const T* a, Index a_stride, const T* b, Index b_stride, Index rows, Index columns) {
  const std::less_equal<const T*> before;
  for (Index i = 0, j = 0; i < columns && j < columns && rows > 0;) {
    const T *const x = a + i * a_stride, *const y = b + j * b_stride;
    if (before(x + rows, y)) ++i;
    else if (before(y + rows, x)) ++j;
    else return true;
  }
  return false;
}
}  // namespace

template <class T>
void Operator<T>::check(ConstRef<T> in, Ref<T> out, const Workspace<T>& w) const {
  const Index rows = in.rows(), columns = in.cols();
  require(updated_, "Operator: call update before apply or solve");
  require(rows == size() && out.rows() == size(), "Operator: vectors must have as many rows as the operator");
  require(columns == out.cols(), "Operator: input and output must have the same number of columns");
  require(w.size() >= workspace(columns), "Operator: workspace too small (see Operator::workspace)");
  require(!overlap(in.data(), in.outerStride(), out.data(), out.outerStride(), rows, columns), "Operator: input and output must not overlap");
}

namespace {
template <class T> bool all_finite(ConstRef<T> x) {
  using std::isfinite;
  for (Index c = 0; c < x.cols(); ++c) {
    const T* const column = x.data() + c * x.outerStride();
    Index r = 0;
    if constexpr (std::is_same_v<T, double>) {
      Lanes8 nothing{};  // 0 x is 0 of what is finite, NaN of the rest
      for (; r + 8 <= x.rows(); r += 8) nothing += load_lanes(column + r) * 0.0;
      if (!(total(nothing) == 0)) return false;
    }
    for (; r < x.rows(); ++r)
      if (!isfinite(column[r])) return false;
  }
  return true;
}

// A result that must not be used is NaN where the scalar has one.
template <class T> void poison(Ref<T> x) {
  x.setConstant(ScalarTraits<T>::nan());
}

// NaN or infinity, given or met on the way, is a status and never a number. An iterate that did not converge is kept.
template <class T> Report finished(Report report, ConstRef<T> in, Ref<T> out) {
  if (!all_finite<T>(in) || (report.ok() && !all_finite<T>(out))) {
    report.status = Status::not_finite;
    report.where = -1;
    report.of_A = false;
  }
  if (!report.ok() && report.status != Status::not_converged) poison<T>(out);
  return report;
}
}  // namespace

template <class T> Report Operator<T>::apply(ConstRef<T> f, Ref<T> a, Workspace<T>& w) const {
  check(f, a, w);
  if (f.size() == 0) return {};
  return finished<T>(damping_.ok() ? do_apply(f, a, w.data()) : damping_, f, a);
}

template <class T> Report Operator<T>::solve(ConstRef<T> a, Ref<T> f, Workspace<T>& w) const {
  check(a, f, w);
  if (a.size() == 0) return {};
  return finished<T>(damping_.ok() ? do_solve(a, f, w.data()) : damping_, a, f);
}

template <class T> Report Operator<T>::solve(ConstRef<T> a, Ref<T> f, Accuracy wanted, Workspace<T>& w) const {
  check(a, f, w);
  require(wanted.error >= 0, "Operator::solve: the wanted accuracy is negative or NaN");
  require(wanted.steps >= 0, "Operator::solve: the number of steps is negative");
  if (a.size() == 0) return {};
  return finished<T>(damping_.ok() ? do_solve_to(a, f, wanted, w.data()) : damping_, a, f);
}

template <class T>
Report Operator<T>::solve_kkt(ConstRef<T> r1, ConstRef<T> r2, Ref<T> nu, Ref<T> lambda, Accuracy wanted, Workspace<T>& w, Start start) const {
  require(updated_, "Operator::solve_kkt: call update first");
  require(r1.rows() == structure_->dofs() && nu.rows() == structure_->dofs(), "Operator::solve_kkt: r1 and nu must have one row per degree of freedom");
  require(r2.rows() == size() && lambda.rows() == size(), "Operator::solve_kkt: r2 and lambda must have as many rows as the operator");
  require(r1.cols() == r2.cols() && r1.cols() == nu.cols() && r1.cols() == lambda.cols(), "Operator::solve_kkt: all must have the same number of columns");
  require(w.size() >= kkt_workspace(), "Operator::solve_kkt: workspace too small (see Operator::kkt_workspace)");
  require(!overlap(r1.data(), r1.outerStride(), nu.data(), nu.outerStride(), r1.rows(), r1.cols()) &&
              !overlap(r2.data(), r2.outerStride(), lambda.data(), lambda.outerStride(), r2.rows(), r2.cols()),
          "Operator::solve_kkt: input and output must not overlap");
  require(wanted.error >= 0, "Operator::solve_kkt: the wanted accuracy is negative or NaN");
  require(wanted.steps >= 0, "Operator::solve_kkt: the number of steps is negative");
  if (r1.cols() == 0) return {};
  Report report = damping_;
  for (Index c = 0; c < r1.cols() && damping_.ok(); ++c)
    report = worse(report, do_solve_kkt(r1.data() + c * r1.outerStride(), r2.data() + c * r2.outerStride(), nu.data() + c * nu.outerStride(),
                                        lambda.data() + c * lambda.outerStride(), wanted, start, w.data()));
  report = finished<T>(finished<T>(report, r1, nu), r2, lambda);
  if (!report.ok() && report.status != Status::not_converged) poison<T>(nu);
  return report;
}

template <class T> Report Operator<T>::do_solve_kkt(const T*, const T*, T*, T*, Accuracy, Start, T*) const { return {Status::not_supported}; }
template <class T> Report Operator<T>::do_apply(ConstRef<T>, Ref<T>, T*) const { return {Status::not_supported}; }
template <class T> Report Operator<T>::do_solve(ConstRef<T>, Ref<T>, T*) const { return {Status::not_supported}; }

template <class T> const std::vector<Index>& Operator<T>::dependent_rows() const {
  static const std::vector<Index> none;
  return none;
}

template <class T> Index Operator<T>::workspace(Index columns) const {
  require(structure_ != nullptr, "Operator::workspace: call analyze first");
  return do_workspace(columns);
}

template <class T> Index Operator<T>::kkt_workspace() const {
  require(structure_ != nullptr, "Operator::kkt_workspace: call analyze first");
  return do_kkt_workspace();
}

template <class T> Index Operator<T>::bytes() const {
  require(structure_ != nullptr, "Operator::bytes: call analyze first");
  return do_bytes() + static_cast<Index>(scratch_.size() * sizeof(T));
}

#define DELASSUS_INSTANTIATE(T) template class Workspace<T>; template class Operator<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
