#include "algorithms/operators/explicit_columns.h"

#include <algorithm>

#include "algorithms/kit/columns.h"
#include "algorithms/kit/instantiate.h"

namespace delassus {

template <class T> void ExplicitColumns<T>::analyze_form() {
  ExplicitBySweeps<T>::analyze_form();
  const Index m = this->size();
  work_ = std::make_unique<Workspace<T>>(columns_workspace<T>(m, this->factor_M_.workspace(), m) + 2 * padded(m));
}

template <class T> void ExplicitColumns<T>::form(const Problem<T>& problem, MatrixX<T>& A0) {
  const Index m = this->size();
  this->factor_M_.move_rows(problem);
  const auto columns = [&](auto* const x, Index first, int count) {  // x: zeros, values for A₀ x, scratch
    auto* const y = x + padded(m);
    for (int c = 0; c < count; ++c) set_lane(x[first + c], c, T(1));
    this->factor_M_.project(x, y, y + padded(m));
    for (int c = 0; c < count; ++c)
      for (Index r = first + c; r < m; ++r) A0(r, first + c) = lane(y[r], c);
    for (int c = 0; c < count; ++c) set_lane(x[first + c], c, T(0));
  };
  Index c = 0;
  if constexpr (has_lanes<T>) {
    auto* const x = reinterpret_cast<Lanes<T>*>(work_->data());
    std::fill(x, x + m, Lanes<T>{});
    for (; m - c >= least_lanes; c += std::min(lane_count, m - c))
      columns(x, c, static_cast<int>(std::min(lane_count, m - c)));
  }
  T* const x = work_->data();
  std::fill(x, x + m, T(0));
  for (; c < m; ++c) columns(x, c, 1);
}

template <class T> Index ExplicitColumns<T>::form_bytes() const {
  return ExplicitBySweeps<T>::form_bytes() + work_->size() * static_cast<Index>(sizeof(T));
}

#define DELASSUS_INSTANTIATE(T) template class ExplicitColumns<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
