// Laws of contacts with the ground, of the margin, of friction, and of which pairs are looked at.
#include <gtest/gtest.h>

#include <cmath>

#include "models/shapes/hull.h"
#include "property_tests/unit/shapes/contact_pairs.h"

namespace delassus::contact_ground_test {
namespace {

using namespace contact_test;

/// Corners of a box, ends of a capsule, the lowest point of a sphere: all that may touch the ground.
std::vector<V3> low_points(const Shape& s) {
  std::vector<V3> out;
  if (s.kind == Kind::box)
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0})
        for (const double z : {-1.0, 1.0}) out.push_back(s.placement * V3(x * s.size[0], y * s.size[1], z * s.size[2]));
  else
    for (const double end : {-1.0, 1.0}) out.push_back(s.placement * V3(0, 0, end * s.size[1]) - V3(0, 0, s.size[0]));
  if (s.kind == Kind::sphere) out.pop_back();
  return out;
}

// The ground at a height of its own; the lowest point by the support. Exactly the points below the margin, the four deepest.
TEST(ContactLaws, the_ground_is_where_it_is) {
  for (const Kind kind : {Kind::sphere, Kind::box, Kind::capsule, Kind::cylinder})
    for (unsigned seed = 1; seed <= pairs; ++seed) {
      Random r(seed);
      Shape s = random_shape(kind, r);
      if (seed % 3 == 0) s.placement.rotation = Eigen::AngleAxisd(r.number(-3, 3), V3::UnitZ()).toRotationMatrix();  // upright
      const double height = r.number(-2, 2), gap = r.number(-2, 0.5) * margin;
      s.placement.translation[2] += height + gap + support(s, {0, 0, -1});
      const Pair p = pair_of(s, shifted(random_shape(Kind::sphere, r), {50, 0, 50}), r);
      ContactSearch search;
      search.ground = true, search.ground_height = height, search.margin = seed % 5 == 0 ? 0.3 : margin;
      std::vector<double> gaps, expected;
      for (const ContactPoint& c : find(p, search).contacts) {
        EXPECT_EQ(c.body, 0);
        EXPECT_EQ(c.other, ground);
        EXPECT_EQ(c.normal, V3(0, 0, 1));
        EXPECT_TRUE(small(c.point[2] - height, p.size)) << seed;
        const V3 on_shape = c.point + V3(0, 0, c.gap);
        if (kind != Kind::cylinder) {
          EXPECT_TRUE(small(distance(s, on_shape), p.size) || kind == Kind::capsule) << seed;
        } else {
          const V3 local = s.placement.rotation.transpose() * (on_shape - s.placement.translation);
          EXPECT_TRUE(small(std::hypot(local[0], local[1]) - s.size[0], p.size) && small(std::abs(local[2]) - s.size[1], p.size)) << seed;
        }
        gaps.push_back(c.gap);
      }
      ASSERT_FALSE(gaps.empty()) << seed;
      std::sort(gaps.begin(), gaps.end());
      EXPECT_TRUE(small(gaps[0] - gap, p.size)) << static_cast<int>(kind) << ' ' << seed << ": " << gaps[0] << ' ' << gap;
      if (kind == Kind::cylinder) {
        const bool stands = seed % 3 == 0 && seed % 5 != 0;
        EXPECT_TRUE(stands ? gaps.size() == 4 : gaps.size() == 1 || gaps.size() == 2 || gaps.size() == 4) << gaps.size() << ", seed " << seed;
        continue;
      }
      for (const V3& x : low_points(s))
        if (x[2] - height <= search.margin) expected.push_back(x[2] - height);
      std::sort(expected.begin(), expected.end());
      expected.resize(std::min<std::size_t>(4, expected.size()));
      ASSERT_EQ(gaps.size(), expected.size()) << static_cast<int>(kind) << ' ' << seed;
      for (std::size_t k = 0; k < gaps.size(); ++k) EXPECT_TRUE(small(gaps[k] - expected[k], p.size)) << seed;
    }
}

