// Rank decisions on real loops: a four-bar along the axes and turned, an arm at and near its wrist singularity, Cassie undamped.
#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/delassus.h"
#include "algorithms/kit/test_scalars.h"
#include "generators/build.h"
#include "models/scene.h"
#include "property_tests/laws/verdict.h"
#include "reference/definition.h"

namespace delassus::hard_rows_test {
namespace {

struct Said {
  Report report;
  std::vector<Index> dependent;
  VectorX<double> f;
};

Said solved(const Problem<double>& p, const VectorX<double>& a) {
  const auto op = find_operator("kkt_elimination").make<double>();
  op->analyze(p.structure);
  Said said{op->update(p, Damping<double>::uniform(p.structure->rows, 0)), op->dependent_rows(), VectorX<double>::Zero(a.size())};
  Workspace<double> w(op->workspace());
  said.report = op->solve(a, said.f, w);
  return said;
}

Body massive(Index parent, double mass, const Vector3<double>& com) {
  Body b;
  b.name = "link";
  b.parent = parent;
  b.mass = mass;
  b.com = com;
  return b;
}

Constraint constraint(Constraint::Kind kind, const Frame& a, const Frame& b = {}) {
  Constraint c;
  c.name = "closure";
  c.kind = kind;
  c.a = a;
  c.b = b;
  return c;
}

Body link(Index parent, double mass, double length, double x) {
  Body b = massive(parent, mass, {length / 2, 0, 0});
  b.inertia.diagonal() << 1e-3 * mass, mass * length * length / 12, mass * length * length / 12;
  b.joint.axis = {0, -1, 0};
  b.joint.placement.translation = {x, 0, 0};
  return b;
}

/// Crank 0.3 m, coupler 0.8 m, rocker 0.6 m on a base of 1 m, in the plane y = 0, then turned; a hinge and the crank locked.
struct FourBar {
  Model model;
  VectorX<double> q{{1.0, -0.5652460210629805, 1.7591248752996058}};  // crank, coupler to crank, rocker

