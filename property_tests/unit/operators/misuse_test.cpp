// Every operator refuses misuse. That the check can fail: property_tests/mutation/mutate.py runs it on mutants of the sources.
#include "algorithms/kit/test_scalars.h"
#include "property_tests/unit/operators/misuse.h"

#include <gtest/gtest.h>

#include "algorithms/operators/aba_sweep.h"
#include "algorithms/operators/cg.h"
#include "algorithms/operators/lcaba.h"

namespace delassus::misuse_test {
namespace {

TEST(Misuse, IsRefusedByEveryOperator) {
  for (const OperatorRow& row : operators()) EXPECT_EQ(misuse_accepted(row), "");
}

TEST(Misuse, NobodyCopiesWhatPointsIntoItself) {
  static_assert(!std::is_copy_constructible_v<Workspace<double>> && !std::is_copy_assignable_v<Workspace<double>>);
  static_assert(std::is_nothrow_move_constructible_v<Workspace<double>> && std::is_nothrow_move_assignable_v<Workspace<double>>);
  static_assert(!std::is_copy_constructible_v<Operator<double>> && !std::is_copy_assignable_v<Operator<double>>);
  static_assert(!std::is_copy_constructible_v<AbaSweep<double>> && !std::is_move_constructible_v<AbaSweep<double>>);
  static_assert(!std::is_copy_constructible_v<Lcaba<double>> && !std::is_copy_constructible_v<Cg<double>>);
  std::vector<Workspace<double>> per_thread;
  for (int t = 0; t < 4; ++t) per_thread.emplace_back(100);
  for (std::size_t t = 0; t < 4; ++t) per_thread[t].fill(static_cast<double>(t));
  for (std::size_t t = 0; t < 4; ++t)
    for (Index k = 0; k < 100; ++k) EXPECT_EQ(per_thread[t].data()[k], static_cast<double>(t));
  Workspace<double> taken = std::move(per_thread[2]);
  EXPECT_EQ(taken.size(), 100);
  EXPECT_EQ(taken.data()[99], 2);
  EXPECT_EQ(per_thread[2].size(), 0);
  EXPECT_EQ(per_thread[2].data(), nullptr);
  per_thread[2] = std::move(taken);
  EXPECT_EQ(per_thread[2].data()[0], 2);
  EXPECT_EQ(taken.size(), 0);
}

template <class T> void expect_alignment_asked_for(std::size_t alignment) {
  Workspace<T> all(64);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(all.data()) % alignment, 0u);
  EXPECT_NO_THROW(Workspace<T>(all.data(), 64));
  EXPECT_NO_THROW(Workspace<T>(all.data() + 8, 56));
  if (alignment > sizeof(T)) {
    EXPECT_THROW(Workspace<T>(all.data() + 1, 63), std::logic_error);
  }
}

TEST(Misuse, WorkspaceAsksForItsAlignment) {
  expect_alignment_asked_for<double>(64);
  expect_alignment_asked_for<float>(32);
  expect_alignment_asked_for<Quad>(64);
  expect_alignment_asked_for<Counted>(64);
  expect_alignment_asked_for<Rational>(alignof(Rational));
  expect_alignment_asked_for<PrimeField>(64);
}

/// Fails in do_analyze as often as told.
class Failing final : public Operator<double> {
 public:
  int failures = 1;

