#include "algorithms/operators/auto.h"

#include <algorithm>

#include "algorithms/kit/instantiate.h"

namespace delassus {

template <class T> void Auto<T>::do_analyze() {
  choice_ = choose(*this->structure(), use_);
  const bool one_row = choice_.product.empty() || choice_.solve.empty() || choice_.product == choice_.solve;
  const auto made = [&](std::string_view name) {
    auto op = find_operator(name).make<T>();
    op->analyze(this->structure());
    return op;
  };
  first_ = made(choice_.product.empty() ? choice_.solve : choice_.product);
  second_ = one_row ? nullptr : made(choice_.solve);
  product_ = choice_.product.empty() ? nullptr : first_.get();
  solve_ = choice_.solve.empty() ? nullptr : one_row ? first_.get() : second_.get();
}

template <class T> template <class Take> Report Auto<T>::both(const Take& take) {
  const Report first = take(*first_), second = second_ ? take(*second_) : Report{};
  return first.ok() ? second : first;
}
template <class T> Report Auto<T>::do_update(const Problem<T>& problem, const Damping<T>& damping) {
  return both([&](Operator<T>& op) { return op.update(problem, damping); });
}
template <class T> Report Auto<T>::do_update_rows(const Problem<T>& problem, const Damping<T>& damping) {
  return both([&](Operator<T>& op) { return op.update_rows(problem, damping); });
}
template <class T> Report Auto<T>::do_update_damping(const Damping<T>& damping) {
  return both([&](Operator<T>& op) { return op.update_damping(damping); });
}

namespace {
/// Asks a row with the caller's memory.
template <class T, class Ask> Report asked(const Operator<T>* op, T* memory, Index size, const Ask& ask) {
  if (op == nullptr) return {Status::not_supported};
  Workspace<T> workspace(memory, size);
  return ask(*op, workspace);
}
}  // namespace

template <class T> Report Auto<T>::do_apply(ConstRef<T> f, Ref<T> a, T* memory) const {
  return asked(product_, memory, do_workspace(f.cols()), [&](const Operator<T>& op, Workspace<T>& w) { return op.apply(f, a, w); });
}
template <class T> Report Auto<T>::do_solve(ConstRef<T> a, Ref<T> f, T* memory) const {
  return asked(solve_, memory, do_workspace(a.cols()), [&](const Operator<T>& op, Workspace<T>& w) { return op.solve(a, f, w); });
}
template <class T> Report Auto<T>::do_solve_to(ConstRef<T> a, Ref<T> f, Accuracy wanted, T* memory) const {
  return asked(solve_, memory, do_workspace(a.cols()), [&](const Operator<T>& op, Workspace<T>& w) { return op.solve(a, f, wanted, w); });
}
template <class T>
Report Auto<T>::do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy wanted, Start start, T* memory) const {
  using Column = Eigen::Map<MatrixX<T>>;
  using ConstColumn = Eigen::Map<const MatrixX<T>>;
  const Index n = this->structure()->dofs(), m = this->size();
  return asked(solve_, memory, do_kkt_workspace(), [&](const Operator<T>& op, Workspace<T>& w) {
    return op.solve_kkt(ConstColumn(r1, n, 1), ConstColumn(r2, m, 1), Column(nu, n, 1), Column(lambda, m, 1), wanted, w, start);
  });
}

template <class T> Index Auto<T>::do_workspace(Index columns) const {
  return std::max(first_->workspace(columns), second_ ? second_->workspace(columns) : 0);
}
template <class T> Index Auto<T>::do_kkt_workspace() const { return solve_ != nullptr ? solve_->kkt_workspace() : 0; }
template <class T> Index Auto<T>::do_bytes() const { return first_->bytes() + (second_ ? second_->bytes() : 0); }

template <class T> const std::vector<Index>& Auto<T>::dependent_rows() const {
  return solve_ != nullptr ? solve_->dependent_rows() : Operator<T>::dependent_rows();
}

#define DELASSUS_INSTANTIATE(T) template class Auto<T>;
DELASSUS_FOR_EACH_ORDERED_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
