// Laws of boxes against boxes and spheres: which points of two faces stay, what does not flicker, what is near nothing.
#include <gtest/gtest.h>

#include "models/shapes/box_contacts.h"
#include "property_tests/unit/shapes/contact_pairs.h"

namespace delassus::box_laws_test {
namespace {

using namespace contact_test;

/// Points of a rectangle's overlap with another in one plane: corners inside the other, and crossings of edges.
std::vector<V3> overlap(const Shape& box, Index axis, const Shape& other, const V3& n) {
  const auto corners = [](const Shape& s, Index k, const V3& side) {
    const Index i = (k + 1) % 3, j = (k + 2) % 3;
    const auto& R = s.placement.rotation;
    const V3 c = s.placement.translation + (side.dot(R.col(k)) > 0 ? 1 : -1) * s.size[k] * R.col(k);
    return std::vector<V3>{c + s.size[i] * R.col(i) + s.size[j] * R.col(j), c - s.size[i] * R.col(i) + s.size[j] * R.col(j),
                           c - s.size[i] * R.col(i) - s.size[j] * R.col(j), c + s.size[i] * R.col(i) - s.size[j] * R.col(j)};
  };
  Index facing = 0;
  (other.placement.rotation.transpose() * n).cwiseAbs().maxCoeff(&facing);
  const std::vector<V3> p = corners(box, axis, n), q = corners(other, facing, -n);
  std::vector<V3> out;
  const auto flat = [&](const V3& x) { return V3(x - n.dot(x) * n); };
  const auto inside = [&](const V3& x, const std::vector<V3>& polygon) {
    int left = 0, right = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const double side = n.dot(flat(polygon[(k + 1) % 4] - polygon[k]).cross(flat(x - polygon[k])));
      left += side > 0, right += side < 0;
    }
    return left == 0 || right == 0;
  };
  for (const V3& x : p)
    if (inside(x, q)) out.push_back(flat(x));
  for (const V3& x : q)
    if (inside(x, p)) out.push_back(flat(x));
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t l = 0; l < 4; ++l) {
      const V3 a = flat(p[k]), u = flat(p[(k + 1) % 4]) - a, b = flat(q[l]), v = flat(q[(l + 1) % 4]) - b;
      const double cross = n.dot(u.cross(v));
      if (std::abs(cross) < 1e-9) continue;
      const double s = n.dot((b - a).cross(v)) / cross, t = n.dot((b - a).cross(u)) / cross;
      if (s > 0 && s < 1 && t > 0 && t < 1) out.push_back(a + s * u);
    }
  return out;
}

// Faces on each other, one turned in the plane: of five to eight corners of the overlap the farthest along each diagonal of
// the face stay, and all four when there are no more.
TEST(ContactLaws, the_points_kept_reach_farthest) {
  int more = 0;
  for (unsigned seed = 1; seed <= 80; ++seed) {
    Random r(seed);
    const Shape b = random_shape(Kind::box, r);
    Shape a = random_shape(Kind::box, r);
    a.size.setConstant(r.number(0.35, 0.55));
    a.placement.rotation = b.placement.rotation * Eigen::AngleAxisd(r.number(0.2, 1.3), V3::UnitX()).toRotationMatrix();
    const V3 n = b.placement.rotation.col(0);
    a.placement.translation = b.placement.translation + (a.size[0] + b.size[0] - 1e-4) * n + b.placement.rotation * V3(0, r.number(-0.2, 0.2), r.number(-0.2, 0.2));
    const Pair p = pair_of(a, b, r);
    const std::vector<ContactPoint> found = find(p).contacts;
    const std::vector<V3> all = overlap(b, 0, a, n);
    ASSERT_EQ(found.size(), std::min<std::size_t>(4, all.size())) << seed;
    more += all.size() > 4;
    for (std::size_t k = 0; k < found.size(); ++k)
      for (std::size_t l = 0; l < k; ++l) EXPECT_GT((found[k].point - found[l].point).norm(), 1e-9) << seed;
    // The reference face is the larger of the two.
    const auto reaches = [&](const Shape& s, Index k) {
      for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0}) {
          const V3 d = x * s.placement.rotation.col((k + 1) % 3) / s.size[(k + 1) % 3] + y * s.placement.rotation.col((k + 2) % 3) / s.size[(k + 2) % 3];
          double farthest = -1e9, kept = -1e9;
          for (const V3& v : all) farthest = std::max(farthest, d.dot(v));
          for (const ContactPoint& c : found) kept = std::max(kept, d.dot(c.point - n.dot(c.point) * n));
          if (!small(farthest - kept, d.norm() * p.size / (p.spread * p.spread))) return false;
        }
      return true;
    };
    EXPECT_TRUE(a.size[1] * a.size[2] > b.size[1] * b.size[2] ? reaches(a, 0) : reaches(b, 0)) << seed;
  }
  EXPECT_GT(more, 20);
}

