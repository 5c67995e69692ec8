// Defects of rank decisions: kkt_elimination that decides by what the description says and not the mechanism.
#include <algorithm>

#include "property_tests/defects/defects.h"
#include "property_tests/defects/diagonal_rule.h"

namespace delassus::laws {
namespace {

enum class Fault : std::uint8_t { diagonal, last_row, size, refused };

/// kkt_elimination, right but for what it says of dependent rows.
template <Fault fault> class WrongRank final : public Operator<double> {
 public:
  [[nodiscard]] const std::vector<Index>& dependent_rows() const override { return dependent_; }

 protected:
  void do_analyze() override { right_->analyze(this->structure()), rule_.analyze(this->structure()); }
  Report do_update(const Problem<double>& p, const Damping<double>& d) override {
    const Report report = right_->update(p, d);
    dependent_ = right_->dependent_rows();
    if (fault == Fault::diagonal && rule_.update(p, d).ok()) dependent_ = rule_.dependent_rows();
    if (fault == Fault::last_row && !dependent_.empty() && dependent_.back() == this->size() - 1) dependent_.pop_back();
    if (fault == Fault::size) leave_out_small(p);
    return report;
  }
  Report do_update_damping(const Damping<double>& d) override {
    const Report report = right_->update_damping(d);
    dependent_ = right_->dependent_rows();
    return report;
  }
  Report do_apply(ConstRef<double> f, Ref<double> a, double* work) const override {
    Workspace<double> w(work, do_workspace(a.cols()));
    return right_->apply(f, a, w);
  }
  Report do_solve(ConstRef<double> a, Ref<double> f, double* work) const override { return do_solve_to(a, f, Accuracy::full(), work); }
  Report do_solve_to(ConstRef<double> a, Ref<double> f, Accuracy wanted, double* work) const override {
    Workspace<double> w(work, do_workspace(a.cols()));
    const Report report = right_->solve(a, f, wanted, w);
    if (fault != Fault::refused || dependent_.empty() || !report.ok()) return report;
    f.setConstant(std::numeric_limits<double>::quiet_NaN());
    return {Status::inconsistent, dependent_.front()};
  }
  [[nodiscard]] Index do_workspace(Index columns) const override { return right_->workspace(columns); }
  [[nodiscard]] Index do_bytes() const override { return right_->bytes(); }

 private:
  /// Rows of K a thousand times smaller than the largest count as none.
  void leave_out_small(const Problem<double>& p) {
    double largest = 0;
    for (const auto& k : p.K) largest = std::max(largest, k.norm());
    dependent_.clear();
    for (const auto& e : this->structure()->link_constraints)
      for (Index r = 0; r < e.rows; ++r)
        if (p.K[static_cast<std::size_t>(e.links.front().first + r)].norm() < largest / 1000) dependent_.push_back(e.row + r);
  }

  std::unique_ptr<Operator<double>> right_ = find_operator("kkt_elimination").make<double>();
  DiagonalRule rule_;
  std::vector<Index> dependent_;
};

template <Fault fault> DefectRow wrong(std::string_view name, const char* what) {
  OperatorRow row = find_operator("kkt_elimination");
  row.name = name;
  row.makers = {[]() -> std::unique_ptr<Operator<double>> { return std::make_unique<WrongRank<fault>>(); }, nullptr, nullptr, nullptr, nullptr, nullptr};
  return {name, what, "kkt_elimination", row, "only some linkages with hard rows show it", true};
}

}  // namespace

std::vector<DefectRow> rank_defects() {
  return {wrong<Fault::diagonal>("rank_by_diagonal", "pivots of A against its own diagonal"),
          wrong<Fault::last_row>("last_row_independent", "the last row never depends on others"),
          wrong<Fault::size>("small_rows_left_out", "rows count as dependent when they are small"),
          wrong<Fault::refused>("dependent_refused", "dependent rows are called contradictory")};
}

}  // namespace delassus::laws
