// M, J and J M⁻¹ Jᵀ of kinematics, definition and every operator that applies against MuJoCo (reference/mujoco_witness.h), on the robots'
// scenes and on random trees; and the same comparison failing as soon as the two mechanisms differ.
#include "algorithms/kit/test_scalars.h"
#include "reference/mujoco_witness.h"
#include "reference/sensitivity.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <functional>

#include "algorithms/delassus.h"
#include "models/scene.h"
#include "property_tests/unit/operators/path_sums.h"
#include "reference/definition.h"

namespace delassus::mujoco_test {
namespace {

using reference::MujocoWitness;
using reference::WitnessBounds;
using unit::Random;
using Kind = Constraint::Kind;
using Matrix = MatrixX<double>;

/// Largest |x − y| / (eps · bound), entry by entry; a zero bound demands equality.
double worst(const MatrixX<Quad>& x, const Matrix& y, const Matrix& bound) {
  if (x.rows() != y.rows() || x.cols() != y.cols()) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (Index j = 0; j < y.cols(); ++j)
    for (Index i = 0; i < y.rows(); ++i)
      largest = std::max(largest, unit::ratio(static_cast<double>(Quad(x(i, j) - Quad(y(i, j)))), bound(i, j)));
  return largest;
}

/// Ratios of MuJoCo against M, J, A0 of the definition, and against A0 column by column from the operators that apply:
/// the best and the worst of them.
struct Ratios {
  double M, J, A, best = std::numeric_limits<double>::infinity(), worst = 0;
  std::string_view worst_op = {};

  void add(const OperatorRow& op, double ratio) {
    best = std::min(best, ratio);
    if (ratio >= worst) worst = ratio, worst_op = op.name;
  }
  void print(const std::string& what) const {
    std::printf("  %-32s M %.2g  J %.2g  A %.2g  operators %.2g to %.2g (%s)\n", what.c_str(), M, J, A, best, worst,
                std::string(worst_op).c_str());
  }
};

/// Without damping A may be singular, and an update say so: an operator applies all the same.
Matrix columns(const OperatorRow& row, const Problem<double>& problem) {
  const Index rows = problem.structure->rows;
  const auto op = row.make<double>();
  op->analyze(problem.structure);
  static_cast<void>(op->update(problem, Damping<double>::uniform(rows, 0)));
  Workspace<double> workspace(op->workspace(rows));
  Matrix A(rows, rows);
  EXPECT_TRUE(op->apply(Matrix::Identity(rows, rows), A, workspace).ok()) << row.name;
  return A;
}

/// `theirs` is what MuJoCo is told, `ours` what this library computes.
Ratios compare(const Model& theirs, const Model& ours, const VectorX<double>& q) {
  MujocoWitness witness(theirs);
  witness.set(q);
  const Problem<double> problem = kinematics<double>(ours, q);
  const WitnessBounds bounds = reference::witness_bounds(ours, q, problem);
  const Damping<double> none = Damping<double>::uniform(problem.structure->rows, 0);
  const reference::Dense<Quad> d = reference::dense(problem.cast<Quad>(), none.cast<Quad>());
  const Matrix A = witness.A0();
  Ratios r{worst(d.M, witness.M(), bounds.M), worst(d.J, witness.J(), bounds.J), worst(d.A0, A, bounds.A)};
  const reference::Sensitivity sensitivity(problem, none);
  Matrix mobile(A.rows(), A.cols());
  for (Index k = 0; k < A.cols(); ++k) mobile.col(k) = sensitivity.apply_mobile(VectorX<double>::Unit(A.cols(), k));
  for (const OperatorRow& row : operators())
    if (row.applies)
      r.add(row, worst(columns(row, problem).cast<Quad>(), A, row.apply_error == ErrorClass::amplified ? Matrix(bounds.A + mobile) : bounds.A));
  return r;
}

Ratios compare(const Model& model, const VectorX<double>& q) { return compare(model, model, q); }

void expect_agreement(const std::string& what, const Ratios& r) {
  r.print(what);
  EXPECT_LT(r.M, 30) << what;
  EXPECT_LT(r.J, 30) << what;
  EXPECT_LT(r.A, 30) << what;
  EXPECT_LT(r.worst, 30) << what << ": " << r.worst_op;
}

// ---- the scenes ------------------------------------------------------------------------------------------------

TEST(Mujoco, agrees_on_the_scenes_of_the_robots) {
  for (const char* name : {"go2_standing", "go2_standing_friction", "go2_fallen", "go2_fallen_friction", "cassie",
                           "cassie_friction", "g1_standing", "g1_standing_friction", "g1_fallen", "g1_fallen_friction"}) {
    const Scene scene = open_scene(name);
    expect_agreement(name, compare(scene.model, scene.q));
  }
}

TEST(Mujoco, agrees_on_the_robots_in_random_poses) {
  for (const char* name : {"go2_fallen", "cassie", "g1_standing"}) {
    const Scene scene = open_scene(name);
    for (unsigned seed = 0; seed < 3; ++seed) {
      Random random(seed);
      const VectorX<double> q = unit::random_configuration(scene.model, random);
      expect_agreement(std::string(name) + " seed " + std::to_string(seed), compare(scene.model, q));
    }
  }
}

TEST(Mujoco, agrees_on_boxes) {
  const Scene scene = open_scene("boxes_tower");
  expect_agreement("boxes_tower", compare(scene.model, scene.q));
}

// ---- random mechanisms -----------------------------------------------------------------------------------------

std::vector<double> armature(Random& random, JointType type) {
  std::vector<double> a(static_cast<std::size_t>(dof_count(type)));
  for (double& x : a) x = random.number(0, 1);
  if (type == JointType::floating) a[4] = a[5] = a[3];
  return a;
}

/// A tree of revolute, prismatic, spherical and floating joints, some with armature; point closures and contacts.
Model random_tree(unsigned seed, Index bodies) {
  constexpr JointType types[] = {JointType::revolute, JointType::prismatic, JointType::spherical, JointType::floating};
  Random random(seed);
  const auto integer = [&](Index low, Index high) {
    return low + static_cast<Index>(random.number(0, 1) * static_cast<double>(high - low + 1)) % (high - low + 1);
  };
  Model m;
  for (Index i = 0; i < bodies; ++i) {
    const Index parent = i == 0 ? ground : integer(std::max<Index>(ground, i - 4), i - 1);
    Body b = unit::random_body(random, std::to_string(i), parent, types[integer(0, 3)]);
    if (integer(0, 1) == 1) b.joint.armature = armature(random, b.joint.type);
    m.add(b);
  }
  for (const Kind kind : {Kind::point, Kind::contact, Kind::point}) {
    Constraint c;
    c.kind = kind;
    c.a = {integer(0, bodies - 1), random.pose()};
    c.b = {c.a.body == 0 ? ground : integer(ground, c.a.body - 1), random.pose()};
    m.constraints.push_back(c);
    std::swap(c.a, c.b);
    m.constraints.push_back(c);
  }
  return m;
}

TEST(Mujoco, agrees_on_random_trees) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Model m = random_tree(seed, 2 + static_cast<Index>(seed) % 10);
    Random random(seed + 1000);
    VectorX<double> q = unit::random_configuration(m, random);
    expect_agreement("tree " + std::to_string(seed), compare(m, q));
  }
}

