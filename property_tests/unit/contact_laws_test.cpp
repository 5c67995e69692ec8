// Laws of the contact search on random pairs of shapes a little apart or a little into each other, and of shapes on the
// ground. Independent here: supports and signed distances of the shapes, separating directions by brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "models/box_contacts.h"
#include "models/contacts.h"
#include "property_tests/unit/path_sums.h"

namespace delassus {
namespace {

using V3 = Vector3<double>;
using Kind = Shape::Kind;
using unit::Random;

constexpr double eps = 0x1p-53, margin = 1e-3;
constexpr unsigned pairs = 60;

Shape random_shape(Kind kind, Random& r) {
  Shape s;
  s.kind = kind;
  const V3 size(r.number(0.1, 0.2), r.number(0.3, 0.4), r.number(0.5, 0.6));
  s.size = kind == Kind::box ? size : kind == Kind::sphere ? V3(size[0], 0, 0) : V3(size[0], size[1], 0);
  s.placement = {r.rotation(), r.vector()};
  return s;
}

/// max n·x over the shape.
double support(const Shape& s, const V3& n) {
  const V3 local = s.placement.rotation.transpose() * n;
  const double along = n.dot(s.placement.translation);
  switch (s.kind) {
    case Kind::sphere: return along + s.size[0] * n.norm();
    case Kind::capsule: return along + s.size[0] * n.norm() + s.size[1] * std::abs(local[2]);
    case Kind::cylinder: return along + s.size[0] * std::hypot(local[0], local[1]) + s.size[1] * std::abs(local[2]);
    default: return along + s.size.dot(local.cwiseAbs());
  }
}

/// Signed distance of a point from the surface, negative inside.
double distance(const Shape& s, const V3& x) {
  const V3 p = (s.placement.rotation.transpose() * (x - s.placement.translation)).cwiseAbs();
  if (s.kind == Kind::box) return (p - s.size).cwiseMax(0).norm() + std::min((p - s.size).maxCoeff(), 0.0);
  const double along = s.kind == Kind::capsule ? std::max(p[2] - s.size[1], 0.0) : p[2];
  return std::hypot(p[0], p[1], along) - s.size[0];
}

double separation(const Shape& a, const Shape& b, const V3& n) { return -support(a, -n) - support(b, n); }

/// Least distance of two segments p ± u, q ± v: inside both, or with an end of one of them.
double segments(const V3& p, const V3& u, const V3& q, const V3& v) {
  auto to = [](const V3& x, const V3& c, const V3& w) {
    const double t = w.squaredNorm() > 0 ? std::clamp((x - c).dot(w) / w.squaredNorm(), -1.0, 1.0) : 0;
    return (x - c - t * w).norm();
  };
  double least = std::min({to(p + u, q, v), to(p - u, q, v), to(q + v, p, u), to(q - v, p, u)});
  const V3 n = u.cross(v);
  if (n.norm() == 0) return least;
  Matrix3<double> system;
  system << u, -v, n;
  const V3 x = system.inverse() * (q - p);
  return std::abs(x[0]) <= 1 && std::abs(x[1]) <= 1 ? std::min(least, std::abs(x[2]) * n.norm()) : least;
}

/// The gap of a pair: largest separation over the fifteen axes of boxes, distances of axes and centres for round shapes.
double gap_of(const Shape& a, const Shape& b) {
  const bool boxes[] = {a.kind == Kind::box, b.kind == Kind::box};
  const auto axis = [](const Shape& s) { return s.kind == Kind::capsule ? V3(s.size[1] * s.placement.rotation.col(2)) : V3(0, 0, 0); };
  if (!boxes[0] && !boxes[1]) return segments(a.placement.translation, axis(a), b.placement.translation, axis(b)) - a.size[0] - b.size[0];
  if (!boxes[0] || !boxes[1]) {
    const Shape &box = boxes[0] ? a : b, &round = boxes[0] ? b : a;
    return std::min(distance(box, round.placement.translation + axis(round)), distance(box, round.placement.translation - axis(round))) - round.size[0];
  }
  double largest = -1e9;
  const auto consider = [&](const V3& n) {
    if (n.norm() > 1e-3) largest = std::max({largest, separation(a, b, n.normalized()), separation(a, b, -n.normalized())});
  };
  for (Index i = 0; i < 3; ++i) {
    consider(a.placement.rotation.col(i)), consider(b.placement.rotation.col(i));
    for (Index j = 0; j < 3; ++j) consider(a.placement.rotation.col(i).cross(b.placement.rotation.col(j)));
  }
  return largest;
}

/// Two bodies, each with one shape off its frame; body i is object i.
struct Pair {
  Model model;
  VectorX<double> q;
  Shape a, b;
  double size = 0;    // lengths that enter a place
  double spread = 1;  // least sine between edges that are not parallel: points where edges cross are worse by its square
};

Pair pair_of(const Shape& a, const Shape& b, Random& r) {
  Pair p{{}, VectorX<double>::Zero(14), a, b};
  for (const Shape* s : {&a, &b}) {
    Body body;
    body.name = s == &a ? "a" : "b";
    body.mass = 1, body.com = r.vector(), body.inertia.setIdentity();
    body.joint.type = JointType::floating;
    body.shapes = {*s};
    body.shapes[0].placement = {r.rotation(), r.vector()};
    const Pose<double> X = s->placement * body.shapes[0].placement.inverse();
    const Eigen::Quaterniond turn(X.rotation);
    p.q.segment<7>(7 * static_cast<Index>(p.model.bodies.size())) << X.translation, turn.w(), turn.x(), turn.y(), turn.z();
    p.size += 2 + X.translation.norm() + body.com.norm() + s->placement.translation.norm() + s->size.norm();
    p.model.add(body);
  }
  for (Index i = 0; i < 3; ++i)
    for (Index j = 0; j < 3; ++j) {
      const double sine = a.placement.rotation.col(i).cross(b.placement.rotation.col(j)).norm();
      if (sine > 1e-3) p.spread = std::min(p.spread, sine);
    }
  return p;
}

struct Found {
  std::vector<ContactPoint> contacts;  // points in the world
  std::vector<std::string> notes;
};

Found find(const Pair& p, ContactSearch search = {}) {
  Poses<double> at;
  poses(p.model, p.q, at);
  search.object = {0, 1};
  if (search.margin == ContactSearch{}.margin) search.margin = margin;
  Found out;
  out.contacts = find_contacts(p.model, at, search, out.notes);
  for (ContactPoint& c : out.contacts) c.point += at.reference[static_cast<std::size_t>(c.body)];
  return out;
}

Shape shifted(Shape s, const V3& by) {
  s.placement.translation += by;
  return s;
}

/// a against b at this gap along a random direction.
Shape brought_to(const Shape& a, const Shape& b, const V3& direction, double gap) {
  const Shape centred = shifted(a, b.placement.translation - a.placement.translation);
  double high = 5;
  while (high > 0 && gap_of(shifted(centred, high * direction), b) > gap) high -= 0.01;  // a capsule may stick out on both sides
  double low = high;
  high += 0.01;
  for (int k = 0; k < 80; ++k) {
    const double middle = (low + high) / 2;
    (gap_of(shifted(centred, middle * direction), b) < gap ? low : high) = middle;
  }
  return shifted(centred, high * direction);
}

constexpr Kind kinds[] = {Kind::sphere, Kind::box, Kind::capsule};

void for_each_pair(const std::function<void(const Pair&, double gap, Random&, const std::string& what)>& law) {
  for (const Kind first : kinds)
    for (const Kind second : kinds)
      for (unsigned seed = 1; seed <= pairs; ++seed) {
        Random r(seed);
        const Shape b = random_shape(second, r);
        Shape a = random_shape(first, r);
        if (seed % 4 == 0) {  // faces and axes that rest on each other
          a.placement.rotation = b.placement.rotation * Eigen::AngleAxisd(r.number(0.2, 0.6), V3::Unit(seed / 4 % 3)).toRotationMatrix();
        }
        const double gap = seed % 3 == 0 ? r.number(0.1, 0.9) * margin : -r.number(0.1, 2) * margin;
        const bool capsule_on_box = (first == Kind::capsule && second == Kind::box) || (first == Kind::box && second == Kind::capsule);
        const V3 along = (first == Kind::capsule ? a : b).placement.rotation.col(2);  // so that an end gets there
        const V3 direction = capsule_on_box ? V3((along + 0.3 * r.vector()).normalized()) : seed % 4 == 0 ? V3(b.placement.rotation * (V3::Unit(seed / 4 % 3) + 0.2 * r.vector()).normalized()) : r.unit();
        law(pair_of(brought_to(a, b, direction, gap), b, r), gap, r,
            "kinds " + std::to_string(static_cast<int>(first)) + " and " + std::to_string(static_cast<int>(second)) + ", seed " + std::to_string(seed));
        if (testing::Test::HasFailure()) return;
      }
}

bool small(double error, double bound) { return unit::ratio(error, bound) < 30; }

// The gap is the pair's; the two points half a gap from the contact point are on the surfaces; between supports along the
// normal lies nothing (two ends of a capsule on a box are two contacts; the deeper one decides).
TEST(ContactLaws, gap_normal_and_point_are_those_of_the_surfaces) {
  int manifolds = 0, missed = 0;
  for_each_pair([&](const Pair& p, double gap, Random& r, const std::string& what) {
    const Found f = find(p);
    EXPECT_TRUE(f.notes.empty());
    const bool box_box = p.a.kind == Kind::box && p.b.kind == Kind::box, box = p.a.kind == Kind::box || p.b.kind == Kind::box;
    const bool capsule_box = box && !box_box && (p.a.kind == Kind::capsule || p.b.kind == Kind::capsule);
    if (f.contacts.empty() && box_box && gap > 0) {  // corners that are farther apart than any of the fifteen axes tells
      ++missed;
      return;
    }
    ASSERT_FALSE(f.contacts.empty()) << what;
    ASSERT_LE(f.contacts.size(), 4u) << what;
    double least = 1;
    for (const ContactPoint& c : f.contacts) {
      EXPECT_EQ(c.body, 0) << what;
      EXPECT_EQ(c.other, 1) << what;
      least = std::min(least, c.gap);
      EXPECT_TRUE(small(c.normal.norm() - 1, 1)) << what;
      EXPECT_LE(c.gap, margin) << what;
      const V3 on_a = c.point + c.gap / 2 * c.normal, on_b = c.point - c.gap / 2 * c.normal;
      if (!capsule_box) {
        EXPECT_TRUE(small(distance(p.a, on_a), p.size)) << what << ": " << distance(p.a, on_a);
        EXPECT_TRUE(small(distance(p.b, on_b), p.size)) << what << ": " << distance(p.b, on_b);
      }
    }
    EXPECT_TRUE(small(least - gap, p.size)) << what << ": " << least << " is not " << gap;
    const ContactPoint& deepest = *std::min_element(f.contacts.begin(), f.contacts.end(), [](const auto& x, const auto& y) { return x.gap < y.gap; });
    if (!capsule_box) {
      EXPECT_TRUE(small(separation(p.a, p.b, deepest.normal) - gap, p.size)) << what << ": " << separation(p.a, p.b, deepest.normal) - gap;
      for (int k = 0; k < 200 && (!box_box || gap < 0); ++k)
        EXPECT_LE(separation(p.a, p.b, r.unit()), gap + 30 * eps * p.size) << what;
    }
    manifolds += f.contacts.size() > 1;
  });
  EXPECT_GT(manifolds, 10);
  EXPECT_LE(missed, 3);
}

/// The same contacts, whatever their order: points moved by `by`, gaps less `h`, normals turned to ±.
void expect_same(const std::vector<ContactPoint>& x, const std::vector<ContactPoint>& y, const Pose<double>& moved, double sign, double h, const Pair& p, const std::string& what) {
  ASSERT_EQ(x.size(), y.size()) << what;
  const double bound = p.size / (p.spread * p.spread);
  for (const ContactPoint& c : x) {
    const V3 there = moved * V3(c.point + h / 2 * c.normal);
    const auto nearest = std::min_element(y.begin(), y.end(), [&](const auto& a, const auto& b) { return (a.point - there).norm() < (b.point - there).norm(); });
    EXPECT_TRUE(small((nearest->point - there).norm(), bound)) << what << ": " << (nearest->point - there).norm();
    EXPECT_TRUE(small(nearest->gap - (c.gap + h), p.size)) << what << ": " << nearest->gap - (c.gap + h);
    EXPECT_TRUE(small((nearest->normal - sign * (moved.rotation * c.normal)).norm(), bound)) << what;
  }
}

TEST(ContactLaws, the_order_of_bodies_turns_the_normal_only) {
  for_each_pair([](const Pair& p, double, Random& r, const std::string& what) {
    const Pair turned = pair_of(p.b, p.a, r);
    expect_same(find(p).contacts, find(turned).contacts, {}, -1, 0, p, what);
  });
}

TEST(ContactLaws, a_body_moved_along_the_normal_adds_to_the_gap) {
  for_each_pair([](const Pair& p, double, Random& r, const std::string& what) {
    const Found before = find(p);
    if (before.contacts.empty()) return;
    const double h = -1e-6;
    // Round ends on a box need not share a normal.
    const V3 n = before.contacts[0].normal;
    if (std::any_of(before.contacts.begin(), before.contacts.end(), [&](const auto& c) { return (c.normal - n).norm() > 1e-9; })) return;
    expect_same(before.contacts, find(pair_of(shifted(p.a, h * n), p.b, r)).contacts, {}, 1, h, p, what);
  });
}

TEST(ContactLaws, contacts_move_with_the_scene) {
  for_each_pair([](const Pair& p, double, Random& r, const std::string& what) {
    const Pose<double> X{r.rotation(), 3 * r.vector()};
    Shape a = p.a, b = p.b;
    a.placement = X * a.placement, b.placement = X * b.placement;
    Pair moved = pair_of(a, b, r);
    moved.size += p.size, moved.spread = p.spread;
    expect_same(find(p).contacts, find(moved).contacts, X, 1, 0, moved, what);
  });
}

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

}  // namespace
}  // namespace delassus
