// Scenes: the benchmark table's sizes, contacts on the ground, loops closed, what a scene file can say.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numeric>

#include "property_tests/unit/way_in/temporary.h"
#include "models/shapes/box_contacts.h"
#include "models/contacts.h"
#include "models/scene.h"
#include "models/swimmer.h"

namespace delassus::scene_test {
namespace {

constexpr double eps = 0x1p-53;

struct Size {
  const char* name;
  Index dofs, bodies, points, rows;
};
// Rows: 3 per point, one per joint degree of freedom with friction.
constexpr Size sizes[] = {{"go2_standing", 18, 13, 4, 12},         {"go2_standing_friction", 18, 13, 4, 24},
                          {"go2_fallen", 18, 13, 9, 27},           {"go2_fallen_friction", 18, 13, 10, 42},
                          {"cassie", 32, 23, 8, 24},               {"cassie_friction", 32, 23, 8, 50},
                          {"g1_standing", 35, 30, 8, 24},          {"g1_standing_friction", 35, 30, 8, 53},
                          {"g1_fallen", 35, 30, 23, 69},           {"g1_fallen_friction", 35, 30, 24, 101},
                          {"boxes_tower", 180, 30, 120, 360},      {"box_pyramid", 180, 30, 288, 864},
                          {"pyramid_robots_intact", 285, 120, 312, 936},
                          {"pyramid_robots_collapsing", 285, 120, 108, 324}};

Index points(const Scene& s) {
  return std::count_if(s.model.constraints.begin(), s.model.constraints.end(), [](const Constraint& c) {
    return c.kind == Constraint::Kind::contact || c.kind == Constraint::Kind::point;
  });
}

/// Largest distance of two positions of the scene's bodies, at least 1 m.
double extent(const Scene& s, const Poses<double>& p) {
  Vector3<double> low = Vector3<double>::Zero(), high = Vector3<double>::Ones();
  for (std::size_t i = 0; i < s.model.bodies.size(); ++i) {
    const Vector3<double> x = world_pose(p, static_cast<Index>(i)).translation;
    low = low.cwiseMin(x), high = high.cwiseMax(x);
  }
  return (high - low).norm();
}

TEST(Scenes, the_index_and_the_table_agree) {
  const std::vector<std::string> names = scene_names();
  ASSERT_EQ(names.size(), std::size(sizes));
  for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(names[i], sizes[i].name);
}

TEST(Scenes, sizes_of_the_benchmark_table) {
  for (const Size& z : sizes) {
    const Scene s = open_scene(z.name);
    EXPECT_EQ(s.model.dofs(), z.dofs) << z.name;
    EXPECT_EQ(static_cast<Index>(s.model.bodies.size()), z.bodies) << z.name;
    EXPECT_EQ(points(s), z.points) << z.name;
    const auto structure = structure_of(s.model);
    EXPECT_EQ(structure->rows, z.rows) << z.name;
    EXPECT_EQ(static_cast<Index>(s.damping.diagonal.size()), z.rows) << z.name;
    EXPECT_NO_THROW(s.damping.validate(*structure)) << z.name;
    EXPECT_EQ(s.q.size(), s.model.q_size()) << z.name;
  }
}

// Poses and points are written with 10 decimals: each of the ≤ 12 joints between base and foot adds half a unit.
TEST(Scenes, ground_contacts_lie_on_the_ground) {
  for (const Size& z : sizes) {
    const Scene s = open_scene(z.name);
    Poses<double> p;
    poses(s.model, s.q, p);
    const double size = extent(s, p);
    for (const Constraint& c : s.model.constraints) {
      if (c.kind != Constraint::Kind::contact || c.b.body != ground) continue;
      const Pose<double> a = world_pose(p, c.a.body) * c.a.placement;
      EXPECT_LE(std::abs(a.translation[2] - s.ground_height), 12 * 0.5e-10 * size) << z.name << " " << c.name;
      EXPECT_LE((a.rotation.col(2) - Vector3<double>::UnitZ()).norm(), 30 * eps * 30) << z.name;
    }
  }
}

TEST(Scenes, loops_are_closed) {
  for (const char* name : {"cassie", "cassie_friction"}) {
    const Scene s = open_scene(name);
    EXPECT_TRUE(s.has_loops);
    EXPECT_LE(s.assembly.residual, 30 * eps * 10);  // positions of 1 m through 10 joints
    EXPECT_EQ(s.assembly.q, s.q);
  }
}

TEST(Scenes, the_collapsing_pyramid_is_one_piece_without_the_ground) {
  const Scene s = open_scene("pyramid_robots_collapsing");
  std::vector<Index> group(s.model.bodies.size());
  std::iota(group.begin(), group.end(), Index{0});
  auto find = [&](Index i) {
    while (group[static_cast<std::size_t>(i)] != i) i = group[static_cast<std::size_t>(i)];
    return i;
  };
  auto join = [&](Index i, Index j) { group[static_cast<std::size_t>(find(i))] = find(j); };
  for (std::size_t i = 0; i < s.model.bodies.size(); ++i)
    if (s.model.bodies[i].parent != ground) join(static_cast<Index>(i), s.model.bodies[i].parent);
  for (const Constraint& c : s.model.constraints)
    if (c.b.body != ground) join(c.a.body, c.b.body);
  for (std::size_t i = 0; i < group.size(); ++i) EXPECT_EQ(find(static_cast<Index>(i)), find(0));
}

TEST(Scenes, every_scene_has_finite_numbers) {
  for (const Size& z : sizes) {
    const Problem<double> p = problem_of(open_scene(z.name));
    for (const auto& k : p.K) EXPECT_TRUE(k.allFinite()) << z.name;
    for (const auto& h : p.H) EXPECT_TRUE(h.allFinite()) << z.name;
  }
}

TEST(Swimmer, sizes_grow_with_the_links) {
  const Scene s = open_scene("swimmer:3");
  EXPECT_EQ(s.model.dofs(), 5);
  EXPECT_EQ(points(s), 6);
  EXPECT_EQ(structure_of(s.model)->rows, 18);
  EXPECT_EQ(structure_of(swimmer(20000).model)->rows, 120000);
}

Scene scene_of(const std::string& text) {
  const auto file = delassus::test::temporary("delassus_scene_test.yaml");
  std::ofstream(file) << text;
  return load_scene(file.string());
}

const std::string two_boxes =
    "boxes:\n  - {name: a, mass: 1, size: [1, 1, 1]}\n  - {name: b, mass: 2, size: [1, 1, 1], pose: {xyz: [3, 0, 0]}}\n";

TEST(SceneFile, every_key_at_the_top_lands_in_its_own_field) {
  const Scene none = scene_of(two_boxes), all = scene_of(two_boxes + "note: two boxes\npose: provisional\ngravity: [1, -2, 3]\nground: {z: -4, friction: 0.5}\nsleeping: {linear: 0.25, angular: 0.5, after: 2}\n");
  EXPECT_EQ(none.note, "");
  EXPECT_EQ(all.note, "two boxes");
  EXPECT_FALSE(none.provisional_pose);
  EXPECT_TRUE(all.provisional_pose);
  EXPECT_FALSE(scene_of(two_boxes + "pose: recorded\n").provisional_pose);
  EXPECT_FALSE(none.has_gravity);
  EXPECT_TRUE(all.has_gravity);
  EXPECT_EQ(all.gravity, Vector3<double>(1, -2, 3));
  EXPECT_FALSE(none.has_ground);
  EXPECT_TRUE(all.has_ground);
  EXPECT_EQ(all.ground_height, -4);
  EXPECT_EQ(all.ground_friction, 0.5);
  EXPECT_EQ(all.motion.sleeping.linear, 0.25);
  EXPECT_EQ(all.motion.sleeping.angular, 0.5);
  EXPECT_EQ(all.motion.sleeping.after, 2);
}

// A scene that gives no velocity has none, not velocities that are zero; a body behind those with one rests.
TEST(SceneFile, velocities_are_there_where_one_is_given) {
  EXPECT_EQ(scene_of(two_boxes).motion.nu.size(), 0);
  const Scene s = scene_of("boxes:\n  - {name: a, mass: 1, size: [1, 1, 1], velocity: {linear: [1, 2, 3]}}\n  - {name: b, mass: 1, size: [1, 1, 1], pose: {xyz: [3, 0, 0]}}\n");
  EXPECT_EQ(s.motion.nu, (VectorX<double>(12) << 0, 0, 0, 1, 2, 3, 0, 0, 0, 0, 0, 0).finished());
}

// The base of a robot that floats starts with its velocity, and the joints with theirs.
TEST(SceneFile, velocities_of_a_robot_are_read) {
  const auto file = delassus::test::temporary("delassus_scene_test_robot.urdf");
  std::ofstream(file) << "<robot name='r'><link name='a'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
                         "<link name='b'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
                         "<joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint></robot>";
  const Scene s = scene_of("robots:\n  - {name: r, urdf: " + file.string() + ", base: free, velocity: {angular: [1, 2, 3], linear: [4, 5, 6]}, velocities: {j: 7}}\n");
  EXPECT_EQ(s.motion.nu, (VectorX<double>(7) << 1, 2, 3, 4, 5, 6, 7).finished());
}

// R⁻¹ of contacts alone; of everything, where it is one number.
TEST(SceneFile, damping_of_contacts_is_read) {
  const std::string detect = two_boxes + "ground: {z: 0}\n";
  EXPECT_EQ(scene_of(detect + "contacts: {detect: true}\n").motion.contact_damping, 0);
  EXPECT_EQ(scene_of(detect + "contacts: {detect: true, damping: 0.25}\n").motion.contact_damping, 0.25);
  EXPECT_EQ(scene_of(detect + "damping: 0.5\ncontacts: {detect: true, damping: 0.25}\n").motion.contact_damping, 0.25);
  EXPECT_EQ(scene_of(detect + "damping: 0.5\ncontacts: {detect: true}\n").motion.contact_damping, 0.5);
}

TEST(SceneFile, general_constraints_are_called_by_their_number) {
  const std::string general = "  - {kind: general, terms: [{of: a, K: [[1, 0, 0, 0, 0, 0]]}]}\n";
  const Scene s = scene_of(two_boxes + "constraints:\n" + general + general);
  EXPECT_EQ(s.model.constraints[0].name, "general 0");
  EXPECT_EQ(s.model.constraints[1].name, "general 1");
}

TEST(SceneFile, an_open_end_is_where_the_first_one_is) {
  const Scene s = scene_of(two_boxes + "constraints:\n  - {kind: weld, of: a, at: [0.5, 0, 0], to: world}\n  - {kind: distance, of: a, to: b, to_at: [0, 0, 0]}\n");
  EXPECT_EQ(s.model.constraints[0].b.placement.translation, Vector3<double>(0.5, 0, 0));
  EXPECT_FALSE(s.model.constraints[0].loop);
  EXPECT_EQ(s.model.constraints[1].length, 3);
  EXPECT_TRUE(s.model.constraints[1].loop);
}

TEST(SceneFile, an_open_loop_is_assembled) {
  const Scene s = scene_of(two_boxes + "constraints:\n  - {kind: point, of: a, at: [1, 0, 0], to: b, to_at: [-1, 0, 0]}\n");
  EXPECT_EQ(s.assembly.residual_before, 1);
  EXPECT_LE(s.assembly.residual, 30 * eps * 3);
}

TEST(SceneFile, damping_by_row_by_constraint_and_by_block) {
  const Scene s = scene_of(two_boxes +
      "constraints:\n  - {kind: point, of: a, to: world, damping: [1, 2, 3]}\n  - {kind: point, of: b, to: world}\n"
      "  - {kind: point, of: a, to: b, damping: [[2, 1, 0], [1, 2, 0], [0, 0, 0]]}\ndamping: 0.5\n");
  EXPECT_EQ(s.damping.diagonal, (std::vector<double>{1, 2, 3, 0.5, 0.5, 0.5, 0, 0, 0}));
  ASSERT_EQ(s.damping.blocks.size(), 1u);
  EXPECT_EQ(s.damping.blocks[0].row, 6);
  EXPECT_EQ(s.damping.blocks[0].R_inverse(0, 1), 1);
}

TEST(SceneFile, a_general_block_follows_its_link) {
  const Scene s = scene_of(two_boxes + "constraints:\n  - {kind: general, terms: [{of: a, K: [[0, 0, 1, 0, 0, 0]]}, {of: b, K: [[0, 0, -1, 0, 0, 0]]}]}\n");
  EXPECT_EQ(row_count(s.model, s.model.constraints[0]), 1);
  EXPECT_EQ(s.model.constraints[0].terms[1].K(0, 2), -1);
}

PlacedBox box(double half, const Vector3<double>& at, double yaw = 0) {
  PlacedBox b{Vector3<double>::Constant(half), {}};
  b.placement.translation = at;
  b.placement.rotation << std::cos(yaw), -std::sin(yaw), 0, std::sin(yaw), std::cos(yaw), 0, 0, 0, 1;
  return b;
}

TEST(BoxContacts, resting_faces_give_four_points) {
  for (const double gap : {0.0, 1e-4, -1e-3})
    for (const double yaw : {0.0, 0.3, 0.785}) {
      const auto c = box_box(box(0.5, {0.2, 0.1, 1 + gap}, yaw), box(0.5, {0, 0, 0}), 1e-3);
      ASSERT_EQ(c.size(), 4u) << gap << " " << yaw;
      for (const ShapeContact& p : c) {
        EXPECT_LE((p.normal - Vector3<double>::UnitZ()).norm(), 30 * eps);
        EXPECT_LE(std::abs(p.gap - gap), 30 * eps * 2);
        EXPECT_LE(std::abs(p.point[2] - (0.5 + gap / 2)), 30 * eps * 2);
        EXPECT_LE(p.point.head<2>().cwiseAbs().maxCoeff(), 0.5 * (1 + 30 * eps));
      }
    }
}

TEST(BoxContacts, the_order_of_the_boxes_only_turns_the_normal) {
  const PlacedBox a = box(0.5, {0.3, 0.2, 1}), b = box(0.4, {0, 0, 0.1});
  const auto ab = box_box(a, b, 1e-3), ba = box_box(b, a, 1e-3);
  ASSERT_EQ(ab.size(), 4u);
  ASSERT_EQ(ba.size(), 4u);
  EXPECT_EQ(ab[0].normal, -ba[0].normal);
}

TEST(BoxContacts, crossed_edges_touch_in_one_point) {
  PlacedBox a = box(0.5, {0, 0, 0}), b = a;
  const double r = std::sqrt(0.5);
  a.placement.rotation << 1, 0, 0, 0, r, -r, 0, r, r;  // an edge along x on top
  b.placement.rotation << r, 0, r, 0, 1, 0, -r, 0, r;  // an edge along y below
  b.placement.translation[2] = 2 * r;
  const auto c = box_box(b, a, 1e-6);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_LE((c[0].point - Vector3<double>(0, 0, r)).norm(), 30 * eps * 2);
}

TEST(BoxContacts, apart_means_none) { EXPECT_TRUE(box_box(box(0.5, {0, 0, 1.1}), box(0.5, {0, 0, 0}), 1e-3).empty()); }

}  // namespace
}  // namespace delassus::scene_test
