// What operators share that solve to an accuracy: one column after the other, and the worst report.
#pragma once

#include "algorithms/operators/operator.h"

namespace delassus {

template <class T> class ColumnByColumn : public Operator<T> {
 protected:
  /// f = A⁻¹ a for m numbers each, as Operator::solve.
  virtual Report solve_column(const T* a, T* f, Accuracy wanted, T* workspace) const = 0;

 private:
  Report do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const final { return do_solve_to(a, f, Accuracy::full(), workspace); }
  Report do_solve_to(ConstRef<T> a, Ref<T> f, Accuracy wanted, T* workspace) const final {
    Report worst;
    for (Index c = 0; c < a.cols(); ++c)
      worst = worse(worst, solve_column(a.data() + c * a.outerStride(), f.data() + c * f.outerStride(), wanted, workspace));
    return worst;
  }
};

}  // namespace delassus