// At half the margin there is a contact, at twice the margin none; links of one object never meet.
TEST(ContactLaws, the_margin_is_the_limit) {
  for (const Kind first : kinds)
    for (const Kind second : kinds) {
      Random r(7);
      const Shape b = random_shape(second, r), a = random_shape(first, r);
      const V3 d = b.placement.rotation.col(0);
      for (const double m : {1e-3, 0.02, 1e-6}) {
        ContactSearch search;
        search.margin = m;
        EXPECT_FALSE(find(pair_of(brought_to(a, b, d, m / 2), b, r), search).contacts.empty());
        EXPECT_TRUE(find(pair_of(brought_to(a, b, d, 2 * m), b, r), search).contacts.empty());
      }
      const Pair p = pair_of(brought_to(a, b, d, -margin), b, r);
      Poses<double> at;
      poses(p.model, p.q, at);
      ContactSearch search;
      search.object = {0, 0};
      std::vector<std::string> notes;
      EXPECT_TRUE(find_contacts(p.model, at, search, notes).empty());
    }
}

TEST(ContactLaws, the_smaller_friction_of_the_two_holds) {
  for (const auto& [a, b, expected] : {std::tuple{0.3, 0.7, 0.3}, std::tuple{0.7, 0.3, 0.3}, std::tuple{-1.0, 0.7, 0.7}, std::tuple{0.3, -1.0, 0.3}, std::tuple{-1.0, -1.0, -1.0}})
    for (const Kind first : kinds)
      for (const Kind second : kinds) {
        Random r(11);
        Shape y = random_shape(second, r), x = random_shape(first, r);
        x.friction = a, y.friction = b;
        for (const ContactPoint& c : find(pair_of(brought_to(x, y, y.placement.rotation.col(0), -margin), y, r)).contacts) EXPECT_EQ(c.friction, expected);
      }
}

TEST(ContactLaws, pairs_out_of_reach_are_not_missed_by_the_sweep) {
  // Many spheres in a row, each touching its neighbours, in an order of their own: as many contacts as neighbours.
  Random r(3);
  Model model;
  VectorX<double> q(7 * 40);
  ContactSearch search;
  for (Index k = 0; k < 40; ++k) {
    Body body;
    body.name = std::to_string(k), body.mass = 1, body.inertia.setIdentity(), body.joint.type = JointType::floating;
    body.shapes.push_back({Kind::sphere, V3(0.5, 0, 0), {}, -1, {}});
    const double place = static_cast<double>((k * 17) % 40);
    q.segment<7>(7 * k) << place * V3(0.6, 0.8, 0).cwiseAbs(), 1, 0, 0, 0;
    model.add(body);
    search.object.push_back(k);
  }
  Poses<double> at;
  poses(model, q, at);
  std::vector<std::string> notes;
  EXPECT_EQ(find_contacts(model, at, search, notes).size(), 39u);
}

/// Vertices of a hull, ends and rims of the others: points of the shape's surface.
std::vector<V3> surface_points(const Shape& s) {
  std::vector<V3> out;
  if (s.kind == Kind::hull)
    for (const V3& x : *s.points) out.push_back(s.placement * x);
  else if (s.kind == Kind::box)
    out = low_points(s);
  else
    for (const double end : {-1.0, 1.0})
      for (int k = 0; k < 16; ++k) {
        const double t = M_PI * k / 8;
        out.push_back(s.placement * V3(s.size[0] * std::cos(t), s.size[0] * std::sin(t), end * s.size[1]));
      }
  return out;
}

Index counted(const std::vector<std::string>& notes) {
  for (const std::string& n : notes)
    if (n.find("near pairs with a mesh were not tested") != std::string::npos) return std::stol(n);
  return 0;
}

