// What operators share that solve to an accuracy: several columns in lanes where the operator can, the others one after the other,
// and the worst report.
#pragma once

#include <array>

#include "algorithms/kit/columns.h"
#include "algorithms/operators/operator.h"

namespace delassus {

template <class T> class ColumnByColumn : public Operator<T> {
 public:
  using Reports = std::array<Report, lane_count>;
  /// Up to lane_count columns side by side, each as solve_column would; a report of each. False: not here, or not now.
  virtual bool solve_together(ConstRef<T>, Ref<T>, Accuracy, Reports&, T*) const { return false; }

 protected:
  /// f = A⁻¹ a for m numbers each, as Operator::solve.
  virtual Report solve_column(const T* a, T* f, Accuracy wanted, T* workspace) const = 0;

 private:
  Report do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const final { return do_solve_to(a, f, Accuracy::full(), workspace); }
  Report do_solve_to(ConstRef<T> a, Ref<T> f, Accuracy wanted, T* workspace) const final {
    Report worst;
    Reports reports;
    const Index k = a.cols();
    for (Index c = 0; c < k;) {
      const Index count = has_lanes<T> && k - c >= least_lanes ? std::min(lane_count, k - c) : 1;
      if (count == 1 || !solve_together(a.middleCols(c, count), f.middleCols(c, count), wanted, reports, workspace))
        for (Index l = 0; l < count; ++l)
          reports[l] = solve_column(a.data() + (c + l) * a.outerStride(), f.data() + (c + l) * f.outerStride(), wanted, workspace);
      for (Index l = 0; l < count; ++l) worst = worse(worst, reports[l]);
      c += count;
    }
    return worst;
  }
};

}  // namespace delassus
