// Laws of contacts between pairs with a cylinder or a hull, against brute force: the separation of two shapes by their support
// functions, largest over directions that are sampled and improved at random; membership by half-spaces.
#include <gtest/gtest.h>

#include "models/shapes/hull.h"
#include "property_tests/unit/shapes/contact_pairs.h"

namespace delassus::convex_contacts_test {
namespace {

using namespace contact_test;

constexpr Kind all_kinds[] = {Kind::sphere, Kind::box, Kind::capsule, Kind::cylinder, Kind::hull};
constexpr double wide = 0.05;  // a margin that reaches shapes clearly apart
constexpr double tie = 1e-9;   // of the size: as much may be lost between directions that are as good (convex_axis.h)

/// Pairs of the kinds that are tested here; without qhull hulls meet the ground alone.
bool convex_pair(Kind a, Kind b) {
  const auto either = [&](Kind k) { return a == k || b == k; };
  return either(Kind::hull) ? has_hulls() : either(Kind::cylinder);
}

/// The largest separation: directions at random, the best of them improved by steps at random that shrink.
double largest_separation(const Shape& a, const Shape& b, const std::vector<V3>& hints, Random& r) {
  std::vector<std::pair<double, V3>> tried;
  const auto s = [&](const V3& n) { return separation(a, b, n); };
  for (int k = 0; k < 2000; ++k) {
    const V3 n = r.unit();
    tried.emplace_back(s(n), n);
  }
  std::partial_sort(tried.begin(), tried.begin() + 12, tried.end(), [](const auto& x, const auto& y) { return x.first > y.first; });
  tried.resize(12);
  for (const V3& n : hints) tried.emplace_back(s(n), n);
  double best = -1e9;
  for (auto [value, n] : tried) {
    double step = 0.2;
    for (int k = 0; k < 1500 && step > 1e-9; ++k) {
      const V3 next = (n + step * r.unit()).normalized();
      if (const double there = s(next); there > value) value = there, n = next;
      else if (k % 12 == 11) step *= 0.7;
    }
    best = std::max(best, value);
  }
  return best;
}

/// How far a point is outside: half-spaces of every three corners that have all others on one side, discs and lengths.
double outside(const Shape& s, const V3& x) {
  const V3 p = s.placement.rotation.transpose() * (x - s.placement.translation);
  if (s.kind == Kind::cylinder) return std::max(std::hypot(p[0], p[1]) - s.size[0], std::abs(p[2]) - s.size[1]);
  if (s.kind != Kind::hull) return distance(s, x);
  double most = -1e9;
  const std::vector<V3>& c = *s.points;
  for (std::size_t i = 0; i < c.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (std::size_t k = 0; k < j; ++k) {
        const V3 n = (c[j] - c[i]).cross(c[k] - c[i]);
        if (n.norm() < 1e-9) continue;
        double low = 0, high = 0;
        for (const V3& y : c) low = std::min(low, n.normalized().dot(y - c[i])), high = std::max(high, n.normalized().dot(y - c[i]));
        if (high < 1e-9) most = std::max(most, n.normalized().dot(p - c[i]));
        if (low > -1e-9) most = std::max(most, -n.normalized().dot(p - c[i]));
      }
  return most;
}

/// Pairs at random: near each other along a direction at random, or well inside; every third with axes that are parallel or across, some
/// with their middles in one place.
void for_each_convex_pair(unsigned count, const std::function<void(const Pair&, Random&, const std::string&)>& law) {
  for (const Kind first : all_kinds)
    for (const Kind second : all_kinds)
      for (unsigned seed = 1; seed <= count; ++seed) {
        if (!convex_pair(first, second)) continue;
        Random r(1000 * static_cast<unsigned>(first) + 100 * static_cast<unsigned>(second) + 7919 * seed);
        Shape a = random_shape(first, r), b = random_shape(second, r);
        if (seed % 3 == 0) {
          const double turns[] = {0, M_PI / 2, r.number(-3, 3)};
          a.placement.rotation = b.placement.rotation * Eigen::AngleAxisd(turns[seed / 3 % 3], V3::Unit(seed / 9 % 3)).toRotationMatrix();
        }
        const V3 n = seed % 6 == 0 ? V3(b.placement.rotation * V3::Unit(seed / 6 % 3)) : r.unit();
        a.placement.translation = b.placement.translation;
        if (seed % 10 != 0) {
          const double gap = seed % 5 == 0 ? -r.number(0.05, 0.3) : r.number(-0.02, 0.04);
          a.placement.translation += (gap - separation(a, b, n)) * n + (seed % 6 == 0 ? 0.0 : 0.05) * r.vector();
        }
        law(pair_of(a, b, r), r, "kinds " + std::to_string(static_cast<int>(first)) + " and " + std::to_string(static_cast<int>(second)) + ", seed " + std::to_string(seed));
        if (testing::Test::HasFailure()) return;
      }
}

Found find_wide(const Pair& p, double reach = wide) {
  ContactSearch search;
  search.margin = reach;
  return find(p, search);
}

/// Up to four points with one unit normal, none twice, each half a gap from points of both shapes; the least gap.
double expect_points_of_the_shapes(const Pair& p, const Found& f, const std::string& what) {
  EXPECT_LE(f.contacts.size(), 4u) << what;
  double least = 1;
  const V3 n = f.contacts[0].normal;
  EXPECT_TRUE(small(n.norm() - 1, 1)) << what;
  for (const ContactPoint& c : f.contacts) {
    EXPECT_EQ(c.normal, n) << what;
    EXPECT_LE(c.gap, wide) << what;
    least = std::min(least, c.gap);
    const double bound = 2e-7 * (p.a.size.norm() + p.b.size.norm());  // what is as near to an outline as that counts as inside
    EXPECT_LE(outside(p.a, c.point + c.gap / 2 * n), bound) << what;
    EXPECT_LE(outside(p.b, c.point - c.gap / 2 * n), bound) << what;
    for (const ContactPoint& d : f.contacts) EXPECT_TRUE(&c == &d || (c.point - d.point).norm() > 1e-8) << what;
  }
  return least;
}

TEST(ConvexContacts, gap_normal_and_points_against_brute_force) {
  int apart = 0, deep = 0, none = 0, manifolds = 0;
  double worst = 0, lost = 0;
  for_each_convex_pair(120, [&](const Pair& p, Random& r, const std::string& what) {
    const Found f = find_wide(p);
    EXPECT_TRUE(f.notes.empty());
    if (f.contacts.empty()) {
      EXPECT_GT(largest_separation(p.a, p.b, {}, r), wide * (1 - 1e-9)) << what;
      ++none;
      return;
    }
    const V3 n = f.contacts[0].normal;
    const double least = expect_points_of_the_shapes(p, f, what);
    const double along = separation(p.a, p.b, n), brute = largest_separation(p.a, p.b, {n}, r), size = p.a.size.norm() + p.b.size.norm();
    worst = std::max(worst, std::abs(along - least) / size), lost = std::max(lost, (brute - along) / size);
    EXPECT_LE(std::abs(along - least), tie * size) << what << ": " << along << ' ' << least << " of " << f.contacts.size();
    EXPECT_LE(brute - along, tie * size) << what << ": " << brute << ' ' << along;
    manifolds += f.contacts.size() > 1, ++(along > 0 ? apart : deep);
  });
  std::printf("apart %d deep %d none %d manifolds %d; gap %.1e lost %.1e\n", apart, deep, none, manifolds, worst, lost);
  EXPECT_TRUE(apart > 100 && deep > 100 && none > 5 && manifolds > 100);
}

// Discs that lean on each other, their outlines cutting.
TEST(ConvexContacts, tilted_discs) {
  int several = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    Random r(seed);
    const Shape b = random_shape(Kind::cylinder, r);
    Shape a = random_shape(Kind::cylinder, r);
    const V3 lean = r.unit(), n = b.placement.rotation.col(2);
    a.placement.rotation = b.placement.rotation * Eigen::AngleAxisd(r.number(0, 0.7), V3(lean[0], lean[1], 0).normalized()).toRotationMatrix();
    a.placement.translation = b.placement.translation + b.placement.rotation * V3(r.number(-0.3, 0.3), r.number(-0.3, 0.3), 0);
    a.placement.translation += (r.number(-0.03, 0.01) - separation(a, b, n)) * n;
    const Pair p = pair_of(a, b, r);
    const Found f = find_wide(p);
    if (f.contacts.empty()) continue;
    const double least = expect_points_of_the_shapes(p, f, std::to_string(seed));
    const double along = separation(a, b, f.contacts[0].normal);
    EXPECT_LE(std::abs(along - least), tie * p.size) << seed;
    EXPECT_LE(largest_separation(a, b, {f.contacts[0].normal}, r) - along, tie * p.size) << seed;
    several += f.contacts.size() > 2;
  }
  EXPECT_GT(several, 50);
}

/// The same contacts, in any order: points moved by `moved`, normals turned to `sign`. Points of tilted faces are worse by the tilt.
void expect_same(const Found& x, const Found& y, const Pose<double>& moved, double sign, const std::string& what, double close = 1e-6) {
  ASSERT_EQ(x.contacts.size(), y.contacts.size()) << what;
  for (const ContactPoint& c : x.contacts) {
    const V3 there = moved * c.point;
    const auto nearest = std::min_element(y.contacts.begin(), y.contacts.end(), [&](const auto& a, const auto& b) { return (a.point - there).norm() < (b.point - there).norm(); });
    EXPECT_LE((nearest->point - there).norm(), close) << what;
    EXPECT_LE(std::abs(nearest->gap - c.gap), close) << what;
    EXPECT_LE((nearest->normal - sign * (moved.rotation * c.normal)).norm(), close) << what;
  }
}

// Poses at random have one answer: it turns with the order of the bodies, and moves with the scene.
TEST(ConvexContacts, swapped_bodies_and_moved_scenes) {
  for (const Kind first : all_kinds)
    for (const Kind second : all_kinds)
      for (unsigned seed = 1; seed <= 40; ++seed) {
        if (!convex_pair(first, second)) continue;
        Random r(31 * seed + 7 * static_cast<unsigned>(first) + static_cast<unsigned>(second));
        Shape a = random_shape(first, r), b = random_shape(second, r);
        const V3 n = r.unit();
        a.placement.translation = b.placement.translation;
        a.placement.translation += (r.number(-0.03, 0.01) - separation(a, b, n)) * n;
        const Pair p = pair_of(a, b, r);
        const std::string what = "kinds " + std::to_string(static_cast<int>(first)) + " and " + std::to_string(static_cast<int>(second)) + ", seed " + std::to_string(seed);
        const Found found = find_wide(p);
        expect_same(found, find_wide(pair_of(b, a, r)), {}, -1, what);
        const Pose<double> X{r.rotation(), 3 * r.vector()};
        a.placement = X * a.placement, b.placement = X * b.placement;
        expect_same(found, find_wide(pair_of(a, b, r)), X, 1, what);
        if (testing::Test::HasFailure()) return;
      }
}

Shape cylinder(double radius, double half, const Pose<double>& at) { return {Kind::cylinder, V3(radius, half, 0), at, -1, {}}; }
Shape box(const V3& half, const Pose<double>& at) { return {Kind::box, half, at, -1, {}}; }
Shape hull(const std::vector<V3>& points, const Pose<double>& at) {
  V3 size(0, 0, 0);
  for (const V3& x : points) size = size.cwiseMax(x.cwiseAbs());
  return {Kind::hull, size, at, -1, std::make_shared<const std::vector<V3>>(points)};
}
Shape box_hull(const V3& half, const Pose<double>& at) {
  std::vector<V3> points;
  for (int k = 0; k < 8; ++k) points.emplace_back(k & 1 ? half[0] : -half[0], k & 2 ? half[1] : -half[1], k & 4 ? half[2] : -half[2]);
  return hull(points, at);
}
Pose<double> at(double x, double y, double z, double angle = 0, const V3& axis = V3::UnitZ()) { return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(), {x, y, z}}; }

struct Rest {
  std::string name;
  Shape above, below;  // along z, in touch
  std::size_t points;
  double across;       // extent of the points, of the widest two
};

std::vector<Rest> rests() {
  const Pose<double> lying = at(0, 0, 0.3, M_PI / 2, V3::UnitY());
  std::vector<V3> prism;
  for (int k = 0; k < 6; ++k)
    for (const double z : {-0.2, 0.2}) prism.emplace_back(0.15 * std::cos(M_PI * k / 3), 0.15 * std::sin(M_PI * k / 3), z);
  const Shape slab = box({0.5, 0.4, 0.1}, at(0, 0, 0));
  return {{"cylinder on a box", cylinder(0.1, 0.2, at(0.1, 0, 0.3)), slab, 4, 0.2},
          {"cylinder on a cylinder", cylinder(0.1, 0.2, at(0, 0, 0.3, 1)), cylinder(0.1, 0.1, at(0, 0, 0)), 4, 0.2},
          {"cylinder on a wider one, off its axis", cylinder(0.1, 0.2, at(0.05, 0.03, 0.3, 1)), cylinder(0.3, 0.1, at(0, 0, 0)), 4, 0.2},
          {"cylinder half off a cylinder", cylinder(0.1, 0.2, at(0.1, 0, 0.3)), cylinder(0.1, 0.1, at(0, 0, 0)), 4, 0.1 * std::sqrt(3)},
          {"cylinder half off a box", cylinder(0.1, 0.2, at(0.5, 0, 0.3)), slab, 4, 0.2},
          {"cylinder lying on a box", cylinder(0.2, 0.3, lying), slab, 2, 0.6},
          {"cylinder lying on a hull", cylinder(0.2, 0.3, lying), box_hull({0.5, 0.4, 0.1}, at(0, 0, 0)), 2, 0.6},
          {"cylinder lying on a parallel one", cylinder(0.2, 0.3, lying), cylinder(0.1, 0.2, at(0, 0, 0, M_PI / 2, V3::UnitY())), 2, 0.4},
          {"cylinder lying across another", cylinder(0.2, 0.3, lying), cylinder(0.1, 0.3, at(0, 0, 0, M_PI / 2, V3::UnitX())), 1, 0},
          {"box on a cylinder", box({0.3, 0.3, 0.1}, at(0.02, 0.01, 0.2, 0.3)), cylinder(0.1, 0.1, at(0, 0, 0)), 4, 0.2},
          {"beam across a cylinder", box({0.5, 0.05, 0.1}, at(0, 0, 0.2)), cylinder(0.1, 0.1, at(0, 0, 0)), 4, 0.2},
          {"prism on a box", hull(prism, at(0.1, 0, 0.3, 0.2)), slab, 4, 0.3},
          {"prism on a cylinder", hull(prism, at(0, 0, 0.3, 0.2)), cylinder(0.3, 0.1, at(0, 0, 0)), 4, 0.3},
          {"prism on itself", hull(prism, at(0, 0, 0.3)), hull(prism, at(0, 0, -0.1)), 4, 0.3},
          {"hull of a box on a box, turned", box_hull({0.2, 0.2, 0.2}, at(0, 0, 0.3, M_PI / 4)), box({0.2, 0.2, 0.1}, at(0, 0, 0)), 4, 0.4 / std::cos(M_PI / 8)},
          {"hull of a box on its like", box_hull({0.2, 0.1, 0.2}, at(0, 0, 0.3)), box_hull({0.2, 0.1, 0.1}, at(0, 0, 0)), 4, std::hypot(0.4, 0.2)},
          {"capsule lying on a cylinder's disc", {Kind::capsule, V3(0.2, 0.3, 0), lying, -1, {}}, cylinder(0.1, 0.1, at(0, 0, 0)), 2, 0.2},
          {"capsule lying on a hull", {Kind::capsule, V3(0.2, 0.3, 0), lying, -1, {}}, box_hull({0.5, 0.4, 0.1}, at(0, 0, 0)), 2, 0.6},
          {"capsule lying along a cylinder", {Kind::capsule, V3(0.2, 0.3, 0), lying, -1, {}}, cylinder(0.1, 0.2, at(0, 0, 0, M_PI / 2, V3::UnitY())), 2, 0.4},
          {"hull on its edge on a box", box_hull({0.2, 0.1, 0.1}, at(0, 0, 0.1 + 0.1 * M_SQRT2, M_PI / 4, V3::UnitX())), slab, 2, 0.4},
          {"plate on its edge on a cylinder", hull({V3(0.1, 0, 0.2), V3(-0.1, 0, 0.2), V3(0.1, 0, -0.2), V3(-0.1, 0, -0.2)}, at(0, 0, 0.3)), cylinder(0.3, 0.1, at(0, 0, 0)), 2, 0.2},
          {"sphere on a cylinder", {Kind::sphere, V3(0.2, 0, 0), at(0.05, 0, 0.3), -1, {}}, cylinder(0.1, 0.1, at(0, 0, 0)), 1, 0},
          {"sphere on a hull", {Kind::sphere, V3(0.2, 0, 0), at(0.05, 0, 0.3), -1, {}}, box_hull({0.5, 0.4, 0.1}, at(0, 0, 0)), 1, 0}};
}

// What rests has the points one expects, straight down, and keeps them, each where it was, when it is turned and moved by rounding, and
// when all of it is.
TEST(ConvexContacts, resting_pairs_keep_their_points) {
  for (const Rest& rest : rests()) {
    if (!has_hulls() && (rest.above.kind == Kind::hull || rest.below.kind == Kind::hull)) continue;
    Random r(5);
    const Found calm = find(pair_of(rest.above, rest.below, r));
    EXPECT_EQ(calm.contacts.size(), rest.points) << rest.name;
    double across = 0;
    for (const ContactPoint& c : calm.contacts) {
      EXPECT_LE((c.normal - V3::UnitZ()).norm(), 1e-14) << rest.name;
      EXPECT_LE(std::abs(c.gap), 1e-14) << rest.name;
      EXPECT_LE(std::abs(c.point[2] - 0.1), 1e-14) << rest.name;
      for (const ContactPoint& d : calm.contacts) across = std::max(across, (c.point - d.point).norm());
    }
    EXPECT_NEAR(across, rest.across, 1e-12) << rest.name;
    for (int k = 0; k < 60; ++k) {
      const double by = k % 2 ? 1e-15 : 1e-12;
      Shape above = rest.above, below = rest.below;
      for (Shape* s : {&above, &below}) {
        s->placement.translation += by * r.vector();
        s->placement.rotation = Eigen::AngleAxisd(by, r.unit()).toRotationMatrix() * s->placement.rotation;
      }
      const Pose<double> X = k % 3 == 0 ? Pose<double>{r.rotation(), 2 * r.vector()} : Pose<double>{};
      above.placement = X * above.placement, below.placement = X * below.placement;
      const Found shaken = find(pair_of(above, below, r));
      ASSERT_EQ(shaken.contacts.size(), calm.contacts.size()) << rest.name << ", " << k;
      for (std::size_t i = 0; i < calm.contacts.size(); ++i)
        EXPECT_LE((shaken.contacts[i].point - X * calm.contacts[i].point).norm(), 1e-9) << rest.name << ", " << k << ", point " << i;
      // the other order: the same number, as deep; which points of a round face is its own choice
      const Found swapped = find(pair_of(below, above, r));
      ASSERT_EQ(swapped.contacts.size(), calm.contacts.size()) << rest.name << ", " << k;
      for (const ContactPoint& c : swapped.contacts) EXPECT_LE((c.normal + X.rotation.col(2)).norm() + std::abs(c.gap), 1e-9) << rest.name;
    }
  }
}

// The hull of a box's corners is that box: against the routines for boxes, which share nothing with it.
TEST(ConvexContacts, a_hull_of_a_box_is_a_box) {
  if (!has_hulls()) GTEST_SKIP() << "built without qhull";
  int several = 0;
  for (const Kind second : {Kind::sphere, Kind::box, Kind::capsule})
    for (unsigned seed = 1; seed <= 60; ++seed) {
      Random r(seed);
      const Shape b = random_shape(second, r);
      Shape a = random_shape(Kind::box, r);
      const bool aligned = seed % 4 == 0;
      if (aligned) a.placement.rotation = b.placement.rotation * Eigen::AngleAxisd(r.number(0.2, 0.6), V3::Unit(seed / 4 % 3)).toRotationMatrix();
      a = brought_to(a, b, aligned ? V3(b.placement.rotation.col(seed / 4 % 3)) : r.unit(), seed % 2 ? -1e-3 : 5e-4);
      const Shape same = box_hull(a.size, a.placement);
      const Found x = find(pair_of(a, b, r)), y = find(pair_of(same, b, r));
      const auto least = [](const Found& f) {
        double out = 1;
        for (const ContactPoint& c : f.contacts) out = std::min(out, c.gap);
        return out;
      };
      const std::string what = "kind " + std::to_string(static_cast<int>(second)) + ", seed " + std::to_string(seed);
      if (x.contacts.empty() && second == Kind::box) continue;  // box_box looks along fifteen axes only
      EXPECT_NEAR(least(x), gap_of(a, b), 1e-12) << what;
      EXPECT_NEAR(least(y), gap_of(a, b), 1e-9) << what;
      if (second == Kind::sphere) expect_same(x, y, {}, 1, what, 1e-9);
      several += y.contacts.size() > 1;
    }
  EXPECT_GT(several, 5);
}

}  // namespace
}  // namespace delassus::convex_contacts_test
