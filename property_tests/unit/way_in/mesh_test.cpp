// Collision meshes: files found and read, hulls in scenes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>

#include "models/shapes/hull.h"
#include "models/shapes/mesh.h"
#include "models/scene.h"
#include "property_tests/unit/way_in/temporary.h"

namespace delassus::mesh_test {
namespace {

namespace fs = std::filesystem;
using test::temporary;
using V3 = Vector3<double>;

#define NEEDS_MESHES \
  if (!has_mesh_files() || !has_hulls()) GTEST_SKIP() << "built without assimp or qhull"

/// A tetrahedron: corner at the origin, edges of these lengths along x, y, z.
const std::vector<V3> tetrahedron{V3(0, 0, 0), V3(1, 0, 0), V3(0, 2, 0), V3(0, 0, 4)};
constexpr int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

std::string coordinates(const V3& p) { return std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]); }

std::string stl() {
  std::string out = "solid t\n";
  for (const auto& f : faces) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const int i : f) out += "vertex " + coordinates(tetrahedron[static_cast<std::size_t>(i)]) + "\n";
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid t\n";
}

std::string binary_stl() {
  std::string out(80, ' ');
  auto add = [&](auto x) { out.append(reinterpret_cast<const char*>(&x), sizeof x); };
  add(std::uint32_t{4});
  for (const auto& f : faces) {
    for (int k = 0; k < 3; ++k) add(0.0f);
    for (const int i : f)
      for (int k = 0; k < 3; ++k) add(static_cast<float>(tetrahedron[static_cast<std::size_t>(i)][k]));
    add(std::uint16_t{0});
  }
  return out;
}

std::string obj() {
  std::string out = "# two objects\no tetrahedron\n";
  for (const V3& p : tetrahedron) out += "v " + coordinates(p) + "\n";
  for (const auto& f : faces) out += "f " + std::to_string(f[0] + 1) + " " + std::to_string(f[1] + 1) + " " + std::to_string(f[2] + 1) + "\n";
  out += "o plate\nv 9 0 0\nv 9 1 0\nv 9 0 1\nf 5 6 7\n";
  return out;
}

/// `unit` in metres; a node that turns x to y about z and moves by (5, 0, 0) holds the geometry.
std::string dae(const std::string& unit, const std::string& up) {
  std::string positions, triangles;
  for (const V3& p : tetrahedron) positions += coordinates(p) + " ";
  for (const auto& f : faces)
    for (const int i : f) triangles += std::to_string(i) + " ";
  return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="u" meter=")" + unit + R"("/><up_axis>)" + up + R"(</up_axis></asset>
<library_geometries><geometry id="g" name="g"><mesh>
<source id="p"><float_array id="pa" count="12">)" + positions + R"(</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>)" + triangles + R"(</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n" name="n"><matrix>0 -1 0 5  1 0 0 0  0 0 1 0  0 0 0 1</matrix>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

struct Before {
  bool operator()(const V3& a, const V3& b) const { return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3); }
};
using Set = std::set<V3, Before>;

/// Distinct points in units of 1e-6: files hold floats.
Set rounded(const std::vector<V3>& points) {
  Set out;
  for (const V3& p : points) out.insert((p * 1e6).array().round() + 0.0);
  return out;
}

Set points_of(const fs::path& file, const std::string& part = "") { return rounded(mesh_points(file.string(), part)); }

Set expected(const Matrix3<double>& R, const V3& t) {
  std::vector<V3> out;
  for (const V3& p : tetrahedron) out.push_back(R * p + t);
  return rounded(out);
}

TEST(Meshes, stl_and_obj_as_written) {
  NEEDS_MESHES;
  const fs::path a = temporary("mesh/a.stl"), b = temporary("mesh/b.stl"), c = temporary("mesh/c.obj");
  write(a, stl()), write(b, binary_stl()), write(c, obj());
  const Set tetra = expected(Matrix3<double>::Identity(), V3::Zero());
  EXPECT_EQ(points_of(a), tetra);
  EXPECT_EQ(points_of(b), tetra);
  EXPECT_EQ(points_of(c).size(), 7u);
  EXPECT_EQ(points_of(c, "tetrahedron"), tetra);
  EXPECT_THROW((void)mesh_points(c.string(), "lid"), std::runtime_error);
}