/// The root body's centre of mass, about which kinematics computes, is 5 km from a tree whose weight is elsewhere: a light
/// link has moments of 0.1 kg m², found as differences of 2e7. MuJoCo computes about the tree's centre, and keeps the digits.
TEST(Mujoco, agrees_where_only_the_root_body_is_far_away) {
  Random random(1);
  Model m;
  for (const auto& [parent, type, mass] : {std::tuple{ground, JointType::floating, 2.0}, {Index(0), JointType::revolute, 0.5}, {Index(1), JointType::prismatic, 0.25}, {Index(0), JointType::revolute, 1440.0}}) {
    Body b = unit::random_body(random, std::to_string(m.bodies.size()), parent, type);
    b.inertia *= mass / b.mass;
    b.mass = mass;
    if (parent == ground) b.com = {0, 5000, 0.1}, b.joint.placement.translation.setZero();
    m.add(b);
  }
  Constraint c;
  c.kind = Kind::point;
  c.a = {2, random.pose()}, c.b = {3, random.pose()};
  m.constraints.push_back(c);
  const VectorX<double> q = unit::random_configuration(m, random);
  expect_agreement("a root body far away", compare(m, q));
  MujocoWitness witness(m);
  witness.set(q);
  const Matrix theirs = witness.M();
  const double exact = static_cast<double>(reference::mass_matrix(kinematics<Quad>(m, q.cast<Quad>()))(6, 6));
  EXPECT_LT(std::fabs(theirs(6, 6) - exact), 1e-12 * exact) << "MuJoCo's own digits are not what the bound is for";
}