// Pairs with a hull that has no surface are not tested but counted: those whose spheres about their frames' origins come within
// the margin, by brute force; no two whose surfaces come so near are left out of the number. With surfaces all are tested: bodies
// of which points come within the margin have a contact.
TEST(ContactLaws, pairs_with_hulls_are_tested_or_counted) {
  if (!has_hulls()) GTEST_SKIP() << "built without qhull";
  Index near_total = 0, touching_total = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Random r(seed);
    Model model;
    ContactSearch search;
    search.margin = seed % 2 ? 0.05 : 1e-3;
    std::vector<Shape> in_world;
    std::vector<Index> object;
    VectorX<double> q(7 * 8);
    for (Index i = 0; i < 8; ++i) {
      Body body;
      body.name = std::to_string(i), body.mass = 1, body.com = r.vector(), body.inertia.setIdentity(), body.joint.type = JointType::floating;
      const Pose<double> X{r.rotation(), 1.5 * V3(r.number(0, 1), r.number(0, 1), r.number(0, 1))};
      const Eigen::Quaterniond turn(X.rotation);
      q.segment<7>(7 * i) << X.translation, turn.w(), turn.x(), turn.y(), turn.z();
      for (const Kind kind : {Kind::hull, i % 2 ? Kind::cylinder : Kind::sphere, Kind::box}) {
        Shape s = random_shape(kind, r);
        if (kind == Kind::hull) {
          std::vector<V3> points;
          for (int k = 0; k < 9; ++k) points.push_back(0.3 * r.vector());
          s.size.setZero();
          for (const V3& x : points) s.size = s.size.cwiseMax(x.cwiseAbs());
          s.points = std::make_shared<const std::vector<V3>>(points);
        }
        body.shapes.push_back(s);
        s.placement = X * s.placement;
        in_world.push_back(s), object.push_back(i / 2);
      }
      model.add(body);
      search.object.push_back(i / 2);
    }
    Poses<double> at;
    poses(model, q, at);
    std::vector<std::string> notes, none;
    const auto found = find_contacts(model, at, search, none);
    EXPECT_TRUE(none.empty()) << seed;
    search.hulls = hull_surfaces(Model{});
    EXPECT_LE(find_contacts(model, at, search, notes).size(), found.size()) << seed;
    const auto radius = [](const Shape& s) {
      return s.kind == Kind::sphere ? s.size[0] : s.kind == Kind::cylinder ? std::hypot(s.size[0], s.size[1]) : s.size.norm();
    };
    Index hulls = 0;
    for (std::size_t i = 0; i < in_world.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Shape &a = in_world[i], &b = in_world[j];
        const bool hull = a.kind == Kind::hull || b.kind == Kind::hull;
        if (object[i] == object[j]) continue;
        const double between = (a.placement.translation - b.placement.translation).norm() - radius(a) - radius(b);
        double least = 1e9;
        if (a.kind != Kind::sphere && b.kind != Kind::sphere)
          for (const V3& x : surface_points(a))
            for (const V3& y : surface_points(b)) least = std::min(least, (x - y).norm());
        EXPECT_LE(between, least + 30 * eps * 10) << seed;
        touching_total += least <= search.margin;
        const auto bodies = std::pair(static_cast<Index>(j / 3), static_cast<Index>(i / 3));
        EXPECT_TRUE(least > search.margin || std::any_of(found.begin(), found.end(), [&](const auto& c) { return std::pair(c.body, c.other) == bodies; })) << seed;
        hulls += hull && between <= search.margin;
      }
    EXPECT_EQ(counted(notes), hulls) << seed;
    near_total += hulls;
    for (const ContactPoint& c : found) EXPECT_NE(search.object[static_cast<std::size_t>(c.body)], search.object[static_cast<std::size_t>(c.other)]) << seed;
  }
  EXPECT_GT(near_total, 500);
  EXPECT_GT(touching_total, 5);
}

}  // namespace
}  // namespace delassus::contact_ground_test
