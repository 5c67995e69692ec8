// Structure, Problem and Damping: invariants, casts, and every refusal.
#include "algorithms/kit/test_scalars.h"
#include "algorithms/problem/problem.h"

#include <gtest/gtest.h>

#include <functional>

namespace delassus::problem_test {
namespace {

/// The message of the ModelError that `action` throws; empty when it throws none.
std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const ModelError& e) {
    return e.what();
  }
  return {};
}

void expect_refusal(const std::function<void()>& action, const std::string& part) {
  const std::string message = refusal(action);
  EXPECT_NE(message.find(part), std::string::npos) << "message: '" << message << "', expected: '" << part << "'";
  const std::size_t accepted = message.find("(accepted: ");
  ASSERT_NE(accepted, std::string::npos) << message;
  EXPECT_NE(message.find("; ", accepted), std::string::npos) << "does not say what to do: " << message;
}

/// Three bodies 0 ← 1, 0 ← 2 with 6, 1 and 2 degrees of freedom; one constraint of each sort.
Structure small() {
  Structure s;
  s.add_body(ground, 6);
  s.add_body(0, 1);
  s.add_body(0, 2);
  s.add_link_constraint(3, {1, 2});
  s.add_joint_constraint(2, 2);
  s.add_link_constraint(1, {0});
  return s;
}

TEST(structure, rows_and_blocks_follow_each_other) {
  const Structure s = small();
  EXPECT_NO_THROW(s.validate());
  EXPECT_EQ(s.bodies(), 3);
  EXPECT_EQ(s.dofs(), 9);
  EXPECT_EQ(s.dofs(2), 2);
  EXPECT_EQ(s.rows, 6);
  EXPECT_EQ(s.K_rows, 7);
  EXPECT_EQ(s.joint_K_size, 4);
  EXPECT_EQ(s.link_constraints[0].links[1].first, 3);
  EXPECT_EQ(s.link_constraints[1].row, 5);
  EXPECT_EQ(s.joint_constraints[0].row, 3);
}

TEST(structure, refuses_what_cannot_be) {
  Structure s = small();
  expect_refusal([&] { s.add_body(3, 1); }, "body 3: parent 3 is not an earlier body");
  expect_refusal([&] { s.add_body(-2, 1); }, "parent -2");
  expect_refusal([&] { s.add_body(0, 7); }, "joint with 7 degrees of freedom");
  expect_refusal([&] { s.add_link_constraint(0, {0}); }, "0 rows");
  expect_refusal([&] { s.add_link_constraint(1, {}); }, "acts on no body");
  expect_refusal([&] { s.add_link_constraint(1, {0, 3}); }, "body 3 does not exist");
  expect_refusal([&] { s.add_link_constraint(1, {ground, 0}); }, "body -1 does not exist");
  expect_refusal([&] { s.add_link_constraint(1, {1, 0, 1}); }, "body 1 appears twice");
  expect_refusal([&] { s.add_joint_constraint(0, 1); }, "0 rows");
  expect_refusal([&] { s.add_joint_constraint(1, 5); }, "body 5 does not exist");
  EXPECT_NO_THROW(s.validate()) << "a refused call leaves the structure as it was";
}

TEST(structure, validate_finds_broken_invariants) {
  const auto broken = [](const std::function<void(Structure&)>& edit) {
    return [edit] {
      Structure s = small();
      edit(s);
      s.validate();
    };
  };
  expect_refusal(broken([](Structure& s) { s.parent[1] = 1; }), "body 1: parent 1");
  expect_refusal(broken([](Structure& s) { s.first_dof.pop_back(); }), "first_dof");
  expect_refusal(broken([](Structure& s) { s.first_dof[0] = 1; }), "first_dof");
  expect_refusal(broken([](Structure& s) { s.link_constraints[1].row = 6; }), "rows of J: gap or overlap");
  expect_refusal(broken([](Structure& s) { s.joint_constraints[0].row = 2; }), "rows of J: gap or overlap");
  expect_refusal(broken([](Structure& s) { s.rows = 7; }), "rows of J: 6 entries used of 7");
  expect_refusal(broken([](Structure& s) { s.link_constraints[0].links[1].first = 0; }), "rows of K: gap or overlap");
  expect_refusal(broken([](Structure& s) { s.link_constraints[0].links[1].body = 1; }), "body 1 appears twice");
  expect_refusal(broken([](Structure& s) { s.joint_K_size = 5; }), "entries of joint_K");
}

TEST(problem, has_the_sizes_of_its_structure) {
  const auto s = std::make_shared<const Structure>(small());
  Problem<double> p(s);
  EXPECT_NO_THROW(p.check_sizes());
  EXPECT_EQ(p.S.size(), 9u);
  EXPECT_EQ(p.H.size(), 3u);
  EXPECT_EQ(p.K.size(), 7u);
  EXPECT_EQ(p.joint_K.size(), 4u);
  p.K.pop_back();
  EXPECT_THROW(p.check_sizes(), std::logic_error);
  EXPECT_THROW(Problem<double>().check_sizes(), std::logic_error);
  EXPECT_THROW(Problem<double>(nullptr), std::logic_error);
}

