#include "models/shapes/convex_axis.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "models/shapes/closest_points.h"
#include "models/shapes/rim_axis.h"

namespace delassus {
namespace {

using V3 = Vector3<double>;
using Of = ConvexAxis::Of;

class Search {
 public:
  Search(const ConvexShape& a, const ConvexShape& b, double limit) : a_(a), b_(b), limit_(limit), tie_(1e-9 * (a.size + b.size)), rounding_(1e-12 * (a.size + b.size)) {}

  std::optional<ConvexAxis> run() {
    const V3 d = a_.centre - b_.centre;
    if (d.norm() > 0 && separation(a_, b_, d.normalized()) > limit_) return std::nullopt;
    faces(a_, Of::face_of_a), faces(b_, Of::face_of_b);
    for (const ConvexAxis& f : faces_) best_ = std::max(best_, f.separation);
    if (best_ > limit_) return std::nullopt;
    if (a_.is_cylinder() && b_.is_cylinder())
      for (const V3& n : cylinder_axes(a_, b_)) other(n);
    else if (a_.is_cylinder()) with_cylinder(a_, b_.polytope, 1);
    else if (b_.is_cylinder()) with_cylinder(b_, a_.polytope, -1);
    else two_polytopes();
    if (best() > limit_) return std::nullopt;
    return chosen();
  }

 private:
  void faces(const ConvexShape& s, Of of) {
    const double sign = of == Of::face_of_a ? -1 : 1;
    auto take = [&](const V3& n) { faces_.push_back({n, separation(a_, b_, n), of}); };
    for (const V3& n : s.polytope.normals) take(sign * n);
    if (s.is_cylinder())
      for (const double side : {1.0, -1.0}) take(side * s.axis());
  }

  double best() const { return std::max(best_, other_.separation); }

  /// The first of those that no other one beats by a tie.
  void other(const V3& n) {
    const double s = separation(a_, b_, n);
    if (s > other_.separation + (any_ ? rounding_ : 0)) other_ = {n, s, Of::other}, any_ = true;
  }

  ConvexAxis chosen() const {
    const auto first = std::find_if(faces_.begin(), faces_.end(), [&](const ConvexAxis& f) { return f.separation >= best_ - tie_; });
    return first == faces_.end() || other_.separation > best_ + rounding_ ? other_ : *first;
  }

  void two_polytopes() {
    const auto on = [](const Polytope::Edge& e, const V3& n) { return e.any || (n.dot(e.in) >= 0 && n.dot(e.out) >= 0); };
    const auto vector = [](const Polytope& p, const Polytope::Edge& e) { return V3(p.corners[e.q] - p.corners[e.p]); };
    for (const Polytope::Edge& e : a_.polytope.edges)
      for (const Polytope::Edge& f : b_.polytope.edges) {
        const V3 u = vector(a_.polytope, e), v = vector(b_.polytope, f), n = u.cross(v);
        for (const double sign : {1.0, -1.0})
          if (on(e, -sign * n) && on(f, sign * n) && n.squaredNorm() > 1e-12 * u.squaredNorm() * v.squaredNorm()) {
            const V3 unit = sign * n.normalized();
            if (unit.dot(a_.polytope.corners[e.p] - b_.polytope.corners[f.p]) > best() - rounding_) other(unit);
          }
      }
    if (faces_.empty() && !any_) other(perpendicular());
    if (a_.polytope.normals.size() > 2 && b_.polytope.normals.size() > 2 && best() < tie_) return;  // solids that are not apart
    if (const auto v = closest_points(a_, b_, tie_)) other(v->normalized());
  }

  /// Of points and segments that meet: any direction across them.
  V3 perpendicular() const {
    for (const ConvexShape* s : {&a_, &b_})
      if (s->polytope.corners.size() == 2) return V3(s->polytope.corners[1] - s->polytope.corners[0]).unitOrthogonal();
    return V3::UnitZ();
  }

  /// `sign` is 1 where the cylinder is a: directions from the polytope to the cylinder are those from b to a.
  void with_cylinder(const ConvexShape& c, const Polytope& p, double sign) {
    const V3 z = c.axis();
    for (const V3& x : p.corners) {
      const V3 d = x - c.centre, across = c.across(d);
      const double r = across.norm(), beyond = std::abs(d.dot(z)) - c.half;
      if (r > 0) other(-sign * across / r);
      else other(-sign * c.placement.rotation.col(0));
      if (r > c.disc && beyond > 0) other(-sign * ((r - c.disc) / r * across + std::copysign(beyond, d.dot(z)) * z).normalized());
    }
    for (const Polytope::Edge& e : p.edges)
      for (const V3& n : arc_axes(c, p.corners[e.p], {-e.from, (-e.in).normalized(), e.angle})) other(-sign * n);
  }

  const ConvexShape &a_, &b_;
  double limit_, tie_, rounding_, best_ = -std::numeric_limits<double>::infinity();
  std::vector<ConvexAxis> faces_;
  ConvexAxis other_{V3::UnitZ(), -std::numeric_limits<double>::infinity(), Of::other};
  bool any_ = false;
};

}  // namespace

double separation(const ConvexShape& a, const ConvexShape& b, const Vector3<double>& n) { return n.dot(support(a, -n) - support(b, n)); }

std::optional<ConvexAxis> convex_axis(const ConvexShape& a, const ConvexShape& b, double limit) { return Search(a, b, limit).run(); }

}  // namespace delassus