 protected:
  void do_analyze() override {
    if (failures-- > 0) throw std::bad_alloc();
  }
  Report do_update(const Problem<double>&, const Damping<double>&) override { return {}; }
  Report do_update_damping(const Damping<double>&) override { return {}; }
  [[nodiscard]] Index do_workspace(Index) const override { return 0; }
  [[nodiscard]] Index do_bytes() const override { return 0; }
};

TEST(Misuse, AnalyzeThatThrowsLeavesNothingAnalyzed) {
  Structure s;
  s.add_body(ground, 1);
  const Problem<double> p(std::make_shared<const Structure>(s));
  const Damping<double> none = Damping<double>::uniform(0, 0);
  Failing op;
  EXPECT_THROW(op.analyze(p.structure), std::bad_alloc);
  EXPECT_EQ(op.structure(), nullptr);
  EXPECT_EQ(op.size(), 0);
  EXPECT_THROW(static_cast<void>(op.update(p, none)), std::logic_error);
  EXPECT_THROW(static_cast<void>(op.workspace()), std::logic_error);
  op.analyze(p.structure);
  EXPECT_TRUE(op.update(p, none).ok());
  op.failures = 1;
  EXPECT_THROW(op.analyze(p.structure), std::bad_alloc);
  EXPECT_THROW(static_cast<void>(op.update_damping(none)), std::logic_error);
}

template <class T> void expect_made_or_refused(const OperatorRow& row) {
  if (std::get<Maker<T>>(row.makers) != nullptr) {
    EXPECT_NE(row.make<T>(), nullptr);
  } else {
    EXPECT_THROW(static_cast<void>(row.make<T>()), std::logic_error) << row.name;
  }
}

TEST(Misuse, AScalarThatIsNotServedIsRefused) {
  EXPECT_THROW(static_cast<void>(find_operator("lcaba_float").make<float>()), std::logic_error);
  for (const OperatorRow& row : operators()) {
    expect_made_or_refused<double>(row);
    expect_made_or_refused<float>(row);
    expect_made_or_refused<Quad>(row);
    expect_made_or_refused<Counted>(row);
    expect_made_or_refused<Rational>(row);
    expect_made_or_refused<PrimeField>(row);
  }
}

/// A chain of two revolute joints; row 1 is row 0, row 2 moves nothing.
Problem<double> two_dependent_rows() {
  Structure s;
  s.add_body(ground, 1);
  s.add_body(0, 1);
  s.add_link_constraint(3, {1});
  Problem<double> p(std::make_shared<const Structure>(s));
  for (std::size_t i = 0; i < 2; ++i) {
    p.S[i] << 0, 0, 1, 0, static_cast<double>(i), 0;
    p.H[i].setIdentity();
  }
  p.K[0] << 0, 0, 1, 0, 0, 0;
  p.K[1] = p.K[0];
  p.K[2] << 1, 0, 0, 0, 0, 0;
  return p;
}

TEST(Where, SaysWhetherItIsARowOrADegreeOfFreedom) {
  const Problem<double> p = two_dependent_rows();
  const auto hard = Damping<double>::uniform(3, 0), soft = Damping<double>::uniform(3, 1);
  MatrixX<double> a = MatrixX<double>::Ones(3, 1), f(3, 1);
  for (const OperatorRow& row : operators()) {
    const auto op = row.make<double>();
    op->analyze(p.structure);
    Workspace<double> w(op->workspace());
    const auto expect = [&](const Report& r, const char* when) {
      EXPECT_LT(r.where, r.at_row() ? 3 : 2) << row.name << " " << when;
      if (r.ok()) {
        EXPECT_EQ(r.where, -1) << row.name << " " << when;
      }
    };
    expect(op->update(p, hard), "update with hard rows");
    if (row.solves) {
      const Report r = op->solve(a, f, w);
      expect(r, "solve with hard rows");
      if (r.where >= 0) {
        EXPECT_TRUE(r.at_row()) << row.name;
      }
    }
    if (row.decides_rank) {
      EXPECT_FALSE(op->dependent_rows().empty()) << row.name;
    }
    Problem<double> massless = p;
    for (auto& H : massless.H) H.setZero();
    for (const auto& d : {hard, soft}) {
      const Report r = op->update(massless, d);
      expect(r, "update without mass");
      EXPECT_FALSE(r.ok()) << row.name;
      if (r.status == Status::lost_pivot) {
        EXPECT_FALSE(r.at_row()) << row.name;
      }
      EXPECT_TRUE(op->dependent_rows().empty()) << row.name << ", after an update that failed";
    }
    a(0, 0) = std::numeric_limits<double>::quiet_NaN();
    const Report r = row.solves ? op->solve(a, f, w) : op->apply(a, f, w);
    EXPECT_TRUE(r.status == Status::not_finite && r.where == -1) << row.name;
    a(0, 0) = 1;
  }
}

}  // namespace
}  // namespace delassus::misuse_test