TEST(Meshes, dae_in_its_unit_and_its_own_axes_with_its_nodes) {
  NEEDS_MESHES;
  Matrix3<double> R;
  R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  for (const char* up : {"Z_UP", "Y_UP", "X_UP"}) {
    const fs::path file = temporary(std::string("mesh/") + up + ".dae");
    write(file, dae("1", up));
    EXPECT_EQ(points_of(file), expected(R, V3(5, 0, 0))) << up;
    write(file, dae("0.01", up));
    EXPECT_EQ(points_of(file), expected(0.01 * R, V3(0.05, 0, 0))) << up;
  }
}

TEST(Meshes, what_cannot_be_read_says_why) {
  NEEDS_MESHES;
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"empty.stl", ""}, {"broken.dae", "<COLLADA"}, {"none.obj", "# nothing\n"}, {"what.xyz", "1 2 3"}}) {
    const fs::path file = temporary("mesh/" + name);
    write(file, text);
    try {
      (void)mesh_points(file.string());
      FAIL() << name;
    } catch (const std::runtime_error& e) {
      EXPECT_NE(std::string(e.what()), "") << name;
    }
  }
}

TEST(Meshes, are_found_where_the_page_says) {
  const fs::path root = temporary("found");
  for (const char* p : {"ws/arm_description/meshes/a.stl", "ws/arm_description/urdf/arm.urdf", "ws/hand/b.stl", "extra/tool/c.stl", "extra/loose.stl", "ros/base/d.stl"})
    write(root / p, "x");
  const std::string robot = (root / "ws/arm_description/urdf/arm.urdf").string();
  ASSERT_EQ(setenv("ROS_PACKAGE_PATH", (":/nowhere:" + (root / "ros").string()).c_str(), 1), 0);
  auto found = [&](const std::string& uri, const std::vector<std::string>& path = {}) {
    std::string tried;
    const std::string file = find_mesh(uri, robot, path, tried);
    EXPECT_EQ(tried.empty(), !file.empty()) << uri;
    return file.empty() ? "" : fs::relative(fs::weakly_canonical(file), fs::canonical(root)).string();
  };
  const std::string extra = (root / "extra").string();
  EXPECT_EQ(found("../meshes/a.stl"), "ws/arm_description/meshes/a.stl");
  EXPECT_EQ(found("file://" + (root / "ws/hand/b.stl").string()), "ws/hand/b.stl");
  EXPECT_EQ(found((root / "ws/hand/b.stl").string()), "ws/hand/b.stl");
  EXPECT_EQ(found("package://arm_description/meshes/a.stl"), "ws/arm_description/meshes/a.stl");
  EXPECT_EQ(found("model://arm_description/meshes/a.stl"), "ws/arm_description/meshes/a.stl");
  EXPECT_EQ(found("package://hand/b.stl"), "ws/hand/b.stl");
  EXPECT_EQ(found("package://base/d.stl"), "ros/base/d.stl");
  EXPECT_EQ(found("package://tool/c.stl"), "");
  EXPECT_EQ(found("package://tool/c.stl", {extra}), "extra/tool/c.stl");
  EXPECT_EQ(found("package://tool/c.stl", {extra + "/tool/"}), "extra/tool/c.stl");
  EXPECT_EQ(found("loose.stl"), "");
  EXPECT_EQ(found("loose.stl", {extra}), "extra/loose.stl");
  for (const char* uri : {"", "file://", "package://", "package://a", "package:///x", "http://a/b.stl", "..", "$(find x)/a.stl"}) EXPECT_EQ(found(uri, {extra}), "") << uri;
  unsetenv("ROS_PACKAGE_PATH");
}

