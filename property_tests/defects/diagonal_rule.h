// A wrong rank decision, for tests that must see it: kkt_elimination as it once was, a pivot of A against A's own diagonal.
#pragma once

#include "algorithms/delassus.h"
#include "algorithms/kit/ldlt_pivoted.h"

namespace delassus::laws {

/// Which hard rows elimination of A leaves out where a pivot is not above 30 eps · steps · A_rr. Solves nothing.
class DiagonalRule final : public Operator<double> {
 public:
  [[nodiscard]] const std::vector<Index>& dependent_rows() const override { return dependent_; }

 protected:
  void do_analyze() override { A_->analyze(this->structure()); }
  Report do_update(const Problem<double>& p, const Damping<double>& d) override {
    const Report updated = A_->update(p, d);
    const Index m = this->size();
    MatrixX<double> a(m, m);
    Workspace<double> w(A_->workspace(m));
    const Report applied = A_->apply(MatrixX<double>::Identity(m, m), a, w);
    const VectorX<double> diagonal = a.diagonal();
    std::vector<Index> order(static_cast<std::size_t>(m));
    const Index rank = ldlt_pivoted(a.data(), m, order.data(), [&](Index row, double& pivot, Index steps) {
      return pivot > 30 * unit_roundoff<double> * static_cast<double>(steps) * diagonal[row];
    });
    dependent_.assign(order.begin() + rank, order.end());
    return updated.ok() ? applied : updated;
  }
  Report do_update_damping(const Damping<double>&) override { return {Status::not_supported}; }
  [[nodiscard]] Index do_workspace(Index) const override { return 0; }
  [[nodiscard]] Index do_bytes() const override { return 0; }

 private:
  std::unique_ptr<Operator<double>> A_ = find_operator("aba_sweep").make<double>();
  std::vector<Index> dependent_;
};

[[nodiscard]] inline OperatorRow diagonal_rule() {
  OperatorRow row = find_operator("kkt_elimination");
  std::get<Maker<double>>(row.makers) = []() -> std::unique_ptr<Operator<double>> { return std::make_unique<DiagonalRule>(); };
  return row;
}

}  // namespace delassus::laws
