// The randomised search: classes occur in the shares promised, right operators pass, wrong ones are found and shrunk,
// shards together do what one search does.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "algorithms/kit/test_scalars.h"
#include "generators/arbitrary.h"
#include "generators/classes.h"
#include "generators/draft.h"
#include "property_tests/laws/known.h"
#include "property_tests/laws/search.h"
#include "reference/definition.h"

namespace delassus::laws::stress_test {
namespace {

using generators::Spec;

TEST(Classes, SharesOverPinnedSeeds) {
  constexpr std::uint64_t seeds = 4000;
  std::vector<int> count(generators::classes().size(), 0);
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Spec spec = generators::arbitrary(seed);
    const std::vector<bool> in = generators::classes_of(spec, generators::build(spec));
    for (std::size_t k = 0; k < in.size(); ++k) count[k] += in[k] ? 1 : 0;
  }
  for (std::size_t k = 0; k < count.size(); ++k) {
    const generators::ClassRow& row = generators::classes()[k];
    EXPECT_GE(static_cast<double>(count[k]), row.least_share * static_cast<double>(seeds)) << row.name;
    EXPECT_LT(count[k], static_cast<int>(seeds)) << row.name << ": every problem";
  }
}

TEST(Classes, RankIsThatOfJByTheDefinition) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Spec spec = generators::arbitrary(seed);
    const generators::Built b = generators::build(spec);
    const Structure& s = *b.problem.structure;
    if (spec.bodies.size() > 4 || s.rows == 0 || s.dofs() == 0) continue;
    const MatrixX<Rational> J = reference::dense(b.problem.cast<Rational>(), b.damping.cast<Rational>()).J;
    const MatrixX<double> rounded = converted<double>(J);
    EXPECT_EQ(generators::rank_of_J(b.problem), Eigen::FullPivLU<MatrixX<double>>(rounded).rank()) << generators::to_json(spec);
  }
}

TEST(Classes, CoupledLoopsShareABodyThatMovesBetweenTheirEnds) {
  const auto coupled = [](const std::vector<std::vector<Index>>& loops) {
    generators::Draft d("star", 1);
    d.body(-1);
    for (int k = 0; k < 4; ++k) d.body(0);
    for (const std::vector<Index>& on : loops) d.link(generators::ConstraintKind::point, on);
    const auto& table = generators::classes();
    const std::vector<bool> in = generators::classes_of(d.spec, generators::build(d.spec));
    for (std::size_t k = 0; k < table.size(); ++k)
      if (table[k].name == "coupled loops") return static_cast<bool>(in[k]);
    throw std::logic_error("no such class");
  };
  EXPECT_TRUE(coupled({{1, 2}, {2, 3}}));
  EXPECT_FALSE(coupled({{1, 2}, {3, 4}})) << "they share the hub only, which moves both alike";
  EXPECT_FALSE(coupled({{1, 2}, {2, 1}})) << "one loop, twice";
  EXPECT_FALSE(coupled({{1, 2}, {2}})) << "a constraint to the ground";
}

/// dense_cholesky of a changed problem, or with a changed answer.
enum class Wrongness { drops_last_row, no_armature, joint_rows_negated, forgets_one_link, one_part_in_1e9, swaps_ends };

template <class T> class Wrong final : public Operator<T> {
 public:
  explicit Wrong(Wrongness w) : wrongness_(w), inner_(find_operator("dense_cholesky").make<T>()) {}

 protected:
  void do_analyze() override { inner_->analyze(this->structure()); }
  Report do_update(const Problem<T>& p, const Damping<T>& d) override {
    Problem<T> q = p;
    if (wrongness_ == Wrongness::drops_last_row && !q.K.empty()) q.K.back().setZero();
    if (wrongness_ == Wrongness::no_armature) std::fill(q.armature.begin(), q.armature.end(), T(0));
    if (wrongness_ == Wrongness::joint_rows_negated)
      for (T& k : q.joint_K) k = -k;
    if (wrongness_ == Wrongness::forgets_one_link)
      for (const auto& e : p.structure->link_constraints)
        for (Index r = 0; e.links.size() > 1 && r < e.rows; ++r) q.K[static_cast<std::size_t>(e.links[1].first + r)].setZero();
    return inner_->update(q, d);
  }
  Report do_update_damping(const Damping<T>& d) override { return inner_->update_damping(d); }
  Report do_apply(ConstRef<T> f, Ref<T> a, T*) const override { return answer(f, a, true); }
  Report do_solve(ConstRef<T> a, Ref<T> f, T*) const override { return answer(a, f, false); }
  [[nodiscard]] Index do_workspace(Index) const override { return 1; }
  [[nodiscard]] Index do_bytes() const override { return 0; }

 private:
  Report answer(ConstRef<T> x, Ref<T> y, bool apply) const {
    Workspace<T> w(inner_->workspace(x.cols()));
    const Report r = apply ? inner_->apply(x, y, w) : inner_->solve(x, y, w);
    if (r.ok() && y.size() > 0 && wrongness_ == Wrongness::one_part_in_1e9) y *= T(1 + 0x1p-30);
    if (r.ok() && y.size() > 0 && wrongness_ == Wrongness::swaps_ends) y.row(0).swap(y.row(y.rows() - 1));
    return r;
  }
  Wrongness wrongness_;
  std::unique_ptr<Operator<T>> inner_;
};