/// A robot of two links on the ground, its collision shapes given.
Scene scene_with(const std::string& name, const std::string& collision, const std::string& contacts, const std::string& keys = "") {
  const std::string inertial = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
  write(temporary("scene/" + name + ".urdf"), "<robot name='r'><link name='a'>" + inertial + collision + "</link><link name='b'>" + inertial +
        "</link><joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint></robot>");
  const fs::path scene = temporary("scene/" + name + ".yaml");
  write(scene, "robots:\n  - {name: r, file: " + name + ".urdf, pose: {xyz: [0, 0, 0.1], rpy: [0, 0, 0.3]}" + keys + "}\nground: {z: 0}\n" + (contacts.empty() ? "" : "contacts: " + contacts + "\n"));
  return load_scene(scene.string());
}

std::string cube_obj() {
  std::string out;
  for (int k = 0; k < 8; ++k) out += "v " + coordinates(V3(k & 1 ? 2 : -2, k & 2 ? 4 : -4, k & 4 ? 1 : -1)) + "\n";
  for (const char* f : {"1 2 4 3", "5 6 8 7", "1 2 6 5", "3 4 8 7", "1 3 7 5", "2 4 8 6"}) out += "f " + std::string(f) + "\n";
  return out;
}

const char* const mesh_of_cube = "<collision><origin xyz='0.01 0 0' rpy='0 0 0.2'/><geometry><mesh filename='package://shapes/cube.obj' scale='0.1 0.1 0.1'/></geometry></collision>";

TEST(Meshes, touch_the_ground_as_the_same_box_does) {
  NEEDS_MESHES;
  write(temporary("scene/shapes/cube.obj"), cube_obj());
  const Scene mesh = scene_with("mesh", mesh_of_cube, "detect");
  const Scene box = scene_with("box", "<collision><origin xyz='0.01 0 0' rpy='0 0 0.2'/><geometry><box size='0.4 0.8 0.2'/></geometry></collision>", "detect");
  ASSERT_EQ(mesh.model.constraints.size(), 4u);
  ASSERT_EQ(box.model.constraints.size(), 4u);
  std::vector<V3> a, b;
  for (const Constraint& c : mesh.model.constraints) a.push_back(c.b.placement.translation);
  for (const Constraint& c : box.model.constraints) b.push_back(c.b.placement.translation);
  for (const V3& p : a) EXPECT_TRUE(std::any_of(b.begin(), b.end(), [&](const V3& x) { return (x - p).norm() < 1e-7; }));  // floats in the file
  EXPECT_TRUE(mesh.warnings.empty());
  EXPECT_TRUE(std::any_of(mesh.notes.begin(), mesh.notes.end(), [](const std::string& n) { return n.find("1 collision mesh as convex hull") != std::string::npos; }));
}

TEST(Meshes, are_read_only_for_contacts) {
  NEEDS_MESHES;
  write(temporary("scene/shapes/cube.obj"), "no mesh at all");
  EXPECT_TRUE(scene_with("lazy", mesh_of_cube, "").warnings.empty());
  const Scene s = scene_with("lazy", mesh_of_cube, "detect");
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_EQ(s.warnings[0].kind, "mesh not read");
  EXPECT_NE(s.warnings[0].text.find("write it anew as STL or OBJ"), std::string::npos) << s.warnings[0].text;
  EXPECT_TRUE(s.model.constraints.empty());
  const Scene lost = scene_with("lost", "<collision><geometry><mesh filename='package://elsewhere/x.stl'/></geometry></collision>", "detect");
  ASSERT_EQ(lost.warnings.size(), 1u);
  EXPECT_EQ(lost.warnings[0].kind, "mesh not found");
  EXPECT_NE(lost.warnings[0].text.find("mesh_path"), std::string::npos);
  write(temporary("scene/other/elsewhere/x.stl"), stl());
  const Scene found = scene_with("found", "<collision><geometry><mesh filename='package://elsewhere/x.stl'/></geometry></collision>", "{detect: true, margin: 0.2}", ", mesh_path: [other]");
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_EQ(found.model.constraints.size(), 3u);  // the tetrahedron stands on a face
}

