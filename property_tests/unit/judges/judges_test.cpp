// Who judges the judges: references that are not each other, bounds that are reached, generators that make what they are
// named after, and a summary that counts what is broken.
#include <gtest/gtest.h>

#include <Eigen/QR>

#include <algorithm>
#include <set>
#include <sstream>

#include "algorithms/kit/test_scalars.h"
#include "generators/arbitrary.h"
#include "generators/build.h"
#include "generators/families.h"
#include "property_tests/laws/summary.h"
#include "property_tests/unit/judges/reference_cases.h"
#include "reference/definition.h"
#include "reference/reference.h"
#include "reference/sensitivity.h"

namespace delassus::judges_test {
namespace {

using namespace reference::cases;
using reference::cases::Matrix;
using reference::ReferenceRow;
using reference::references;
using reference::Sensitivity;

MatrixX<Quad> answer(const ReferenceRow& r, const Case& c, bool solve) {
  const Matrix x = random_right_side(7, c.problem.structure->rows);
  return (solve ? r.solve : r.apply)(c.problem, c.damping, x);
}

/// One that answered with another one's answer would give its bits: their rounding is their own.
TEST(Judges, ReferencesAreNotEachOther) {
  for (const ReferenceRow& r : references())
    for (const ReferenceRow& other : references()) {
      if (&r >= &other) continue;
      for (const bool solve : {false, true}) {
        int different = 0;
        for (unsigned seed = 1; seed <= 4; ++seed) {
          const Case c = random_case(seed, 5, 2);
          if (!(answer(r, c, solve) == answer(other, c, solve))) ++different;
        }
        EXPECT_EQ(different, 4) << r.name << " and " << other.name << (solve ? ", solve" : ", apply");
      }
    }
}

/// A double rounded once is wrong in the 53rd digit; what is refined, not before the 60th.
TEST(Judges, SparseReferenceIsRefined) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Case c = random_case(seed, 5, 2);
    for (const bool solve : {false, true}) {
      const MatrixX<Quad> exact = answer(references()[0], c, solve), refined = answer(references()[2], c, solve);
      Quad error(0), size(0);
      for (Index r = 0; r < exact.rows(); ++r) {
        error = std::max(error, abs(Quad(exact(r, 0) - refined(r, 0))));
        size = std::max(size, abs(exact(r, 0)));
      }
      EXPECT_LT(static_cast<double>(error / size), 0x1p-58) << seed;
    }
  }
}

/// Every number of a problem counts for every reference: one changed, and the answer is another.
TEST(Judges, ReferencesReadEveryNumber) {
  const Case c = random_case(3, 4, 2);
  for (const ReferenceRow& r : references())
    for (const bool solve : {false, true}) {
      const MatrixX<Quad> before = answer(r, c, solve);
      const auto changed = [&](const auto& change) {
        Case other = c;
        change(other);
        return !(answer(r, other, solve) == before);
      };
      EXPECT_TRUE(changed([](Case& o) { o.problem.S[1][0] += 0.25; })) << r.name;
      EXPECT_TRUE(changed([](Case& o) { o.problem.H[2].diagonal()[3] += 0.25; })) << r.name;
      EXPECT_TRUE(changed([](Case& o) { o.problem.armature[0] += 0.25; })) << r.name;
      EXPECT_TRUE(changed([](Case& o) { o.problem.K[0][4] += 0.25; })) << r.name;
      EXPECT_TRUE(changed([](Case& o) { o.problem.joint_K[0] += 0.25; })) << r.name;
      EXPECT_TRUE(changed([](Case& o) { o.damping.diagonal[0] += 0.25; })) << r.name;
      EXPECT_TRUE(changed([](Case& o) { o.damping.diagonal.back() += 0.25; })) << r.name;
    }
}

/// Largest error of 32 problems relative to eps · bound, numbers of the data changed by ±eps: not far below what is allowed.
TEST(Judges, BoundsOfTheDataAreReached) {
  constexpr double epsilon = 0x1p-40;
  double apply = 0, solve = 0, norm = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Case c = random_case(seed, 5, 2);
    const Matrix x = random_right_side(seed, c.problem.structure->rows);
    const Sensitivity bounds(c.problem, c.damping);
    const VectorX<Quad> a = references()[0].apply(c.problem, c.damping, x).col(0), f = bounds.solve(x.col(0));
    for (int draw = 0; draw < 4; ++draw) {
      std::mt19937 engine(100 * seed + static_cast<unsigned>(draw));
      Case other = c;
      const auto change = [&](double& n) { n *= engine() % 2 ? 1 + epsilon : 1 - epsilon; };
      for (auto& s : other.problem.S) for (Index i = 0; i < 6; ++i) change(s[i]);
      for (auto& k : other.problem.K) for (Index i = 0; i < 6; ++i) change(k[i]);
      for (auto& d : other.damping.diagonal) change(d);
      const VectorX<Quad> a2 = references()[0].apply(other.problem, other.damping, x).col(0), f2 = references()[0].solve(other.problem, other.damping, x).col(0);
      apply = std::max(apply, ratio(a2, a, bounds.apply_sensitivity(x.col(0)), epsilon));
      solve = std::max(solve, ratio(f2, f, bounds.solve_sensitivity(x.col(0), rounded(f)), epsilon));
      norm = std::max(norm, ratio(f2, f, bounds.solve_normwise(x.col(0), rounded(f)), epsilon));
    }
  }
  EXPECT_GT(apply, 1.0 / 64);
  EXPECT_GT(solve, 1.0 / 256);
  EXPECT_GT(norm, 1.0 / 4096);
  EXPECT_LT(std::max({apply, solve, norm}), 30);
}

