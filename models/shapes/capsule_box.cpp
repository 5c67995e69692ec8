#include "models/shapes/capsule_box.h"

#include <algorithm>
#include <cmath>

namespace delassus {
namespace {

using V3 = Vector3<double>;

/// The axis x(s) = p + s u, s in [−1, 1], in the box's frame.
struct SegmentInBox {
  V3 p, u, half;
  V3 at(double s) const { return p + s * u; }
};

/// s where the axis crosses the planes x_i = ±half_i, ascending, the ends first and last.
std::vector<double> crossings(const SegmentInBox& a) {
  std::vector<double> out{-1, 1};
  for (Index i = 0; i < 3; ++i)
    for (const double side : {-1.0, 1.0}) {
      const double s = (side * a.half[i] - a.p[i]) / a.u[i];
      if (std::abs(s) < 1) out.push_back(s);  // false for a parallel axis
    }
  std::sort(out.begin(), out.end());
  return out;
}

/// Outside: between two crossings the squared distance is Σ (±x_i − half_i)² over the coordinates beyond their faces, a parabola.
void least_outside(const SegmentInBox& a, const std::vector<double>& crossings, std::vector<double>& out) {
  for (std::size_t k = 0; k + 1 < crossings.size(); ++k) {
    const V3 middle = a.at((crossings[k] + crossings[k + 1]) / 2);
    double slope = 0, curvature = 0;
    for (Index i = 0; i < 3; ++i) {
      if (std::abs(middle[i]) <= a.half[i]) continue;
      slope += a.u[i] * (a.p[i] - std::copysign(a.half[i], middle[i]));
      curvature += a.u[i] * a.u[i];
    }
    if (curvature > 0) out.push_back(std::clamp(-slope / curvature, crossings[k], crossings[k + 1]));
  }
}

/// Inside: the signed distance is the largest of ±x_i − half_i, linear each; it is least where two of them are equal.
void least_inside(const SegmentInBox& a, std::vector<double>& out) {
  for (Index i = 0; i < 3; ++i)
    for (Index j = i; j < 3; ++j)
      for (const double side : {-1.0, 1.0}) {
        if (i == j && side < 0) continue;
        // x_i − half_i = side x_j − half_j, and its mirror image; for i = j: x_i = 0
        for (const double sign : {-1.0, 1.0}) {
          const double rise = i == j ? a.u[i] : a.u[i] - side * a.u[j];
          const double offset = i == j ? a.p[i] : a.p[i] - side * a.p[j] - sign * (a.half[i] - a.half[j]);
          if (std::abs(offset) < std::abs(rise)) out.push_back(-offset / rise);
        }
      }
}

}  // namespace

std::vector<ShapeContact> capsule_box(const Vector3<double>& centre, const Vector3<double>& half_axis, double radius, const PlacedBox& box, double margin) {
  const Pose<double> to_box = box.placement.inverse();
  const SegmentInBox axis{to_box * centre, to_box.rotation * half_axis, box.half};
  struct Candidate {
    double s;
    bool outermost;  // an end or a crossing
    ShapeContact contact;
  };
  std::vector<Candidate> candidates;
  const auto take = [&](const std::vector<double>& of, bool outermost) {
    for (const double s : of) candidates.push_back({s, outermost, sphere_box(centre + s * half_axis, radius, box)});
  };
  const std::vector<double> outermost = crossings(axis);
  std::vector<double> inner;
  least_outside(axis, outermost, inner);
  least_inside(axis, inner);
  take(outermost, true);
  take(inner, false);
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) { return a.s < b.s; });
  double least = candidates[0].contact.gap;
  for (const Candidate& c : candidates) least = std::min(least, c.contact.gap);
  if (least > margin) return {};

  // What differs by less than a millionth of the axis is the same place and the same depth: rounding decides nothing.
  const double same = 1e-6, deepest = least + same * half_axis.norm();
  std::vector<const Candidate*> kept;
  const auto keep_ends = [&](const auto& takes) {
    const auto first = std::find_if(candidates.begin(), candidates.end(), takes);
    const auto last = std::find_if(candidates.rbegin(), candidates.rend(), takes);
    if (first != candidates.end()) kept.insert(kept.end(), {&*first, &*last});
  };
  keep_ends([&](const Candidate& c) { return c.outermost && c.contact.gap <= margin; });
  if (std::none_of(kept.begin(), kept.end(), [&](const Candidate* c) { return c->contact.gap <= deepest; }))
    keep_ends([&](const Candidate& c) { return c.contact.gap <= deepest; });
  std::sort(kept.begin(), kept.end(), [](const Candidate* a, const Candidate* b) { return a->s < b->s; });
  std::vector<ShapeContact> out;
  double before = -2;
  for (const Candidate* c : kept) {
    if (c->s - before > same) out.push_back(c->contact);
    before = c->s;
  }
  return out;
}

}  // namespace delassus
