// The generators: what they build is what they promise, and the hard classes of problems do occur.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <set>

#include "algorithms/kit/test_scalars.h"
#include "generators/build.h"
#include "generators/draft.h"
#include "generators/families.h"
#include "reference/definition.h"

namespace delassus::generators::generators_test {
namespace {

std::vector<Spec> gate_specs() {
  std::vector<Spec> all;
  for (const FamilyRow& row : families())
    for (const Index n : row.sizes)
      for (std::uint64_t seed = 1; seed <= 2; ++seed) all.push_back(row.make(n, seed));
  return all;
}

std::string label(const Spec& s) { return s.family + " with " + std::to_string(s.bodies.size()) + " bodies"; }

/// Bits of the significand in use.
int bits(double x) {
  if (x == 0) return 0;
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  int n = 0;
  for (; m != 0; ++n) m = std::fabs(m) * 2 - (std::fabs(m) * 2 >= 1 ? 1 : 0);
  return n;
}

TEST(Generators, JsonRoundTripIsIdentical) {
  for (const Spec& spec : gate_specs()) {
    const std::string text = to_json(spec);
    EXPECT_EQ(to_json(from_json(text, "test")), text) << label(spec);
  }
  const Spec spec = random_spec(8, 5);
  EXPECT_EQ(to_json(from_json(to_json(spec), "test")), to_json(spec));
}

TEST(Generators, BadJsonIsRejectedByElement) {
  const auto message = [](const std::string& text) {
    try {
      static_cast<void>(from_json(text, "case.json"));
    } catch (const ModelError& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  EXPECT_NE(message("{").find("case.json"), std::string::npos);
  EXPECT_NE(message("[]").find("not an object"), std::string::npos);
  EXPECT_NE(message(R"({"family": "x"})").find("seed"), std::string::npos);
  std::string text = to_json(families()[0].make(2, 1));
  text.replace(text.find("revolute"), 8, "rotating");
  const std::string error = message(text);
  EXPECT_NE(error.find("bodies[0]"), std::string::npos) << error;
  EXPECT_NE(error.find("rotating"), std::string::npos) << error;
  EXPECT_NE(error.find("prismatic"), std::string::npos) << error;
  // numbers that C++ would wrap round, cut, or convert to anything
  const std::string sound = to_json(families()[0].make(2, 1));
  const auto with = [&](const std::string& key, const std::string& value) {
    const std::size_t at = sound.find("\"" + key + "\":"), begin = sound.find_first_not_of(" \n", at + key.size() + 3);
    const std::size_t end = sound[begin] == '[' ? sound.find(']', begin) + 1 : sound.find_first_of(",\n}", begin);
    return std::string(sound).replace(begin, end - begin, value);
  };
  ASSERT_EQ(message(with("length_decade", "1")), "accepted");
  for (const auto& [key, value] : {std::pair<std::string, std::string>{"seed", "-1"}, {"seed", "18446744073709551616"}, {"length_decade", "1e308"}, {"length_decade", "0.5"},
                                   {"length_decade", "4294967296"}, {"dof", "1e19"}, {"axis", "[1e308, 0, 1]"}, {"axis", "[0, 0, 4294967297]"}, {"axis", "[0, 0, 1, 1]"}, {"axis", "1"}}) {
    const std::string said = message(with(key, value));
    EXPECT_NE(said.find(key + " is "), std::string::npos) << key << " " << value << ": " << said;
    EXPECT_NE(said.find(key == "dof" ? "0 to 6" : "integer"), std::string::npos) << said;
  }
}

TEST(Generators, BadSpecsAreRejected) {
  Spec spec = families()[0].make(3, 1);
  spec.bodies[1].parent = 2;
  EXPECT_THROW(static_cast<void>(build(spec)), ModelError);
  spec = families()[0].make(3, 1);
  spec.bodies[1].axis = {0, 0, 0};
  EXPECT_THROW(static_cast<void>(build(spec)), ModelError);
  spec = families()[0].make(3, 1);
  spec.links[0].bodies = {7};
  EXPECT_THROW(static_cast<void>(build(spec)), ModelError);
}

TEST(Generators, NumbersAreShortDyadicsAndValid) {
  for (const Spec& spec : gate_specs()) {
    const Built b = build(spec);
    b.problem.structure->validate();
    b.damping.validate(*b.problem.structure);
    int most = 0;
    for (const auto& H : b.problem.H)
      for (const double x : H.reshaped()) most = std::max(most, bits(x));
    for (const auto& s : b.problem.S)
      for (const double x : s.reshaped()) most = std::max(most, bits(x));
    for (const auto& k : b.problem.K)
      for (const double x : k.reshaped()) most = std::max(most, bits(x));
    if (spec.turn) continue;
    EXPECT_LE(most, 48) << label(spec);  // fewer than the 53 of a double: nothing was rounded
  }
}

TEST(Generators, InertiasArePositiveDefiniteExactly) {
  for (const Spec& spec : gate_specs()) {
    const Built b = build(spec);
    for (std::size_t i = 0; i < spec.bodies.size(); ++i) {
      if (!spec.bodies[i].mass_decade) continue;
      const MatrixX<double> H = b.problem.H[i];
      EXPECT_TRUE(H == H.transpose());
      MatrixX<Rational> exact(6, 6);
      for (Index r = 0; r < 6; ++r)
        for (Index c = 0; c < 6; ++c) exact(r, c) = Rational(H(r, c));
      EXPECT_TRUE(reference::PivotedLdlt<Rational>(exact).regular()) << label(spec) << " body " << i;
    }
  }
}

TEST(Generators, MassMatrixIsRegularExactly) {
  for (const FamilyRow& row : families()) {
    if (row.exact_size < 0) continue;
    const Built b = build(row.make(row.exact_size, 1));
    EXPECT_TRUE(reference::PivotedLdlt<Rational>(reference::mass_matrix(b.problem.cast<Rational>())).regular()) << row.name;
  }
}

TEST(Generators, RegularFamiliesHaveRegularA) {
  for (const FamilyRow& row : families()) {
    if (row.exact_size < 0) continue;
    const Built b = build(row.make(row.exact_size, 1));
    const auto d = reference::dense(b.problem.cast<Rational>(), b.damping.cast<Rational>());
    EXPECT_EQ(reference::factorise(d).regular(), row.regular) << row.name;
  }
}

TEST(Generators, SameSpecSameBits) {
  for (const FamilyRow& row : families()) {
    const Built a = build(row.make(row.sizes.back(), 7)), b = build(row.make(row.sizes.back(), 7));
    EXPECT_TRUE(a.problem.joint_K == b.problem.joint_K && a.problem.armature == b.problem.armature) << row.name;
    for (std::size_t i = 0; i < a.problem.H.size(); ++i) EXPECT_TRUE(a.problem.H[i] == b.problem.H[i]);
  }
}

TEST(Generators, SeedsDiffer) {
  for (const FamilyRow& row : families()) {
    if (row.sizes.back() < 2) continue;
    EXPECT_NE(to_json(row.make(row.sizes.back(), 1)), to_json(row.make(row.sizes.back(), 2))) << row.name;
  }
}

TEST(Generators, NamesAreUniqueAndFound) {
  std::set<std::string_view> names;
  for (const FamilyRow& row : families()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_EQ(&find_family(row.name), &row);
  }
  EXPECT_THROW(static_cast<void>(find_family("no such family")), ModelError);
}

/// Classes of problems that hide errors when they are missing.
struct Classes {
  bool loop = false, redundant = false, mass_ratio = false, three_links = false, parent_child = false,
       unequal_joints = false, armature_and_rows = false, block = false, hard = false, several_trees = false,
       wide_damping = false;
};

Classes classify(const Spec& spec) {
  Classes c;
  int roots = 0, lightest = 99, heaviest = -99;
  for (const BodySpec& b : spec.bodies) {
    roots += b.parent < 0 ? 1 : 0;
    if (!b.mass_decade) continue;
    lightest = std::min(lightest, *b.mass_decade);
    heaviest = std::max(heaviest, *b.mass_decade);
  }
  c.several_trees = roots > 1;
  c.mass_ratio = heaviest - lightest > 6;
  for (const LinkConstraintSpec& e : spec.links) {
    c.loop |= e.bodies.size() > 1;
    c.three_links |= e.bodies.size() > 2;
    c.block |= e.damping.kind == DampingKind::block;
    c.hard |= e.damping.kind == DampingKind::zero;
    c.wide_damping |= e.damping.kind == DampingKind::rows && e.damping.high - e.damping.low >= 20;
    for (const Index i : e.bodies)
      for (const Index j : e.bodies) {
        const BodySpec &x = spec.bodies[static_cast<std::size_t>(i)], &y = spec.bodies[static_cast<std::size_t>(j)];
        c.parent_child |= x.parent == j;
        c.unequal_joints |= dof_count(x) != dof_count(y);
      }
  }
  for (const JointConstraintSpec& e : spec.joints)
    c.armature_and_rows |= spec.bodies[static_cast<std::size_t>(e.body)].armature_decade.has_value();
  const Built b = build(spec);
  if (b.problem.structure->dofs() <= 40 && b.problem.structure->rows > 0 && b.problem.structure->dofs() > 0)
    c.redundant = Eigen::FullPivLU<MatrixX<double>>(reference::constraint_jacobian(b.problem)).rank() < b.problem.structure->rows;
  return c;
}

TEST(Generators, EveryClassOfProblemsOccurs) {
  std::vector<Classes> all;
  for (const Spec& spec : gate_specs()) all.push_back(classify(spec));
  const auto share = [&](bool Classes::*what) {
    int n = 0;
    for (const Classes& c : all) n += c.*what ? 1 : 0;
    return static_cast<double>(n) / static_cast<double>(all.size());
  };
  EXPECT_GE(share(&Classes::loop), 0.4);
  EXPECT_GE(share(&Classes::redundant), 0.2);
  EXPECT_GE(share(&Classes::mass_ratio), 0.02);
  EXPECT_GE(share(&Classes::three_links), 0.04);
  EXPECT_GE(share(&Classes::parent_child), 0.1);
  EXPECT_GE(share(&Classes::unequal_joints), 0.1);
  EXPECT_GE(share(&Classes::armature_and_rows), 0.1);
  EXPECT_GE(share(&Classes::block), 0.02);
  EXPECT_GE(share(&Classes::hard), 0.05);
  EXPECT_GE(share(&Classes::several_trees), 0.1);
  EXPECT_GE(share(&Classes::wide_damping), 0.02);
}

}  // namespace
}  // namespace delassus::generators::generators_test