void add_every_kind(Model& m, Random& random) {
  for (const Kind kind : {Kind::point, Kind::weld, Kind::hinge, Kind::universal, Kind::cylindrical, Kind::prismatic,
                          Kind::planar, Kind::distance, Kind::contact}) {
    Constraint c;
    c.kind = kind;
    c.length = 1;
    for (const Index other : {Index(7), Index(12), ground}) {
      c.a = {3, random.pose()};
      c.b = {other, random.pose()};
      m.constraints.push_back(c);
    }
    std::swap(c.a, c.b);
    m.constraints.push_back(c);
  }
  Constraint c;
  c.kind = Kind::coupling;
  c.terms = {{4, 1, 2.0, {}}, {5, 0, -3.0, {}}, {0, 4, 1.5, {}}};
  m.constraints.push_back(c);
  c.terms.clear();
  c.kind = Kind::general;
  for (const Index body : {2, 9, 2, -1})
    c.terms.push_back({body, 0, 1, Matrix::NullaryExpr(2, 6, [&](Index, Index) { return random.number(); })});
  m.constraints.push_back(c);
  c = {};
  c.kind = Kind::joint_lock;
  for (const Index body : {0, 4, 14}) {
    c.a.body = body;
    m.constraints.push_back(c);
  }
  c.kind = Kind::joint_limit;
  for (const int side : {1, -1})
    for (const Index body : {0, 4, 14}) {
      c.a.body = body;
      c.side = side;
      c.dof = dof_count(m.bodies[body].joint.type) - 1;
      m.constraints.push_back(c);
    }
}

TEST(Mujoco, agrees_on_every_joint_type_and_every_kind_of_constraint) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    Model m = unit::two_robots(seed);
    Random random(seed + 100);
    add_every_kind(m, random);
    expect_agreement("every kind " + std::to_string(seed), compare(m, unit::random_configuration(m, random)));
  }
}

// ---- seeded differences ----------------------------------------------------------------------------------------

Frame& on_body(Constraint& c) { return c.a.body == ground ? c.b : c.a; }

struct Difference {
  const char* name;
  std::function<void(Model&, Body&)> seed;
};

/// A body on a revolute joint, or the first constraint, is changed in what MuJoCo is told.
const std::vector<Difference> differences{
    {"armature dropped", [](Model&, Body& b) { b.joint.armature.clear(); }},
    {"armature 1e-9 larger", [](Model&, Body& b) { b.joint.armature[0] *= 1 + 1e-9; }},
    {"axis turned round", [](Model&, Body& b) { b.joint.axis *= -1; }},
    {"product of inertia negated",
     [](Model&, Body& b) { b.inertia(0, 1) *= -1, b.inertia(1, 0) *= -1; }},
    {"mass 1e-9 larger", [](Model&, Body& b) { b.mass *= 1 + 1e-9; }},
    {"centre of mass moved 1 nm", [](Model&, Body& b) { b.com[0] += 1e-9; }},
    {"joint moved 1 nm", [](Model&, Body& b) { b.joint.placement.translation[1] += 1e-9; }},
    {"first point moved 1 nm", [](Model& m, Body&) { on_body(m.constraints[0]).placement.translation[2] += 1e-9; }},
    {"first frame turned upside down",
     [](Model& m, Body&) { m.constraints[0].a.placement.rotation *= Vector3<double>(1, -1, -1).asDiagonal(); }}};

void expect_seen(const Scene& scene, const std::string& changed) {
  Model ours = scene.model;
  Body& body = ours.bodies[ours.find(changed)];
  body.joint.armature = {0.01};
  body.inertia(0, 1) = body.inertia(1, 0) = 0.1 * body.inertia.diagonal().minCoeff();
  expect_agreement(scene.name + " prepared", compare(ours, scene.q));
  for (const Difference& difference : differences) {
    Model theirs = ours;
    difference.seed(theirs, theirs.bodies[ours.find(changed)]);
    const Ratios r = compare(theirs, ours, scene.q);
    r.print(difference.name);
    EXPECT_GE(r.A, 30) << scene.name << ": " << difference.name;
    EXPECT_GE(r.best, 30) << scene.name << ": " << difference.name << ", by every operator";
  }
}

TEST(Mujoco, sees_every_seeded_difference) {
  expect_seen(open_scene("go2_standing"), "go2/FL_thigh");
  expect_seen(open_scene("cassie"), "cassie/left-tarsus");
}

TEST(Mujoco, refuses_what_it_cannot_represent) {
  Random random(1);
  Model massless;
  massless.add(unit::random_body(random, "b", ground, JointType::revolute));
  massless.bodies[0].mass = 0;
  massless.bodies[0].inertia.setZero();
  EXPECT_THROW(MujocoWitness{massless}, ModelError);
  Model turning;
  turning.add(unit::random_body(random, "b", ground, JointType::floating));
  turning.bodies[0].joint.armature = {1, 2, 3, 1, 1, 2};
  EXPECT_THROW(MujocoWitness{turning}, ModelError);
  turning.bodies[0].joint.armature = {1, 2, 3, 1, 1, 1};
  MujocoWitness witness(turning);
  EXPECT_THROW(witness.set(VectorX<double>::Zero(6)), std::logic_error);
}

}  // namespace
}  // namespace delassus::mujoco_test
