// Dependent hard rows, and that the tests of them can fail.
#include <gtest/gtest.h>

#include "property_tests/defects/defects_wrong.h"
#include "property_tests/defects/diagonal_rule.h"
#include "property_tests/unit/operators/rank.h"

namespace delassus::laws::rank_test {
namespace {

TEST(Rank, DependentRows) {
  for (const std::string_view name : {"kkt_elimination", "dense_refined"}) EXPECT_EQ(dependent_rows_wrong(find_operator(name)), "");
}

enum class Defect : std::uint8_t { none, contradictions_answered, last_row_named, damped_rows_left_out };

/// kkt_elimination with a defect.
template <Defect defect> class Careless final : public Operator<double> {
 public:
  [[nodiscard]] const std::vector<Index>& dependent_rows() const override { return inner_->dependent_rows(); }

 protected:
  void do_analyze() override { inner_->analyze(this->structure()); }
  Report do_update(const Problem<double>& p, const Damping<double>& d) override { return inner_->update(p, seen(d)); }
  Report do_update_damping(const Damping<double>& d) override { return inner_->update_damping(seen(d)); }
  Report do_solve(ConstRef<double> a, Ref<double> f, double* work) const override {
    Workspace<double> w(work, inner_->workspace(1));
    Report r = inner_->solve(a, f, w);
    if (defect == Defect::contradictions_answered && r.status == Status::inconsistent) r = {};
    if (defect == Defect::last_row_named && !r.ok()) r.where = a.rows() - 1;
    return r;
  }
  [[nodiscard]] Index do_workspace(Index) const override { return inner_->workspace(1); }
  [[nodiscard]] Index do_bytes() const override { return inner_->bytes(); }

 private:
  static Damping<double> seen(Damping<double> d) {
    for (double& x : d.diagonal)
      if (defect == Defect::damped_rows_left_out && x < 0x1p-30) x = 0;
    return d;
  }
  std::unique_ptr<Operator<double>> inner_ = find_operator("kkt_elimination").make<double>();
};

template <Defect defect> OperatorRow careless() {
  OperatorRow row = find_operator("kkt_elimination");
  std::get<Maker<double>>(row.makers) = []() -> std::unique_ptr<Operator<double>> { return std::make_unique<Careless<defect>>(); };
  return row;
}

TEST(Rank, DependentRowsCanFail) {
  EXPECT_EQ(dependent_rows_wrong(careless<Defect::none>()), "");
  EXPECT_NE(dependent_rows_wrong(careless<Defect::contradictions_answered>()), "");
  EXPECT_NE(dependent_rows_wrong(careless<Defect::last_row_named>()), "");
  EXPECT_NE(dependent_rows_wrong(careless<Defect::damped_rows_left_out>()), "");
  OperatorRow refusing = find_operator("dense_refined");
  refusing.name = "kkt_elimination";
  EXPECT_NE(dependent_rows_wrong(refusing), "");
}

/// Linkages along the axes pass by the rule of A's diagonal, turned ones do not.
TEST(Rank, LawsOfTurnedAxesCanFail) {
  const auto passed = [](const char* law, const OperatorRow& row, std::uint64_t seed) {
    return check(find_law(law), row, make_case("crank_rocker", 4, seed)).passed();
  };
  int failed = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const char* law : {"rank in turned axes", "rank reordered", "rank in other units", "consistent rows answered"})
      EXPECT_TRUE(passed(law, find_operator("kkt_elimination"), seed)) << law << seed;
    failed += passed("rank in turned axes", diagonal_rule(), seed) ? 0 : 1;
  }
  EXPECT_GT(failed, 5);
}

/// Rows that contradict one another, answered in silence with the forces of R⁻¹ + 2^softness.
template <int softness> OperatorRow softened() {
  return defect<Place::damping>("softened", "", [](auto d) {
           using T = scalar_of<decltype(d)>;
           for (T& x : d.d.diagonal)
             if constexpr (!ScalarTraits<T>::exact) x += T(std::ldexp(1.0, softness));
         }).op;
}

TEST(Rank, RefusalsCanFail) {
  const Case c = make_case("hard_redundant", 2, 1);  // the bound is about 2¹² per force: 2⁻⁴⁰ is rounding
  const auto passed = [&](const OperatorRow& row) { return check(find_law("refuses as in exact arithmetic"), row, c).passed(); };
  EXPECT_EQ(softened<-20>().solve_error, ErrorClass::normwise);
  EXPECT_TRUE(passed(find_operator("dense_cholesky")));
  EXPECT_FALSE(passed(softened<-20>()));
  EXPECT_FALSE(passed(softened<-34>()));
  EXPECT_TRUE(passed(softened<-40>()));
}

/// not_converged is excused only where the operator's own product hides how good the best answer is.
TEST(Rank, RefusalsOfWhatIsSolvedCanFail) {
  const OperatorRow gives_up = defect<Place::answer>("gives_up", "", [](auto a) {
                                 if (a.solve && std::is_same_v<scalar_of<decltype(a)>, double>) a.report.status = Status::not_converged;
                               }).op;
  ASSERT_EQ(gives_up.solve_error, ErrorClass::normwise);
  ASSERT_TRUE(gives_up.applies);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Case c = make_case("hard", 4, seed);
    EXPECT_TRUE(check(find_law("refuses as in exact arithmetic"), find_operator("cg"), c).passed()) << seed;
    EXPECT_FALSE(check(find_law("refuses as in exact arithmetic"), gives_up, c).passed()) << seed;
  }
}

}  // namespace
}  // namespace delassus::laws::rank_test
