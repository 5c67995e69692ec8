#include "algorithms/operators/ltl_kkt.h"

#include <algorithm>

#include "algorithms/kit/instantiate.h"
#include "algorithms/kit/thin_product.h"

namespace delassus {

template <class T> void LtlKkt<T>::analyze_form() {
  Ltl<T>::analyze_form();
  const Structure& s = *this->structure();
  const auto& rows = this->rows_;
  Index most = 0;
  std::vector<Index> body_of(static_cast<std::size_t>(s.dofs()));
  for (Index i = 0; i < s.bodies(); ++i) std::fill(body_of.begin() + s.first_dof[i], body_of.begin() + s.first_dof[i + 1], i);
  const auto for_joints = [&](const auto& visit) {  // groups, and the joints they are reached by
    for (Index of = 0; of < static_cast<Index>(rows.groups().size()); ++of) {
      const auto& g = rows.groups()[of];
      most = std::max(most, g.rows);
      for (Index p = 0; p < g.count; p += s.dofs(body_of[rows.dof(g, p)])) visit(body_of[rows.dof(g, p)], Reached{of, p});
    }
  };
  first_reached_.assign(static_cast<std::size_t>(s.bodies()) + 1, 0);
  for_joints([&](Index body, const Reached&) { ++first_reached_[body + 1]; });
  for (Index i = 0; i < s.bodies(); ++i) first_reached_[i + 1] += first_reached_[i];
  reached_.assign(static_cast<std::size_t>(first_reached_.back()), {});
  std::vector<Index> next = first_reached_;
  for_joints([&](Index body, const Reached& x) { reached_[next[body]++] = x; });
  scaled_.assign(static_cast<std::size_t>(6 * most), T(0));
}

template <class T> void LtlKkt<T>::form(const Problem<T>& problem, MatrixX<T>& A0) {
  const Structure& s = *this->structure();
  auto& rows = this->rows_;
  rows.assemble(problem);
  for (Index i = s.bodies(); i-- > 0;) {
    const Index n = s.dofs(i), end = first_reached_[i + 1];
    for (Index x = first_reached_[i]; x < end; ++x) {
      const auto& g = rows.groups()[reached_[x].group];
      for (Index k = n; k-- > 0;) rows.eliminate(g, reached_[x].place + k);
    }
    for (Index x = first_reached_[i]; x < end; ++x) {
      const auto& g = rows.groups()[reached_[x].group];
      for (Index k = 0; k < n; ++k)
        for (Index r = 0; r < g.rows; ++r)
          scaled_[k * g.rows + r] = rows.column(g, reached_[x].place + k)[r] * this->factor_.inverse_pivot(s.first_dof[i] + k);
      for (Index y = x; y < end; ++y) {
        const auto& h = rows.groups()[reached_[y].group];
        add_thin_product(&A0(h.row, g.row), A0.rows(), rows.column(h, reached_[y].place), h.rows, scaled_.data(), g.rows, n);
      }
    }
  }
}

template <class T> Index LtlKkt<T>::form_bytes() const {
  return Ltl<T>::form_bytes() + static_cast<Index>(sizeof(T) * scaled_.size() + sizeof(Reached) * reached_.size() + sizeof(Index) * first_reached_.size());
}

#define DELASSUS_INSTANTIATE(T) template class LtlKkt<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