/// max|λ| is the largest part of it, and where R is small √R_rr √(λᵀa).
TEST(Judges, RefinedBoundIsTheLargestForce) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Case c = random_case(seed, 4, 1);
    const Matrix x = random_right_side(seed, c.problem.structure->rows);
    const Sensitivity bounds(c.problem, c.damping);
    const Vector f = rounded(bounds.solve(x.col(0))), bound = bounds.solve_refined(x.col(0), f);
    const double largest = f.cwiseAbs().maxCoeff(), energy = std::sqrt(f.dot(x.col(0)));
    for (Index r = 0; r < f.size(); ++r) {
      const double expected = std::min(largest, energy / std::sqrt(c.damping.diagonal[static_cast<std::size_t>(r)]));
      EXPECT_NEAR(bound[r], expected, 1e-9 * expected + 1e-12 * largest) << seed << ", row " << r;
    }
  }
}

}  // namespace
}  // namespace delassus::judges_test

namespace delassus::generators::judges_test {
namespace {

struct Share {
  int massless = 0, hard = 0, partly_hard = 0, free_base = 0, several_trees = 0, loops = 0, block = 0, joint_rows = 0, three_links = 0,
      fixed = 0, many_freedoms = 0, armature = 0, to_ground = 0;
};

/// The branches of the random search, each often enough to be met in a minute of it.
TEST(Judges, TheRandomSearchTakesEveryBranch) {
  Share n;
  constexpr int draws = 400;
  for (std::uint64_t seed = 1; seed <= draws; ++seed) {
    const Spec s = arbitrary(seed);
    int roots = 0, zero = 0, soft = 0;
    bool massless = false, free_base = false, many = false, fixed = false, armature = false;
    for (const BodySpec& b : s.bodies) {
      roots += b.parent < 0;
      massless |= !b.mass_decade;
      free_base |= b.parent < 0 && dof_count(b) == 6;
      many |= dof_count(b) > 1 && dof_count(b) < 6;
      fixed |= dof_count(b) == 0;
      armature |= b.armature_decade.has_value();
    }
    const auto damping = [&](const DampingSpec& d) { (d.kind == DampingKind::zero ? zero : soft) += 1; };
    bool loop = false, three = false, block = false, ground_alone = false;
    for (const auto& e : s.links) {
      damping(e.damping);
      loop |= e.bodies.size() > 1;
      three |= e.bodies.size() > 2;
      ground_alone |= e.bodies.size() == 1;
      block |= e.damping.kind == DampingKind::block;
    }
    for (const auto& e : s.joints) damping(e.damping);
    n.massless += massless, n.free_base += free_base, n.many_freedoms += many, n.fixed += fixed, n.armature += armature;
    n.hard += zero > 0, n.partly_hard += zero > 0 && soft > 0, n.several_trees += roots > 1, n.loops += loop, n.three_links += three;
    n.block += block, n.joint_rows += !s.joints.empty(), n.to_ground += ground_alone;
  }
  const auto often = [](int count, const char* what) { EXPECT_GE(count, draws / 50) << what; };
  often(n.massless, "massless bodies");
  often(n.hard, "hard rows");
  often(n.partly_hard, "hard rows beside soft ones");
  often(n.free_base, "free bases");
  often(n.several_trees, "several trees");
  often(n.loops, "loops");
  often(n.three_links, "three bodies in a constraint");
  often(n.block, "blocks of damping");
  often(n.joint_rows, "rows on joints");
  often(n.fixed, "fixed joints");
  often(n.many_freedoms, "joints of several freedoms");
  often(n.armature, "armature");
  often(n.to_ground, "constraints to the ground");
}

/// The largest of the family's sizes.
Built largest(std::string_view name, std::uint64_t seed = 1) {
  const FamilyRow& row = find_family(name);
  return build(row.make(row.sizes.back(), seed));
}

std::pair<double, double> damping_range(const Damping<double>& d) {
  double low = HUGE_VAL, high = 0;
  for (const double x : d.diagonal) low = std::min(low, x), high = std::max(high, x);
  return {low, high};
}

TEST(Judges, FamiliesAreWhatTheirNamesSay) {
  for (const char* name : {"hard", "hard_redundant"}) EXPECT_EQ(damping_range(largest(name).damping), (std::pair{0.0, 0.0})) << name;
  const auto partly = damping_range(largest("partly_hard").damping);
  EXPECT_TRUE(partly.first == 0 && partly.second > 0);
  const auto mixed = damping_range(largest("mixed_damping").damping);
  EXPECT_GT(mixed.second / mixed.first, 1e15);
  EXPECT_FALSE(largest("block_damping").damping.blocks.empty());
  const auto trace = [](const Built& b) {
    double low = HUGE_VAL, high = 0;
    for (const auto& H : b.problem.H) low = std::min(low, H(5, 5)), high = std::max(high, H(5, 5));
    return std::pair{low, high};
  };
  const auto masses = trace(largest("mass_ratio"));
  EXPECT_GT(masses.second / masses.first, 1e6);
  EXPECT_EQ(trace(largest("massless")).first, 0);
  for (const char* name : {"redundant", "four_bar", "hard_redundant"}) {
    const Built b = largest(name);
    const auto J = reference::constraint_jacobian(b.problem);
    EXPECT_LT(Eigen::ColPivHouseholderQR<MatrixX<double>>(J).rank(), J.rows()) << name;
  }
  const Built friction = largest("joint_friction"), trees = largest("several_trees");
  EXPECT_EQ(friction.problem.structure->rows, friction.problem.structure->dofs());
  EXPECT_GT(std::count(trees.problem.structure->parent.begin(), trees.problem.structure->parent.end(), ground), 1);
  for (const char* name : {"star", "humanoid", "swimmer", "lattice", "contacts"}) EXPECT_EQ(largest(name).problem.structure->dofs(0), 6) << name;
  EXPECT_EQ(largest("no_rows").problem.structure->rows, 0);
}

/// What acts between two bodies of one tree sees no motion that both make.
TEST(Judges, ConstraintsSeeRelativeMotionAlone) {
  int seen = 0;
  for (const FamilyRow& row : families()) {
    if (row.name == "generic" || row.name == "random_tree") continue;
    const Spec spec = row.make(row.sizes.back(), 1);
    const Built b = build(spec);
    const Structure& s = *b.problem.structure;
    const auto root = [&](Index i) {
      while (s.parent[static_cast<std::size_t>(i)] != ground) i = s.parent[static_cast<std::size_t>(i)];
      return i;
    };
    for (std::size_t e = 0; e < spec.links.size(); ++e) {
      const auto& links = s.link_constraints[e].links;
      if (spec.links[e].kind == ConstraintKind::generic || links.size() != 2 || root(links[0].body) != root(links[1].body)) continue;
      ++seen;
      for (Index r = 0; r < s.link_constraints[e].rows; ++r) {
        const auto &k = b.problem.K[static_cast<std::size_t>(links[0].first + r)], &other = b.problem.K[static_cast<std::size_t>(links[1].first + r)];
        EXPECT_TRUE(k == -other) << row.name << ", constraint " << e << ", row " << r;
        EXPECT_GT(k.norm(), 0) << row.name;
      }
    }
  }
  EXPECT_GT(seen, 20);
}

}  // namespace
}  // namespace delassus::generators::judges_test