  explicit FourBar(const Matrix3<double>& turn) {
    for (const Body& b : {link(ground, 1.0, 0.3, 0), link(0, 1.3, 0.8, 0.3), link(ground, 0.7, 0.6, 1)}) model.add(b);
    for (const Index root : {0, 2}) {
      Pose<double>& at = model.bodies[static_cast<std::size_t>(root)].joint.placement;
      at = {turn, turn * at.translation + Vector3<double>(0.3, -0.2, 0.9)};
    }
    Matrix3<double> axes;  // z along the hinge
    axes << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    model.constraints.push_back(constraint(Constraint::Kind::hinge, {1, {axes, {0.8, 0, 0}}}, {2, {axes, {0.6, 0, 0}}}));
    model.constraints.push_back(constraint(Constraint::Kind::joint_lock, {0, {}}));
  }
};

/// Inertia of the crank with the others on it, from their velocities in the plane; and what a rounding of the angles moves it by.
std::pair<Quad, Quad> reduced_inertia() {
  const Quad l[3] = {0.3, 0.8, 0.6}, m[3] = {1.0, 1.3, 0.7}, t1(1.0), x = Quad(1) - l[0] * cos(t1), y = -(l[0] * sin(t1));
  // Circles about the crank's end B and the rocker's pivot D: C = B + a e + h n, e from B to D.
  const Quad d = sqrt(x * x + y * y), a = (d * d + l[1] * l[1] - l[2] * l[2]) / (d * Quad(2)), h = sqrt(l[1] * l[1] - a * a);
  const Quad c2 = (a * x - h * y) / d, s2 = (a * y + h * x) / d, c3 = c2 - x, s3 = s2 - y;  // l₂ (cos, sin), l₃ (cos, sin)
  // ω₁ = 1: velocity of C by the coupler = by the rocker
  const Quad bx = -(l[0] * sin(t1)), by = l[0] * cos(t1), det = s2 * c3 - c2 * s3;
  const Quad w2 = (bx * c3 + by * s3) / det, w3 = (bx * c2 + by * s2) / det;
  const auto rod = [](const Quad& mass, const Quad& length) { return mass * length * length / Quad(12); };
  const Quad vx = bx - w2 * s2 / Quad(2), vy = by + w2 * c2 / Quad(2);
  const Quad I = m[0] * l[0] * l[0] / Quad(3) + rod(m[1], l[1]) * w2 * w2 + m[1] * (vx * vx + vy * vy) + m[2] * l[2] * l[2] / Quad(3) * w3 * w3;
  return {I, I * l[1] * l[2] / abs(det)};
}

TEST(HardRows, FourBarAlongTheAxesAndTurned) {
  const auto [inertia, size] = reduced_inertia();
  EXPECT_NEAR(static_cast<double>(inertia), 0.1029286514950617, 1e-15);
  for (int k = 0; k < 200; ++k) {
    const Matrix3<double> turn = k == 0 ? Matrix3<double>::Identity().eval()
                                        : Eigen::AngleAxisd(0.37 * k, Vector3<double>(std::sin(1.0 * k), std::cos(2.3 * k), 0.4).normalized()).toRotationMatrix();
    const FourBar bar(turn);
    const Said said = solved(kinematics<double>(bar.model, bar.q), VectorX<double>{{0, 0, 0, 0, 0, 1}});
    ASSERT_TRUE(said.report.ok()) << k << name(said.report.status);
    EXPECT_EQ(said.dependent.size(), 3u) << k;
    EXPECT_LT(static_cast<double>(abs(Quad(said.f[5]) - inertia) / (Quad(unit_roundoff<double>) * size)), laws::pass_below) << k;
  }
}

/// Six revolute joints; the axes of the fourth and the sixth coincide at bend 0.
Model arm() {
  struct Link {
    Vector3<double> at, axis, com;
    double mass;
  };
  Model model;
  for (const Link& l : {Link{{0, 0, 0.4}, {0, 0, 1}, {0.02, 0, 0.1}, 4}, Link{{0.05, 0, 0.3}, {0, 1, 0}, {0, 0.01, 0.25}, 6},
                        Link{{0, 0, 0.5}, {0, 1, 0}, {0.1, 0, 0.03}, 3}, Link{{0.2, 0, 0}, {1, 0, 0}, {0.15, 0.01, 0}, 2},
                        Link{{0.3, 0, 0}, {0, 1, 0}, {0.02, 0, 0.01}, 1}, Link{{0.1, 0, 0}, {1, 0, 0}, {0.03, 0.01, 0.02}, 0.4}}) {
    Body b = massive(static_cast<Index>(model.bodies.size()) - 1, l.mass, l.com);
    b.inertia.diagonal() << 0.02 * l.mass, 0.024 * l.mass, 0.018 * l.mass;
    b.joint.axis = l.axis;
    b.joint.placement.translation = l.at;
    model.add(b);
  }
  model.constraints.push_back(constraint(Constraint::Kind::weld, {5, {Matrix3<double>::Identity(), {0.05, 0, 0}}}));
  return model;
}

TEST(HardRows, WristSingularity) {
  const VectorX<double> a{{0.3, -0.2, 0.5, 0.1, -0.7, 0.4}};
  for (const double bend : {0.0, 1e-12, 1e-10, 1e-7, 1e-4}) {
    const Problem<double> p = kinematics<double>(arm(), VectorX<double>{{0.3, 0.4, -0.5, 0.6, bend, -0.2}});
    const Said said = solved(p, a);
    if (bend == 0) {
      EXPECT_EQ(said.report.status, Status::inconsistent);
      EXPECT_EQ(said.dependent.size(), 1u);
      continue;
    }
    ASSERT_TRUE(said.report.ok()) << bend << name(said.report.status);
    EXPECT_TRUE(said.dependent.empty()) << bend;
    MatrixX<Rational> right(6, 1);
    for (Index r = 0; r < 6; ++r) right(r, 0) = Rational(a[r]);
    const MatrixX<Rational> exact = reference::dense_solve(reference::dense(p.cast<Rational>(), Damping<double>::uniform(6, 0).cast<Rational>()), right);
    double largest = 0, error = 0;
    for (Index r = 0; r < 6; ++r) {
      largest = std::max(largest, std::fabs(static_cast<double>(exact(r, 0))));
      error = std::max(error, std::fabs(static_cast<double>(Rational(said.f[r]) - exact(r, 0))));
    }
    EXPECT_LT(error / (unit_roundoff<double> * largest), laws::pass_below) << bend;
  }
}

TEST(HardRows, CassieTurned) {
  const Problem<double> p = problem_of(open_scene("cassie"));
  const auto op = find_operator("kkt_elimination").make<double>();
  op->analyze(p.structure);
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    ASSERT_TRUE(op->update(generators::turned(p, seed), Damping<double>::uniform(24, 0)).ok());
    EXPECT_EQ(op->dependent_rows().size(), 4u) << seed;
  }
}

TEST(HardRows, CassieUndamped) {
  const Problem<double> p = problem_of(open_scene("cassie"));
  const auto M = find_operator("aba_sweep").make<double>();
  M->analyze(p.structure);
  ASSERT_TRUE(M->update(p, Damping<double>::uniform(24, 0)).ok());
  Workspace<double> w(M->workspace());
  VectorX<double> x(24), a(24), again(24);
  for (Index r = 0; r < 24; ++r) x[r] = std::sin(1.7 * static_cast<double>(r));
  ASSERT_TRUE(M->apply(x, a, w).ok());  // an acceleration that forces can cause
  const Said said = solved(p, a);
  EXPECT_EQ(name(said.report.status), "ok");
  EXPECT_EQ(said.dependent.size(), 4u);
  a[said.dependent[0]] += 1e-6;
  EXPECT_EQ(solved(p, a).report.status, Status::inconsistent);
}

}  // namespace
}  // namespace delassus::hard_rows_test