// Of descriptions that differ by less than a millionth of the sizes the first stays: faces before other faces, faces of the
// first box before those of the second (unless these are larger), faces before edges.
TEST(ContactLaws, nearly_equal_descriptions_do_not_flicker) {
  const auto cube = [](double half, const V3& at, double tilt) {
    return PlacedBox{V3::Constant(half), {Eigen::AngleAxisd(tilt, V3::UnitX()).toRotationMatrix(), at}};
  };
  const double lead = 1e-6 * (0.5 + 0.25) * std::sqrt(3.0);
  for (const auto& [share, first_stays] : {std::pair{0.8, true}, {1.2, false}}) {
    // b is broader across the tilt, a has the larger face: b's face is farther by the difference of their halves × tilt.
    const PlacedBox narrow{{1, 0.25, 0.25}, {}}, broad{{0.25, 0.5, 0.25}, {}};
    const double tilt = share * 1e-6 * (narrow.half.norm() + broad.half.norm()) / 0.25;
    const auto found = box_box({narrow.half, cube(0, {0, 0, 0.5}, tilt).placement}, broad, 1e-2);
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(std::abs(found[0].normal[1]) > tilt / 2, first_stays) << found[0].normal.transpose();
    // Two faces of one box, apart by nearly the same.
    const auto corner = box_box(cube(0.5, {0.7499, 0.7499 + share * lead, 0}, 0), cube(0.25, {0, 0, 0}, 0), 1e-2);
    ASSERT_FALSE(corner.empty());
    EXPECT_EQ(corner[0].normal[0] > 0.5, first_stays) << corner[0].normal.transpose();
  }
  const double tilt = std::sqrt(1e-6 * std::sqrt(3.0));
  EXPECT_GT(std::abs(box_box(cube(0.5, {0, 0, 1}, tilt), cube(0.5, {0, 0, 0}, 0), 1e-2)[0].normal[1]), 1e-4) << "equal faces: the first box's";
}

// A point on a corner of the face that reaches farthest along two diagonals is kept once.
TEST(ContactLaws, no_point_is_kept_twice) {
  int corners = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    Random r(seed);
    const PlacedBox a{{0.3, 0.3, 0.1}, {Eigen::AngleAxisd(r.number(0.2, 1.3), V3::UnitZ()).toRotationMatrix(), {r.number(0, 0.7), r.number(0, 0.7), 0.2}}}, b{{0.5, 0.4, 0.1}, {}};
    const auto found = box_box(a, b, 1e-3);
    corners += found.size() == 4;
    for (std::size_t k = 0; k < found.size(); ++k)
      for (std::size_t l = 0; l < k; ++l) EXPECT_GT((found[k].point - found[l].point).norm(), 1e-9) << seed;
  }
  EXPECT_GT(corners, 50);
}

// A centre inside the box leaves through the nearest face.
TEST(ContactLaws, a_sphere_whose_centre_is_inside_leaves_through_the_nearest_face) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Random r(seed);
    const PlacedBox box{{0.3, 0.4, 0.5}, {r.rotation(), r.vector()}};
    const V3 local(r.number(-0.3, 0.3), r.number(-0.4, 0.4), r.number(-0.5, 0.5));
    const ShapeContact c = sphere_box(box.placement * local, 0.1, box);
    double depth = 1;
    V3 out;
    for (Index k = 0; k < 3; ++k)
      for (const double side : {-1.0, 1.0})
        if (const double way = box.half[k] - side * local[k]; way < depth) depth = way, out = side * box.placement.rotation.col(k);
    EXPECT_TRUE(small(c.gap + depth + 0.1, 3)) << seed;
    EXPECT_TRUE(small((c.normal - out).norm(), 3)) << seed;
    const V3 on_box = box.placement * local + depth * out, on_sphere = box.placement * local - 0.1 * out;
    EXPECT_TRUE(small((c.point - (on_box + on_sphere) / 2).norm(), 5)) << seed;
  }
}

TEST(ContactLaws, edges_apart_by_more_than_the_margin_give_nothing) {
  Matrix3<double> up, down;  // an edge on top along x, an edge below along y
  up = Eigen::AngleAxisd(0.7853981633974483, V3::UnitX()).toRotationMatrix();
  down = Eigen::AngleAxisd(0.7853981633974483, V3::UnitY()).toRotationMatrix();
  const PlacedBox lower{{0.5, 0.5, 0.5}, {up, V3(0, 0, 0)}};
  for (const auto& [gap, points] : {std::pair{0.5e-3, 1u}, {2e-3, 0u}})
    EXPECT_EQ(box_box({{0.5, 0.5, 0.5}, {down, {0, 0, std::sqrt(2.0) + gap}}}, lower, 1e-3).size(), points);
}

}  // namespace
}  // namespace delassus::box_laws_test