template <Wrongness W, class T> std::unique_ptr<Operator<T>> make() { return std::make_unique<Wrong<T>>(W); }

template <Wrongness W> OperatorRow wrong() {
  OperatorRow r = find_operator("dense_cholesky");
  r.name = "wrong";
  r.makers = {};
  std::get<Maker<double>>(r.makers) = make<W, double>;
  std::get<Maker<Rational>>(r.makers) = make<W, Rational>;
  return r;
}

TEST(Search, FindsWrongOperatorsAndShrinksThem) {
  const std::vector<OperatorRow> all{wrong<Wrongness::drops_last_row>(),     wrong<Wrongness::no_armature>(),
                                     wrong<Wrongness::joint_rows_negated>(), wrong<Wrongness::forgets_one_link>(),
                                     wrong<Wrongness::one_part_in_1e9>(),    wrong<Wrongness::swaps_ends>()};
  for (std::size_t k = 0; k < all.size(); ++k) {
    Search s;
    s.seed = 7;
    s.count = 400;
    s.ops = {all[k]};
    const Found f = search(s);
    ASSERT_EQ(f.failures.size(), 1u) << "wrong operator " << k;
    const Failure& x = f.failures[0];
    EXPECT_LE(x.spec.bodies.size(), 4u) << k << generators::to_json(x.spec);
    EXPECT_LT(f.seconds, 30) << k;
    EXPECT_TRUE(check(find_law(x.law), all[k], make_case(x.spec)).failed()) << k;
    EXPECT_FALSE(check(find_law(x.law), find_operator("dense_cholesky"), make_case(x.spec)).failed()) << k;
    std::printf("wrong operator %zu: %s, problem %lld, %zu bodies shrunk to %zu in %d steps, %.2f s\n", k, x.law.c_str(),
                static_cast<long long>(f.problems), x.found_bodies, x.spec.bodies.size(), x.tried, f.seconds);
  }
}

Found part(int shard, int shards) {
  Search s;
  s.seed = 1000;
  s.count = 60;
  s.shard = shard;
  s.shards = shards;
  s.ops = {find_operator("lcaba"), wrong<Wrongness::no_armature>()};
  s.most_failures = 1000;
  return search(s);
}

TEST(Search, ShardsTogetherAreTheWhole) {
  const Found whole = part(1, 1), together = merged({part(2, 3), part(1, 3), part(3, 3)});
  EXPECT_EQ(together.problems, whole.problems);
  EXPECT_EQ(together.problems, 60);
  EXPECT_EQ(together.checks, whole.checks);
  EXPECT_EQ(together.skipped, whole.skipped);
  EXPECT_EQ(together.classes, whole.classes);
  ASSERT_FALSE(whole.failures.empty());
  ASSERT_EQ(together.failures.size(), whole.failures.size());
  for (std::size_t k = 0; k < whole.failures.size(); ++k) {
    EXPECT_EQ(together.failures[k].law, whole.failures[k].law);
    EXPECT_EQ(generators::to_json(together.failures[k].spec), generators::to_json(whole.failures[k].spec));
  }
}

TEST(Search, OnlyShardsOfOneSearchAreMerged) {
  Found a, b;
  a.shards = b.shards = 2;
  b.shard = 2;
  EXPECT_NO_THROW(static_cast<void>(merged({a, b})));
  EXPECT_THROW(static_cast<void>(merged({a, a})), ModelError);
  EXPECT_THROW(static_cast<void>(merged({a})), ModelError);
  EXPECT_THROW(static_cast<void>(merged({})), ModelError);
  b.seed = 9;
  EXPECT_THROW(static_cast<void>(merged({a, b})), ModelError);
}

TEST(Search, EveryLawIsChosenSometimes) {
  for (const LawRow& law : laws()) {
    int chosen_on = 0;
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
      Spec spec;
      spec.seed = seed;
      chosen_on += chosen(law, spec) ? 1 : 0;
    }
    EXPECT_GT(chosen_on, 10) << law.name;
  }
}

}  // namespace
}  // namespace delassus::laws::stress_test
