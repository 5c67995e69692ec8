// Laws of the contact search on random pairs of shapes a little apart or a little into each other.
#include <gtest/gtest.h>

#include "property_tests/unit/shapes/contact_pairs.h"

namespace delassus::contact_laws_test {
namespace {

using namespace contact_test;

// The gap is the pair's; the two points half a gap from the contact point are on the surfaces; between supports along the
// normal lies nothing (of several contacts of a capsule and a box the deepest decides).
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
      if (!capsule_box || c.gap <= gap) {
        EXPECT_TRUE(small(distance(p.a, on_a), p.size)) << what << ": " << distance(p.a, on_a);
        EXPECT_TRUE(small(distance(p.b, on_b), p.size)) << what << ": " << distance(p.b, on_b);
      }
    }
    EXPECT_TRUE(small(least - gap, p.size)) << what << ": " << least << " is not " << gap;
    const ContactPoint& deepest = *std::min_element(f.contacts.begin(), f.contacts.end(), [](const auto& x, const auto& y) { return x.gap < y.gap; });
    EXPECT_TRUE(small(separation(p.a, p.b, deepest.normal) - gap, p.size)) << what << ": " << separation(p.a, p.b, deepest.normal) - gap;
    for (int k = 0; k < 200 && (!box_box || gap < 0); ++k)
      EXPECT_LE(separation(p.a, p.b, r.unit()), gap + 30 * eps * p.size) << what;
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

}  // namespace
}  // namespace delassus::contact_laws_test