TEST(Meshes, say_how_far_their_hulls_are_cut) {
  NEEDS_MESHES;
  std::string ball;
  for (int i = 0; i < 40; ++i)
    for (int j = 1; j < 20; ++j)
      ball += "v " + coordinates(0.1 * V3(std::cos(M_PI * i / 20) * std::sin(M_PI * j / 20), std::sin(M_PI * i / 20) * std::sin(M_PI * j / 20), std::cos(M_PI * j / 20))) + "\n";
  for (int i = 1; i + 2 <= 760; ++i) ball += "f " + std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 2) + "\n";
  write(temporary("scene/shapes/ball.obj"), ball);
  const std::string collision = "<collision><geometry><mesh filename='shapes/ball.obj'/></geometry></collision>";
  auto warned = [&](const std::string& contacts) { return scene_with("ball", collision, contacts).warnings.size(); };
  EXPECT_EQ(warned("detect"), 1u);
  EXPECT_EQ(warned("{detect: true, margin: 0.02}"), 0u);
  EXPECT_EQ(warned("{detect: true, hull_vertices: 1000}"), 0u);
  const Scene s = scene_with("ball", collision, "{detect: true, margin: 0.02}");
  EXPECT_TRUE(std::any_of(s.notes.begin(), s.notes.end(), [](const std::string& n) { return n.find("cut to 64 vertices: by at most") != std::string::npos; }));
  EXPECT_THROW((void)warned("{detect: true, hull_vertices: 3}"), ModelError);
}

/// A box of 1 × 2 × 3 off the origin, stretched by other factors along each axis, on a link that is fixed to the first.
TEST(Meshes, stand_stretched_where_their_link_puts_them) {
  NEEDS_MESHES;
  std::string text;
  std::vector<V3> corners;
  for (int k = 0; k < 8; ++k) corners.emplace_back(k & 1 ? 2 : 1, k & 2 ? 4 : 2, k & 4 ? 6 : 3), text += "v " + coordinates(corners.back()) + "\n";
  for (const char* f : {"1 2 4 3", "5 6 8 7", "1 2 6 5", "3 4 8 7", "1 3 7 5", "2 4 8 6"}) text += "f " + std::string(f) + "\n";
  write(temporary("scene/shapes/off.obj"), text);
  const std::string inertial = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
  const fs::path file = temporary("scene/off.urdf");
  write(file, "<robot name='r'><link name='a'>" + inertial + "</link><link name='b'>" + inertial +
        "<collision><origin xyz='0.25 0.5 -0.75' rpy='0.3 -0.4 0.5'/><geometry><mesh filename='shapes/off.obj' scale='0.5 0.25 0.75'/></geometry></collision></link>"
        "<joint name='f' type='fixed'><parent link='a'/><child link='b'/><origin xyz='1 -2 0.5' rpy='-0.7 0.2 1.1'/></joint></robot>");
  RobotOptions o;
  o.file = file.string(), o.robot = "r";
  Model model;
  Robot robot = add_robot(model, o);
  ASSERT_EQ(robot.meshes.size(), 1u);
  robot.meshes[0].friction = 0.625;
  Findings found(false);
  add_hulls(model, robot, 64, 0.01, found);
  ASSERT_EQ(model.bodies[0].shapes.size(), 1u);
  const Shape& s = model.bodies[0].shapes[0];
  EXPECT_EQ(s.friction, 0.625);
  EXPECT_EQ(s.size, V3(0.25, 0.25, 1.125));
  const Pose<double> at = Pose<double>{rotation_rpy({-0.7, 0.2, 1.1}), {1, -2, 0.5}} * Pose<double>{rotation_rpy({0.3, -0.4, 0.5}), {0.25, 0.5, -0.75}};
  ASSERT_EQ(s.points->size(), 8u);
  for (const V3& c : corners) {
    const V3 expected = at.rotation * c.cwiseProduct(V3(0.5, 0.25, 0.75)) + at.translation;
    double nearest = 1;
    for (const V3& p : *s.points) nearest = std::min(nearest, (s.placement.rotation * p + s.placement.translation - expected).norm());
    EXPECT_LT(nearest / (0x1p-53 * 8), 30) << c.transpose();
  }
}

}  // namespace
}  // namespace delassus::mesh_test
