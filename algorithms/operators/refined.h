// What operators share that refine a pair (ν, λ): solve_pair answers solve, which asks for λ alone, and solve_kkt.
#pragma once

#include <algorithm>

#include "algorithms/factors/refinement.h"
#include "algorithms/operators/column_by_column.h"

namespace delassus {

template <class T> class Refined : public ColumnByColumn<T> {
 protected:
  using Asked = typename Refinement<T>::Asked;
  /// λ (m) and, when nu is given, ν (n) of the pair asked for, as Operator::solve_kkt.
  virtual Report solve_pair(const Asked& asked, T* lambda, T* nu, Accuracy wanted, T* workspace) const = 0;

  Report solve_column(const T* a, T* f, Accuracy wanted, T* workspace) const override {
    return solve_pair({.r2 = a}, f, nullptr, wanted, workspace);
  }

  /// solve_together by a correction that is there for lanes too; elsewhere than in double false.
  template <class Correct>
  bool in_lanes(const Refinement<T>& refinement, ConstRef<T> a, Ref<T> f, Accuracy wanted, typename Refinement<T>::Steps steps,
                const Correct& correct, typename ColumnByColumn<T>::Reports& reports, T* workspace) const {
    if constexpr (std::is_same_v<T, double>) {
      Lanes<T>* const right = reinterpret_cast<Lanes<T>*>(workspace);
      load_columns(a.data(), a.outerStride(), this->size(), a.cols(), right);
      refinement.solve_lanes(right, f.data(), f.outerStride(), static_cast<int>(a.cols()), wanted, steps, correct, right + padded(this->size()), reports.data());
      return true;
    }
    return false;
  }
  /// Scalars for so many columns, from those for one.
  [[nodiscard]] Index workspace_of(Index columns, Index of_one) const {
    return std::is_same_v<T, double> && columns >= least_lanes ? lane_count * (padded(this->size()) + of_one) : of_one;
  }

 private:
  Report do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy wanted, Start start, T* workspace) const final {
    const bool given = start == Start::given, none = std::all_of(r1, r1 + this->structure()->dofs(), [](const T& x) { return x == T(0); });
    return solve_pair({none ? nullptr : r1, r2, given ? nu : nullptr, given ? lambda : nullptr}, lambda, nu, wanted, workspace);
  }
};

}  // namespace delassus
