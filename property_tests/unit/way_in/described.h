// Robots written, read, and held against what the value they were written from comes to (random_urdf.h).
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "algorithms/kit/test_scalars.h"
#include "algorithms/mechanism/kinematics.h"
#include "models/contacts.h"
#include "models/formats/urdf.h"
#include "property_tests/unit/way_in/random_urdf.h"
#include "property_tests/unit/operators/path_sums.h"
#include "property_tests/unit/way_in/temporary.h"
#include "property_tests/laws/verdict.h"

namespace delassus::described {

using laws::Verdict;
using test::Computed;
using test::Urdf;
using test::Values;
using Quads = MatrixX<Quad>;
using Base = RobotOptions::Base;

inline constexpr double eps = 0x1p-53;
inline constexpr unsigned robots = 30;

struct Read {
  Model model;
  Robot robot;
  VectorX<double> q;
  Poses<double> poses;
};

inline std::string file_of(const Urdf& robot) {
  const auto file = test::temporary("random.urdf");
  std::ofstream(file) << text(robot);
  return file.string();
}

inline Pose<double> in_double(const test::Origin& origin) {
  const Pose<Quad> p = test::pose_of(origin);
  const auto narrow = [](const Quad& x) { return static_cast<double>(x); };
  return {p.rotation.unaryExpr(narrow), p.translation.unaryExpr(narrow)};
}

inline Read read(const Urdf& robot, const Values& values, Base base, const test::Origin& pose = {}) {
  Read r;
  RobotOptions o;
  o.file = file_of(robot);
  o.robot = "r";
  o.base = base;
  o.pose = in_double(pose);
  r.robot = add_urdf(r.model, o);
  r.q = neutral(r.model);
  for (const auto& [name, value] : values) {
    const auto joint = r.robot.joints.find(name);
    const bool moves = name == "base" ? !r.robot.root_joint.empty() : joint != r.robot.joints.end();
    if (!moves && joint == r.robot.joints.end()) continue;
    const auto i = static_cast<std::size_t>(joint != r.robot.joints.end() ? joint->second : 0);
    for (Index k = 0; k < q_size(r.model.bodies[i].joint.type); ++k) r.q[r.model.first_q[i] + k] = value[static_cast<std::size_t>(k)];
  }
  poses(r.model, r.q, r.poses);
  return r;
}

/// Columns of the computation in the order of the model.
inline std::vector<Index> order_of(const Model& model, const Computed& c) {
  std::vector<Index> order;
  for (const Body& body : model.bodies)
    for (Index k = 0; k < dof_count(body.joint.type); ++k) order.push_back(c.column.at(body.joint.name.substr(2)) + k);
  return order;
}

inline Verdict compare(const Quads& read, const Quads& computed, const Quads& size, const std::vector<Index>& rows, const std::vector<Index>& columns, const char* name) {
  if (read.rows() != static_cast<Index>(rows.size()) || read.cols() != static_cast<Index>(columns.size())) return laws::failure("shapes differ", name);
  Quads error(read), bound(read);
  for (Index j = 0; j < read.cols(); ++j)
    for (Index i = 0; i < read.rows(); ++i) {
      const Index k = rows[static_cast<std::size_t>(i)], l = columns[static_cast<std::size_t>(j)];
      error(i, j) = read(i, j) - computed(k, l), bound(i, j) = size(k, l);
    }
  return laws::judge(error, bound, eps, name);
}

/// M, and for every link of the computation its place and its motion.
inline Verdict agrees(const Read& r, const Computed& c) {
  Model model = r.model;
  model.constraints.clear();
  std::vector<std::string> links;
  Verdict worst;
  for (const auto& [name, pose] : c.link) {
    const Frame& frame = r.robot.links.at(name);
    const Pose<double> X = world_pose(r.poses, frame.body) * frame.placement;
    worst = laws::worst(worst, laws::judge(Quads(X.rotation.cast<Quad>() - pose.rotation), Quads::Constant(3, 3, Quad(1)), eps, "rotations: 1"));
    worst = laws::worst(worst, laws::judge(Quads(X.translation.cast<Quad>() - pose.translation), Quads::Constant(3, 1, c.way.at(name)), eps, "places: joints × the way to them"));
    if (frame.body == ground) continue;
    Constraint weld;
    weld.kind = Constraint::Kind::weld;
    weld.a = frame;
    model.constraints.push_back(weld);
    links.push_back(name);
  }
  const Problem<double> p = kinematics<double>(model, r.q);
  const std::vector<Index> order = order_of(r.model, c);
  worst = laws::worst(worst, compare(unit::mass_matrix(p.cast<Quad>()), c.M, c.M_size, order, order, "M: joints × sums of sizes"));
  const Quads J = unit::constraint_jacobian(p.cast<Quad>());
  for (std::size_t k = 0; k < links.size(); ++k)
    worst = laws::worst(worst, compare(J.middleRows(6 * static_cast<Index>(k), 6), c.motion.at(links[k]), c.motion_size.at(links[k]), {0, 1, 2, 3, 4, 5}, order, "motion: joints × length of the way"));
  return worst;
}

inline void expect(const Verdict& v, const std::string& what) { EXPECT_TRUE(v.passed()) << what << ": " << v.ratio << " eps · " << v.bound << ' ' << v.note; }

inline const test::Origin somewhere{{0.4, -1.1, 0.7}, {0.5, -0.8, 2.1}};

inline void for_each_robot(const std::function<void(const Urdf&, const Values&, unsigned, const std::string&)>& law) {
  for (unsigned seed = 1; seed <= robots; ++seed) {
    const Urdf robot = test::random_urdf(seed);
    law(robot, test::random_values(robot, seed), seed, "random_urdf(" + std::to_string(seed) + ")");
    if (testing::Test::HasFailure()) return;
  }
}

}  // namespace delassus::described
