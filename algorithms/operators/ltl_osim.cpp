#include "algorithms/operators/ltl_osim.h"

#include <algorithm>

#include "algorithms/kit/instantiate.h"
#include "algorithms/kit/thin_product.h"

namespace delassus {

template <class T> void LtlOsim<T>::analyze_form() {
  Ltl<T>::analyze_form();
  const auto& rows = this->rows_;
  const Index groups = static_cast<Index>(rows.groups().size());
  Index largest = 0;
  runs_.clear();
  for (Index of = 0; of < groups; ++of) {
    const auto& g = rows.groups()[of];
    largest = std::max(largest, g.rows * g.count);
    for (Index with = of; with < groups; ++with) {
      const auto& h = rows.groups()[with];
      bool running = false;
      for (Index a = 0, b = 0; a < g.count && b < h.count;) {
        const Index k = rows.dof(g, a), l = rows.dof(h, b);
        if (k == l && running) ++runs_.back().count;
        if (k == l && !running) runs_.push_back({of, with, a, b, 1});
        running = k == l;
        a += k <= l;
        b += l <= k;
      }
    }
  }
  scaled_.assign(static_cast<std::size_t>(largest), T(0));
}

template <class T> void LtlOsim<T>::form(const Problem<T>& problem, MatrixX<T>& A0) {
  auto& rows = this->rows_;
  rows.assemble(problem);
  for (const auto& g : rows.groups())
    for (Index p = g.count; p-- > 0;) rows.eliminate(g, p);
  Index scaled = -1;
  for (const Run& run : runs_) {
    const auto &g = rows.groups()[run.of], &h = rows.groups()[run.with];
    if (scaled != run.of)
      for (Index p = 0; p < g.count; ++p)
        for (Index r = 0; r < g.rows; ++r) scaled_[p * g.rows + r] = rows.column(g, p)[r] * this->factor_.inverse_pivot(rows.dof(g, p));
    scaled = run.of;
    add_thin_product(&A0(h.row, g.row), A0.rows(), rows.column(h, run.b), h.rows, scaled_.data() + run.a * g.rows, g.rows, run.count);
  }
}

template <class T> Index LtlOsim<T>::form_bytes() const {
  return Ltl<T>::form_bytes() + static_cast<Index>(sizeof(T) * scaled_.size() + sizeof(Run) * runs_.size());
}

#define DELASSUS_INSTANTIATE(T) template class LtlOsim<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
