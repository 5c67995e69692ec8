#include "models/capsule_box.h"

#include <algorithm>
#include <cmath>

namespace delassus {
namespace {

using V3 = Vector3<double>;

/// The axis x(s) = p + s u, s in [−1, 1], in the box's frame.
struct Axis {
  V3 p, u, half;
  V3 at(double s) const { return p + s * u; }
};

/// s where the axis crosses the planes x_i = ±half_i, ascending, the ends first and last.
std::vector<double> crossings(const Axis& a) {
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
void least_outside(const Axis& a, const std::vector<double>& crossings, std::vector<double>& out) {
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
void least_inside(const Axis& a, std::vector<double>& out) {
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
  const Axis axis{to_box * centre, to_box.rotation * half_axis, box.half};
  const auto contact = [&](double s) { return sphere_box(centre + s * half_axis, radius, box); };

  const std::vector<double> outermost = crossings(axis);
  std::vector<double> candidates = outermost;
  least_outside(axis, outermost, candidates);
  least_inside(axis, candidates);
  std::sort(candidates.begin(), candidates.end());
  double least = contact(0).gap;
  for (const double s : candidates) least = std::min(least, contact(s).gap);

  // What differs by less than a millionth of the axis is the same place and the same depth: rounding decides nothing.
  const double same = 1e-6, lead = same * half_axis.norm();
  const auto ends_of = [&](const std::vector<double>& of, double gap) -> std::vector<double> {
    const auto near = [&](double s) { return contact(s).gap <= gap; };
    const auto first = std::find_if(of.begin(), of.end(), near);
    const auto last = std::find_if(of.rbegin(), of.rend(), near);
    return first == of.end() ? std::vector<double>{} : std::vector<double>{*first, *last};
  };
  if (least > margin) return {};
  std::vector<double> kept = ends_of(outermost, margin);
  const bool deeper = std::none_of(kept.begin(), kept.end(), [&](double s) { return contact(s).gap <= least + lead; });
  if (deeper)
    for (const double s : ends_of(candidates, least + lead)) kept.push_back(s);
  std::sort(kept.begin(), kept.end());
  std::vector<ShapeContact> out;
  double before = -2;
  for (const double s : kept) {
    if (s - before > same) out.push_back(contact(s));
    before = s;
  }
  return out;
}

}  // namespace delassus