namespace delassus::laws::judges_test {
namespace {

Outcome outcome(double ratio, const char* skipped = nullptr) { return {"law", "operator", "case", skipped, {ratio, "bound", -1, {}}}; }

TEST(Judges, SummaryCountsWhatIsBroken) {
  Summary s;
  s.add(outcome(1));
  s.add(outcome(29.99));
  s.add(outcome(30));
  s.add(outcome(std::nan("")));
  s.add(outcome(HUGE_VAL));
  s.add(outcome(HUGE_VAL, "has no solve"));
  EXPECT_EQ(s.checked(), 5);
  EXPECT_EQ(s.failed(), 3);
  std::ostringstream out;
  s.print(out);
  EXPECT_NE(out.str().find("5 checked, 3 failed"), std::string::npos);
  std::size_t failed = 0;
  for (std::size_t at = 0; (at = out.str().find("FAILED", at)) != std::string::npos; ++at) ++failed;
  EXPECT_EQ(failed, 3u);
  Summary good;
  good.add(outcome(29.99));
  EXPECT_EQ(good.failed(), 0);
}

TEST(Judges, EveryLawIsAskedAndAnExceptionIsAFailure) {
  const Case c = make_case("chain", 2, 1);
  OperatorRow throws = find_operator("dense_cholesky");
  std::get<Maker<double>>(throws.makers) = []() -> std::unique_ptr<Operator<double>> { throw std::runtime_error("no"); };
  const std::vector<Outcome> all = check(throws, c);
  EXPECT_EQ(all.size(), laws().size());
  std::set<std::string_view> names;
  int failed = 0;
  for (const Outcome& o : all) {
    names.insert(o.law);
    failed += o.failed();
    EXPECT_FALSE(o.failed() && o.passed());
  }
  EXPECT_EQ(names.size(), laws().size());
  EXPECT_GT(failed, 20);
}

}  // namespace
}  // namespace delassus::laws::judges_test
