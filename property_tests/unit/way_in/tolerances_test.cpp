// Every limit of refusal of a described model, from both sides: half of it passes, twice it does not.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <sstream>

#include "algorithms/mechanism/kinematics.h"
#include "models/scene.h"
#include "property_tests/unit/way_in/temporary.h"

namespace delassus::tolerances_test {
namespace {

constexpr double eps = 0x1p-53;

/// `made(x)` must pass at half the limit and be refused at twice, by a message with these words.
void expect_limit(double limit, const std::function<void(double)>& made, const std::string& words) {
  EXPECT_NO_THROW(made(limit / 2)) << words;
  try {
    made(2 * limit);
    ADD_FAILURE() << "twice the limit is accepted: " << words;
  } catch (const ModelError& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

Body body() {
  Body b;
  b.name = "b";
  b.mass = 1;
  b.inertia.diagonal() << 2, 3, 4;
  return b;
}

void add(const Body& b) {
  Model m;
  m.add(b);
}

TEST(Tolerances, rotations_axes_and_symmetry) {
  const double limit = 30 * eps * 3;
  expect_limit(limit, [](double x) { Body b = body(); b.joint.placement.rotation(0, 0) = 1 + x / 2; add(b); }, "rotation");
  expect_limit(limit, [](double x) { Body b = body(); b.joint.placement.rotation(0, 1) = x; add(b); }, "rotation");
  expect_limit(limit, [](double x) { Body b = body(); b.joint.axis[2] = 1 + x / 2; add(b); }, "unit");
  expect_limit(limit * 4, [](double x) { Body b = body(); b.inertia(0, 1) = x; add(b); }, "symmetric");
  const auto universal = [](double sine) {
    Body b = body();
    b.joint.type = JointType::universal;
    b.joint.axis2 = {0, sine, 1};
    add(b);
  };
  EXPECT_NO_THROW(universal(2 * limit));
  EXPECT_THROW(universal(limit / 2), ModelError);
}

Scene scene_of(const std::string& text) {
  const auto file = test::temporary("tolerances.yaml");
  std::ofstream(file) << text;
  return load_scene(file.string());
}

std::string number(double x) {
  std::ostringstream s;
  s.precision(17);
  s << x;
  return s.str();
}

TEST(Tolerances, blocks_of_damping) {
  const double limit = 30 * 2 * eps * 3 * std::sqrt(2.0);
  expect_limit(limit, [](double x) {
    static_cast<void>(scene_of("boxes: [{name: a, mass: 1, size: [1, 1, 1]}]\nconstraints: [{kind: point, of: a, to: world, damping: [[1, 0, 0], [0, 1, 0], [0, 0, " + number(-x) + "]]}]\n"));
  }, "eigenvalue");
}

TEST(Tolerances, directions_that_are_parallel) {
  const double limit = 30 * 2 * eps;
  const auto made = [](double x) {
    static_cast<void>(scene_of("boxes: [{name: a, mass: 1, size: [1, 1, 1]}]\nconstraints: [{kind: weld, of: a, to: world, axes: {z: [0, 0, 1], x: [" + number(x) + ", 0, 1]}}]\n"));
  };
  EXPECT_NO_THROW(made(2 * limit));
  EXPECT_THROW(made(limit / 2), ModelError);
}

}  // namespace
}  // namespace delassus::tolerances_test