TEST(problem, casts_are_exact_where_the_target_holds_the_source) {
  Problem<double> p(std::make_shared<const Structure>(small()));
  double x = 0.1;
  const auto next = [&x] { return x = x * 1.7 - 0.3 * x * x; };
  for (auto& v : p.S) v = Vector6<double>::NullaryExpr([&](Index) { return next(); });
  for (auto& v : p.H) v = Matrix6<double>::NullaryExpr([&](Index, Index) { return next(); });
  for (auto& v : p.K) v = Vector6<double>::NullaryExpr([&](Index) { return next(); });
  for (auto& v : p.joint_K) v = next();
  for (auto& v : p.armature) v = next();
  const auto same = [&p](const Problem<double>& o) {
    return o.structure == p.structure && o.S == p.S && o.H == p.H && o.K == p.K && o.joint_K == p.joint_K &&
           o.armature == p.armature;
  };
  EXPECT_TRUE(same(p.cast<Rational>().cast<double>()));
  EXPECT_TRUE(same(p.cast<Quad>().cast<double>()));
  EXPECT_TRUE(same(p.cast<Quad>().cast<Rational>().cast<Quad>().cast<double>()));
  EXPECT_EQ(p.cast<Counted>().K[6][5].v, p.K[6][5]);
  EXPECT_EQ(p.cast<float>().S[0][0], static_cast<float>(p.S[0][0]));

  Problem<Quad> q = p.cast<Quad>();
  q.S[0][0] = Quad(1) / Quad(3);
  EXPECT_TRUE(q.cast<Rational>().cast<Quad>().S[0][0] == q.S[0][0]) << "113 bits survive";

  p.S[0][0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)p.cast<Rational>(), std::logic_error);
  EXPECT_TRUE(std::isnan(static_cast<double>(p.cast<Quad>().S[0][0])));
}

Damping<double> with_block(const MatrixX<double>& B, Index row = 0) {
  Damping<double> d = Damping<double>::uniform(6, 0.0);
  d.blocks.push_back({row, B});
  return d;
}

TEST(damping, multiplies_diagonal_and_blocks) {
  MatrixX<double> B(2, 2);
  B << 2, 1, 1, 3;
  Damping<double> d = with_block(B, 1);
  d.diagonal = {5, 0, 0, 7, 0, 9};
  VectorX<double> x(6), y;
  x << 1, 2, 3, 4, 5, 6;
  d.multiply(x, y);
  EXPECT_EQ(y, (VectorX<double>(6) << 5, 7, 11, 28, 0, 54).finished());
  VectorX<Rational> ry;
  d.cast<Rational>().multiply(x.cast<Rational>(), ry);
  for (Index i = 0; i < 6; ++i) EXPECT_TRUE(ry[i] == Rational(y[i]));
  EXPECT_THROW(d.multiply(VectorX<double>::Zero(5), y), std::logic_error);
  EXPECT_THROW(d.multiply(x, x), std::logic_error);
}

TEST(damping, refuses_what_is_not_positive_semidefinite) {
  const Structure s = small();
  MatrixX<double> B(2, 2);
  B << 1, 1, 1, 1;
  EXPECT_NO_THROW(with_block(B).validate(s));
  EXPECT_NO_THROW(with_block(B).cast<Rational>().validate(s));
  EXPECT_NO_THROW(Damping<double>::uniform(6, 0.0).validate(s));

  expect_refusal([&] { Damping<double>::uniform(5, 0.0).validate(s); }, "damping: 5 entries");
  expect_refusal([&] { Damping<double>::uniform(6, -1.0).validate(s); }, "damping of row 0: -1 1/kg");
  const double inf = std::numeric_limits<double>::infinity();
  expect_refusal([&] { Damping<double>::uniform(6, -inf).validate(s); }, "row 0");
  EXPECT_NO_THROW(Damping<double>::uniform(6, inf).validate(s));  // rows that are off
  expect_refusal([&] { Damping<double>::uniform(6, std::nan("")).validate(s); }, "row 0");
  expect_refusal([&] { with_block(MatrixX<double>::Identity(2, 3)).validate(s); }, "2 x 3");
  expect_refusal([&] { with_block(MatrixX<double>::Constant(1, 1, inf)).validate(s); }, "entry is not finite");
  MatrixX<double> C = B;
  C(0, 1) = 2;
  expect_refusal([&] { with_block(C).validate(s); }, "transpose differ");
  C(1, 0) = 2;
  expect_refusal([&] { with_block(C).validate(s); }, "negative eigenvalue");
  expect_refusal([&] { with_block(C).cast<Rational>().validate(s); }, "negative eigenvalue");
  C << 0, 1, 1, 0;
  expect_refusal([&] { with_block(C).validate(s); }, "negative eigenvalue");
  expect_refusal([&] { with_block(B, 2).validate(s); }, "reach beyond one constraint");
  expect_refusal([&] { with_block(B, 5).validate(s); }, "reach beyond one constraint");
  expect_refusal([&] { with_block(B, -1).validate(s); }, "disjoint blocks");
  Damping<double> d = with_block(B);
  d.blocks.push_back({1, B});
  expect_refusal([&] { d.validate(s); }, "overlaps the block before it");
  d = with_block(B);
  d.diagonal[1] = 1;
  expect_refusal([&] { d.validate(s); }, "row 1 also has a diagonal entry");
}

}  // namespace
}  // namespace delassus::problem_test
