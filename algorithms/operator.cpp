// The public layer of every operator: phases, shapes, aliasing, non-finite results. Nothing here touches the numerics.
#include <cstdint>
#include <functional>

#include "algorithms/delassus.h"

namespace delassus {

template <class T> Workspace<T>::Workspace(Index scalars)
    : storage_(static_cast<std::size_t>(scalars) + 64 / sizeof(T) + 1), begin_(storage_.data()), size_(scalars) {
  if constexpr (std::is_trivially_copyable_v<T> && 64 % sizeof(T) == 0)
    while (reinterpret_cast<std::uintptr_t>(begin_) % 64 != 0) ++begin_;
}

template <class T> void Operator<T>::analyze(std::shared_ptr<const Structure> structure) {
  require(structure != nullptr, "Operator::analyze: no structure");
  structure->validate();
  structure_ = std::move(structure);
  updated_ = false;
  do_analyze();
}

template <class T> Report Operator<T>::update(const Problem<T>& problem, const Damping<T>& damping) {
  require(structure_ != nullptr, "Operator::update: call analyze first");
  require(problem.structure == structure_, "Operator::update: the problem has another structure than analyze saw");
  problem.check_sizes();
  damping.check_sizes(*structure_);
  updated_ = true;
  return do_update(problem, damping);
}

template <class T> Report Operator<T>::update_damping(const Damping<T>& damping) {
  require(updated_, "Operator::update_damping: call update first");
  damping.check_sizes(*structure_);
  return do_update_damping(damping);
}

template <class T>
void Operator<T>::check(Index rows, Index columns, Index out_rows, Index out_columns, const T* in, const T* out,
                        const Workspace<T>& w) const {
  require(updated_, "Operator: call update before apply or solve");
  require(rows == size() && out_rows == size(), "Operator: vectors must have as many rows as the operator");
  require(columns == out_columns, "Operator: input and output must have the same number of columns");
  require(w.size() >= workspace(columns), "Operator: workspace too small (see Operator::workspace)");
  require(rows * columns == 0 || in != out, "Operator: input and output must not overlap");
}

namespace {
template <class T> bool all_finite(ConstRef<T> x) {
  for (Index c = 0; c < x.cols(); ++c)
    for (Index r = 0; r < x.rows(); ++r) {
      using std::isfinite;
      if (!isfinite(x(r, c))) return false;
    }
  return true;
}

// A result that must not be used is NaN where the scalar has one.
template <class T> void poison(Ref<T> x) {
  x.setConstant(ScalarTraits<T>::nan());
}

// NaN or infinity, given or met on the way, is a status and never a number. An iterate that did not converge is kept.
template <class T> Report finished(Report report, ConstRef<T> in, Ref<T> out) {
  if (!all_finite<T>(in) || (report.ok() && !all_finite<T>(out))) report.status = Status::not_finite;
  if (!report.ok() && report.status != Status::not_converged) poison<T>(out);
  return report;
}
}  // namespace

template <class T> Report Operator<T>::apply(ConstRef<T> f, Ref<T> a, Workspace<T>& w) const {
  check(f.rows(), f.cols(), a.rows(), a.cols(), f.data(), a.data(), w);
  if (f.size() == 0) return {};
  return finished<T>(do_apply(f, a, w.data()), f, a);
}

template <class T> Report Operator<T>::solve(ConstRef<T> a, Ref<T> f, Workspace<T>& w) const {
  check(a.rows(), a.cols(), f.rows(), f.cols(), a.data(), f.data(), w);
  if (a.size() == 0) return {};
  return finished<T>(do_solve(a, f, w.data()), a, f);
}

template <class T> Report Operator<T>::solve(ConstRef<T> a, Ref<T> f, Accuracy wanted, Workspace<T>& w) const {
  check(a.rows(), a.cols(), f.rows(), f.cols(), a.data(), f.data(), w);
  require(wanted.error >= 0, "Operator::solve: the wanted accuracy is negative or NaN");
  require(wanted.steps >= 0, "Operator::solve: the number of steps is negative");
  if (a.size() == 0) return {};
  return finished<T>(do_solve_to(a, f, wanted, w.data()), a, f);
}

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

template <class T> Index Operator<T>::bytes() const {
  require(structure_ != nullptr, "Operator::bytes: call analyze first");
  return do_bytes();
}

#define DELASSUS_INSTANTIATE(T) template class Workspace<T>; template class Operator<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
