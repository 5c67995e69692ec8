// Model validation (every refusal), regularity of massless bodies, and the assembly of loops.
#include "algorithms/mechanism/loop_closing.h"
#include "algorithms/mechanism/model.h"

#include <gtest/gtest.h>

#include <functional>

#include "property_tests/unit/operators/path_sums.h"

namespace delassus::model_test {
namespace {

using namespace unit;
using Kind = Constraint::Kind;

void expect_refusal(const std::function<void()>& action, const std::string& part) {
  std::string message = "nothing was thrown";
  try {
    action();
  } catch (const ModelError& e) {
    message = e.what();
  }
  EXPECT_NE(message.find(part), std::string::npos) << "message: '" << message << "', expected: '" << part << "'";
  EXPECT_NE(message.find("(accepted: "), std::string::npos) << message;
}

Body good_body(const std::string& name = "r/link") {
  Body b;
  b.name = name;
  b.mass = 1;
  b.inertia = Matrix3<double>::Identity();
  return b;
}

TEST(model, refuses_bodies_that_cannot_be) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const auto edited = [](const std::function<void(Body&)>& edit) {
    return [edit] {
      Body b = good_body();
      b.joint.name = "hip";
      edit(b);
      validate_body(b, "robot.urdf");
    };
  };
  EXPECT_NO_THROW(edited([](Body&) {})());
  expect_refusal(edited([](Body& b) { b.mass = -1; }), "robot.urdf: r/link mass: -1 kg");
  EXPECT_NO_THROW(edited([](Body& b) { b.mass = 0; })());
  expect_refusal(edited([&](Body& b) { b.mass = nan; }), "not finite");
  expect_refusal(edited([&](Body& b) { b.com[1] = inf; }), "not finite");
  expect_refusal(edited([&](Body& b) { b.inertia(0, 0) = nan; }), "not finite");
  expect_refusal(edited([](Body& b) { b.inertia(0, 1) = 0.5; }), "r/link inertia: is not symmetric");
  for (const double moment : {0.0, -1.0, 2.001})  // what M makes of it is for validate to say
    EXPECT_NO_THROW(edited([&](Body& b) { b.inertia(0, 0) = moment; })());
  EXPECT_NO_THROW(edited([](Body& b) { b.inertia(2, 2) = 2; })()) << "a flat plate";
  expect_refusal(edited([](Body& b) { b.joint.axis = {0, 0, 2}; }), "joint hip axis: (0 0 2) is not a unit vector");
  expect_refusal(edited([&](Body& b) { b.joint.axis[0] = nan; }), "is not a unit vector");
  expect_refusal(edited([](Body& b) {
                   b.joint.type = JointType::universal;
                   b.joint.axis2 = -b.joint.axis;
                 }),
                 "is parallel to the first axis");
  expect_refusal(edited([](Body& b) { b.joint.placement.rotation *= 2; }), "not a proper orthogonal matrix");
  expect_refusal(edited([](Body& b) { b.joint.placement.rotation *= -1; }), "not a proper orthogonal matrix");
  expect_refusal(edited([&](Body& b) { b.joint.placement.translation[0] = inf; }), "placement: is not finite");
  expect_refusal(edited([](Body& b) { b.joint.armature = {1, 2}; }), "joint hip armature: 2 values");
  expect_refusal(edited([](Body& b) { b.joint.armature = {-1}; }), "armature: -1 kg m^2");
  expect_refusal(edited([](Body& b) { b.joint.damping = {-1}; }), "damping: -1 N m s/rad");
  expect_refusal(edited([](Body& b) { b.joint.friction = {-1}; }), "friction: -1 N m");
  expect_refusal(edited([&](Body& b) { b.joint.effort = {nan}; }), "effort: nan");
  EXPECT_NO_THROW(edited([&](Body& b) { b.joint.effort = {inf}; })());
  expect_refusal(edited([](Body& b) { b.joint.velocity = {-1}; }), "velocity: -1 rad/s");
  expect_refusal(edited([](Body& b) { b.joint.lower = {1, 2}; }), "limits: 2 values");
  expect_refusal(edited([&](Body& b) { b.joint.upper = {nan}; }), "limits: nan");
  expect_refusal(edited([](Body& b) { b.joint.lower = {1}, b.joint.upper = {0}; }), "lower 1 above upper 0");
  EXPECT_NO_THROW(edited([](Body& b) { b.shapes.resize(1); })()) << "a sphere of radius 0 is a point";
  expect_refusal(edited([](Body& b) { b.shapes.resize(1), b.shapes[0].size[0] = -1; }), "shape 0 size: -1 m");
  expect_refusal(edited([](Body& b) { b.shapes.resize(1), b.shapes[0].kind = Shape::Kind::box; }), "shape 0 size: 0 m");
  expect_refusal(edited([&](Body& b) { b.shapes.resize(1), b.shapes[0].size[0] = 1, b.shapes[0].friction = nan; }), "friction");
}

TEST(model, refuses_trees_and_names_that_cannot_be) {
  Model m;
  Body child = good_body("r/child");
  child.parent = 0;
  expect_refusal([&] { m.add(child); }, "r/child: parent 0 is not an earlier body");
  m.add(good_body("r/base"));
  m.add(child);
  EXPECT_EQ(m.find("r/child"), 1);
  expect_refusal([&] { (void)m.find("r/hand"); }, "r/hand: no body has this name (accepted: r/base, r/child; names are robot/link)");
  EXPECT_NO_THROW(validate(m, "f"));
  Model bad = m;
  bad.bodies[1].parent = 1;
  expect_refusal([&] { validate(bad, "f"); }, "f: r/child: parent 1");
  bad = m;
  bad.bodies[1].name = "r/base";
  expect_refusal([&] { validate(bad, "f"); }, "two bodies have this name");
  bad = m;
  bad.first_dof.pop_back();
  expect_refusal([&] { validate(bad, "f"); }, "first_q and first_dof");
  bad = m;
  bad.bodies[1].joint.type = JointType::planar;
  expect_refusal([&] { validate(bad, "f"); }, "does not fit the joint type");
}

TEST(model, refuses_constraints_that_cannot_be) {
  Model m;
  m.add(good_body("r/base"));
  Body child = good_body("r/child");
  child.parent = 0;
  m.add(child);
  const auto edited = [&m](Kind kind, const std::function<void(Constraint&)>& edit) {
    return [&m, kind, edit] {
      Constraint c;
      c.name = "c1";
      c.kind = kind;
      c.a.body = 1;
      c.length = 1;
      edit(c);
      Model with = m;
      with.constraints = {c};
      validate(with, "scene.yaml");
    };
  };
  const auto on = [](Index body, Index dof) { return Constraint::Term{body, dof, 1, MatrixX<double>::Zero(2, 6)}; };
  EXPECT_NO_THROW(edited(Kind::point, [](Constraint&) {})());
  expect_refusal(edited(Kind::point, [](Constraint& c) { c.b.body = 1; }), "scene.yaml: point constraint c1: both frames are on r/child");
  expect_refusal(edited(Kind::weld, [](Constraint& c) { c.a.body = ground; }), "both frames are fixed in the world");
  expect_refusal(edited(Kind::hinge, [](Constraint& c) { c.a.body = 2; }), "body 2 does not exist");
  expect_refusal(edited(Kind::hinge, [](Constraint& c) { c.b.body = -2; }), "body -2 does not exist");
  expect_refusal(edited(Kind::hinge, [](Constraint& c) { c.b.placement.rotation(0, 0) = 2; }), "frame b: rotation");
  expect_refusal(edited(Kind::distance, [](Constraint& c) { c.length = 0; }), "length: 0 m");
  expect_refusal(edited(Kind::contact, [](Constraint& c) { c.friction = std::nan(""); }), "friction");
  expect_refusal(edited(Kind::joint_lock, [](Constraint& c) { c.a.body = ground; }), "body -1 does not exist");
  expect_refusal(edited(Kind::joint_lock, [](Constraint& c) { c.loop = true; }), "no position level");
  expect_refusal(edited(Kind::coupling, [](Constraint&) {}), "has no terms");
  expect_refusal(edited(Kind::coupling, [&](Constraint& c) { c.terms = {on(ground, 0)}; }), "body -1 does not exist");
  expect_refusal(edited(Kind::coupling, [&](Constraint& c) { c.terms = {on(1, 1)}; }), "degree of freedom 1 of r/child");
  expect_refusal(edited(Kind::coupling, [&](Constraint& c) { c.terms = {on(1, 0)}, c.terms[0].coefficient = std::nan(""); }),
                 "coefficient is not finite");
  EXPECT_NO_THROW(edited(Kind::general, [&](Constraint& c) { c.terms = {on(1, 0), on(ground, 0)}; })());
  expect_refusal(edited(Kind::general, [&](Constraint& c) { c.terms = {on(ground, 0)}; }), "every term is on the ground");
  expect_refusal(edited(Kind::general, [&](Constraint& c) { c.terms = {on(0, 0), on(1, 0)}, c.terms[1].K.resize(1, 6); }), "K of 1 x 6");
  expect_refusal(edited(Kind::general, [&](Constraint& c) { c.terms = {on(0, 0)}, c.terms[0].K.resize(2, 5); }), "K of 2 x 5");
  expect_refusal(edited(Kind::general, [&](Constraint& c) { c.terms = {on(0, 0)}, c.terms[0].K(0, 0) = std::nan(""); }), "K is not finite");
}

/// Base, a massless body on `axis`, and a massive one on `tip_axis` at the same point; masses all at their own origin.
Model wrist(const Vector3<double>& axis, const Vector3<double>& tip_axis, double armature = 0) {
  Model m;
  Body b = good_body("w/massless");
  b.mass = 0;
  b.inertia.setZero();
  b.joint.axis = axis;
  if (armature > 0) b.joint.armature = {armature};
  m.add(b);
  b = good_body("w/tip");
  b.parent = 0;
  b.joint.axis = tip_axis;
  m.add(b);
  return m;
}

TEST(regularity, semidefinite_inertias_need_a_lever_arm_and_indefinite_ones_a_positive_pivot) {
  const auto arm = [](const Vector3<double>& com, const Vector3<double>& moments, JointType type = JointType::revolute) {
    Body b = good_body("r/arm");
    b.com = com;
    b.inertia = moments.asDiagonal();
    b.joint.type = type;
    Model m;
    m.add(b);
    return m;
  };
  EXPECT_NO_THROW(validate(arm({0.5, 0, 0}, {0, 0, 0}), "f"));  // a point mass on a lever about z
  expect_refusal([&] { validate(arm({0, 0, 0.5}, {0, 0, 0}), "f"); }, "r/arm: point mass of 1 kg");
  EXPECT_NO_THROW(validate(arm({0, 0, 0}, {0, 0.1, 0.1}), "f"));  // a rod across the axis
  expect_refusal([&] { validate(arm({0, 0, 0}, {0.1, 0.1, 0}), "f"); }, "M is singular");
  expect_refusal([&] { validate(arm({0.5, 0, 0}, {0, 0.1, 0.1}, JointType::floating), "f"); }, "M is singular");
  expect_refusal([&] { validate(arm({0, 0, 0}, {1, 1, 0}, JointType::floating), "f"); }, "M is singular");
  EXPECT_NO_THROW(validate(arm({0.5, 0, 0}, {1, 1, -0.2}), "f"));  // 0.25 − 0.2
  expect_refusal([&] { validate(arm({0.5, 0, 0}, {1, 1, -0.3}), "f"); }, "M is indefinite");
  expect_refusal([&] { validate(arm({0.5, 0, 0}, {1, 1, -0.2}, JointType::floating), "f"); }, "M is indefinite");
  // A sound body that floats, and one on it that takes all its inertia about one axis, wherever that turns to.
  for (const double moment : {-1.0, -0.75}) {
    Model pair = arm({0, 0, 0}, {1, 1, 1}, JointType::floating);
    Body b = good_body("r/hand");
    b.parent = 0, b.com.setZero(), b.inertia = Vector3<double>(moment, 1, 1).asDiagonal();
    b.joint.type = JointType::revolute, b.joint.axis = {0, 0, 1}, b.joint.placement = {};
    pair.add(b);
    if (moment > -1) EXPECT_NO_THROW(validate(pair, "f"));
    else expect_refusal([&] { validate(pair, "f"); }, "r/hand: body of 1 kg with the principal moments (-1 1 1) kg m^2: M is singular, at r/arm");
  }
}

TEST(regularity, massless_bodies_need_armature_or_moved_inertia) {
  const Vector3<double> x(1, 0, 0), z(0, 0, 1), oblique(0.6, 0, 0.8);
  EXPECT_NO_THROW(validate(wrist(z, x), "f"));
  EXPECT_NO_THROW(validate(wrist(z, oblique), "f"));
  expect_refusal([&] { validate(wrist(z, z), "f"); }, "f: w/massless: massless body whose joint moves no inertia");
  EXPECT_NO_THROW(validate(wrist(z, z, 0.01), "f"));
  Model lever = wrist(z, z);  // parallel axes apart: the tip's joint cannot undo the massless joint's motion
  lever.bodies[1].joint.placement.translation = {1, 0, 0};
  EXPECT_NO_THROW(validate(lever, "f"));
  Model gimbal = wrist(z, x);  // three crossing axes, the outermost two massless, aligned at the neutral configuration
  Body b = gimbal.bodies[1];
  b.name = "w/third", b.parent = 1, b.joint.axis = z;
  gimbal.bodies[1].mass = 0, gimbal.bodies[1].inertia.setZero();
  gimbal.add(b);
  EXPECT_NO_THROW(validate(gimbal, "f")) << "singular at q = 0 alone";
  gimbal.bodies[1].joint.axis = z;
  expect_refusal([&] { validate(gimbal, "f"); }, "moves no inertia");
  Model tip = wrist(z, x);
  tip.bodies[1].mass = 0, tip.bodies[1].inertia.setZero();
  expect_refusal([&] { validate(tip, "f"); }, "f: w/tip: massless tip without armature");
  tip.bodies[1].joint.armature = {0.1};  // keeps the tip's pivot, but is no inertia of the first joint
  expect_refusal([&] { validate(tip, "f"); }, "f: w/massless: massless body whose joint moves no inertia");
  tip.bodies[0] = good_body("w/base");
  EXPECT_NO_THROW(validate(tip, "f"));
}

/// A plane four-bar linkage of links 1, 2 and 1.5 on pivots 2 apart, closed by a hinge.
Model four_bar() {
  Model m;
  const double length[] = {1, 2, 1.5};
  for (Index k = 0; k < 3; ++k) {
    Body b = good_body("f/" + std::to_string(k));
    b.parent = k - 1;
    if (k > 0) b.joint.placement.translation = {length[k - 1], 0, 0};
    b.com = {length[k] / 2, 0, 0};
    m.add(b);
  }
  Constraint c;
  c.name = "closing";
  c.kind = Kind::hinge;
  c.loop = true;
  c.a = {2, {Matrix3<double>::Identity(), {length[2], 0, 0}}};
  c.b = {ground, {Matrix3<double>::Identity(), {2, 0, 0}}};
  m.constraints = {c};
  return m;
}

TEST(assembly, closes_a_four_bar) {
  const Model m = four_bar();
  const Assembly a = assemble(m, VectorX<double>{{1.0, -0.8, -1.2}}, "f");
  EXPECT_GT(a.residual_before, 0.1);
  EXPECT_LT(ratio(a.residual, 4.5), 30);
  EXPECT_GT(a.steps, 0);
  const Assembly again = assemble(m, a.q, "f");
  EXPECT_LE(again.residual, a.residual);
  const Assembly none = assemble(two_robots(1), neutral(two_robots(1)), "f");
  EXPECT_EQ(none.steps, 0);
  EXPECT_THROW((void)assemble(m, VectorX<double>::Zero(2), "f"), std::logic_error);
}

TEST(assembly, reaches_the_stretched_configuration) {
  Model m = four_bar();
  m.constraints[0].b.placement.translation = {4.5, 0, 0};  // the sum of the links: J loses a rank there
  const Assembly a = assemble(m, VectorX<double>{{0.3, -0.2, 0.1}}, "f");
  EXPECT_LT(ratio(a.residual, 4 * 4.5), 30);  // three joints and the closing one
}

TEST(assembly, refuses_what_cannot_be_closed) {
  Model m = four_bar();
  m.constraints[0].b.placement.translation = {5, 0, 0};
  expect_refusal([&] { (void)assemble(m, VectorX<double>{{0.3, -0.2, 0.1}}, "f"); },
                 "f: hinge constraint closing: the loop cannot be closed from this pose: open by 0.");
  EXPECT_THROW((void)assemble(m, VectorX<double>::Constant(3, std::nan("")), "f"), ModelError);
}

TEST(assembly, moves_trees_together_and_leaves_the_others) {
  Random random(8);
  Model m = two_robots(8);
  m.add(random_body(random, "c/alone", ground, JointType::floating));
  Constraint c;
  c.kind = Kind::weld;
  c.loop = true;
  c.a = {7, random.pose()};
  c.b = {15, random.pose()};
  m.constraints = {c};
  const VectorX<double> q = random_configuration(m, random);
  const Assembly a = assemble(m, q, "f");
  EXPECT_LT(ratio(a.residual, 20), 30);
  EXPECT_EQ(a.q.tail<7>(), q.tail<7>());
}

}  // namespace
}  // namespace delassus::model_test
