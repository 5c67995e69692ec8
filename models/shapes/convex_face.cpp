#include "models/shapes/convex_face.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace delassus {
namespace {

using V3 = Vector3<double>;

ConvexFace disc_of(const ConvexShape& s, double side) {
  ConvexFace out;
  out.normal = side * s.axis(), out.centre = s.centre + side * s.half * s.axis();
  out.x = s.placement.rotation.col(0), out.disc = s.disc;
  return out;
}

ConvexFace line(const V3& p, const V3& q) { return {{p, q}, {0, 0, 1}, {0, 0, 0}, {1, 0, 0}, 0}; }
ConvexFace point(const V3& p) { return {{p}, {0, 0, 1}, {0, 0, 0}, {1, 0, 0}, 0}; }

/// Where |p + t (q − p) − c| = r, 0 ≤ t ≤ 1, all in one plane.
void on_circle(const V3& p, const V3& q, const V3& c, double r, std::vector<double>& out) {
  const V3 d = q - p;
  const double length = d.norm();
  if (length == 0) return;
  const double middle = d.dot(c - p) / length, half = r * r - (p + middle / length * d - c).squaredNorm();
  if (half < 0) return;
  for (const double side : {-1.0, 1.0}) {
    const double t = (middle + side * std::sqrt(half)) / length;
    if (t >= 0 && t <= 1) out.push_back(t);
  }
}

/// The outlines of two faces seen along the reference's normal n.
class Overlap {
 public:
  Overlap(const ConvexFace& reference, const ConvexFace& face, double same) : r_(reference), f_(face), n_(reference.normal), same_(same) {}

  std::vector<V3> run() {
    for (const V3& x : outline(f_))
      if (inside(r_, x)) take(x);
    if (f_.is_plane())
      for (const V3& x : outline(r_))
        if (const V3 y = lifted(x); inside(f_, y)) take(y);
    crossings();
    return std::move(found_);
  }

 private:
  /// The point of the face's plane over x.
  V3 lifted(const V3& x) const {
    const V3 o = f_.is_disc() ? f_.centre : f_.corners[0];
    return x + f_.normal.dot(o - x) / f_.normal.dot(n_) * n_;
  }

  V3 flat(const V3& x) const { return x - n_.dot(x) * n_; }

  /// Corners; eight points of a rim, the first towards where the two planes come nearest, else towards the other disc's middle,
  /// else along the disc's own axis.
  std::vector<V3> outline(const ConvexFace& of) const {
    if (!of.is_disc()) return of.corners;
    const ConvexFace& other = &of == &r_ ? f_ : r_;
    const auto in_plane = [&](const V3& d) { return V3(d - of.normal.dot(d) * of.normal); };
    V3 x = of.x;
    if (other.is_plane() && in_plane(other.normal).norm() > 1e-6) x = in_plane(-other.normal).normalized();
    else if (other.is_disc() && in_plane(other.centre - of.centre).norm() > 1e-6 * of.disc) x = in_plane(other.centre - of.centre).normalized();
    const V3 y = of.normal.cross(x);
    std::vector<V3> out;
    for (int k = 0; k < 8; ++k) {
      const double c = k % 2 ? M_SQRT1_2 : 1;
      const int s[] = {1, 1, 0, -1, -1, -1, 0, 1};
      out.push_back(of.centre + of.disc * c * (s[k] * x + s[(k + 6) % 8] * y));
    }
    return out;
  }

  /// Seen along n, up to `same`; x on the plane of the disc.
  bool inside(const ConvexFace& of, const V3& x) const {
    if (of.is_disc()) return (&of == &r_ ? flat(x - of.centre) : V3(x - of.centre)).norm() <= of.disc + same_;
    if (of.corners.size() < 3) return false;
    const double turn = of.normal.dot(n_) < 0 ? -1 : 1;  // corners go round the outward normal
    for (std::size_t k = 0; k < of.corners.size(); ++k) {
      const V3 &p = of.corners[k], e = flat(of.corners[(k + 1) % of.corners.size()] - p);
      if (turn * n_.dot(e.cross(x - p)) < -same_ * e.norm()) return false;
    }
    return true;
  }

  template <class F> static void edges(const ConvexFace& of, F&& each) {
    const std::size_t n = of.corners.size();
    for (std::size_t k = 0; k < (n == 2 ? 1 : n == 1 ? 0 : n); ++k) each(of.corners[k], of.corners[(k + 1) % n]);
  }

  void crossings() {
    std::vector<double> t;
    if (!r_.is_disc() && !f_.is_disc()) {
      edges(r_, [&](const V3& p, const V3& q) { edges(f_, [&](const V3& a, const V3& b) { lines_cross(p, q, a, b); }); });
    } else if (r_.is_disc() && f_.is_disc()) {
      circles();
    } else if (r_.is_disc()) {
      edges(f_, [&](const V3& a, const V3& b) {
        t.clear();
        on_circle(flat(a), flat(b), flat(r_.centre), r_.disc, t);
        for (const double s : t) take(a + s * (b - a));
      });
    } else {
      edges(r_, [&](const V3& p, const V3& q) {
        t.clear();
        const V3 a = lifted(p), b = lifted(q);
        on_circle(a, b, f_.centre, f_.disc, t);
        for (const double s : t) take(a + s * (b - a));
      });
    }
  }

  void lines_cross(const V3& p, const V3& q, const V3& a, const V3& b) {
    const V3 u = flat(q - p), v = flat(b - a), d = flat(a - p);
    const double w = n_.dot(u.cross(v));
    if (std::abs(w) <= 1e-9 * u.norm() * v.norm()) return;  // along each other: ends are inside
    const double s = n_.dot(d.cross(v)) / w, t = n_.dot(d.cross(u)) / w;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) take(a + t * (b - a));
  }

  void circles() {
    const V3 d = flat(f_.centre - r_.centre);
    const double D = d.norm(), along = (D * D + r_.disc * r_.disc - f_.disc * f_.disc) / (2 * D), up = r_.disc * r_.disc - along * along;
    if (!(D > same_) || !(up > 0)) return;
    const V3 e = d / D;
    for (const double side : {-1.0, 1.0}) {
      V3 x = lifted(r_.centre + along * e + side * std::sqrt(up) * n_.cross(e)) - f_.centre;
      x = f_.centre + std::min(1.0, f_.disc / x.norm()) * x;  // a tilted disc is narrower as seen along n
      if (inside(r_, x)) take(x);
    }
  }

  /// Of points in one place the deeper one.
  void take(const V3& x) {
    for (V3& y : found_)
      if (flat(x - y).norm() <= same_) {
        if (n_.dot(x - y) < -same_) y = x;
        return;
      }
    found_.push_back(x);
  }

  const ConvexFace &r_, &f_;
  V3 n_;
  double same_;
  std::vector<V3> found_;
};

/// Corners of one plane: meshes are rounded.
constexpr double flatness = 1e-6;

/// In the polytope's order.
std::vector<V3> farthest_corners(const ConvexShape& s, const V3& n) {
  const V3 top = support(s, n);
  std::vector<V3> out;
  for (const V3& x : s.polytope.corners)
    if (n.dot(x - top) >= -flatness * s.size) out.push_back(x);
  return out;
}

}  // namespace

ConvexFace face_across(const ConvexShape& s, const Vector3<double>& n) {
  if (s.is_cylinder()) return disc_of(s, s.axis().dot(n) < 0 ? -1 : 1);
  // Andrew's monotone chain, counter-clockwise about n; the first of the polytope's corners first
  struct Corner {
    double u, v;
    std::size_t place;
  };
  const V3 u = n.unitOrthogonal(), v = n.cross(u);
  const std::vector<V3> far = farthest_corners(s, n);
  std::vector<Corner> all, ring;
  for (const V3& x : far) all.push_back({u.dot(x - far[0]), v.dot(x - far[0]), all.size()});
  std::sort(all.begin(), all.end(), [](const Corner& a, const Corner& b) { return std::pair(a.u, a.v) < std::pair(b.u, b.v); });
  const auto left = [](const Corner& o, const Corner& a, const Corner& b) { return (a.u - o.u) * (b.v - o.v) - (a.v - o.v) * (b.u - o.u) > 0; };
  for (int half = 0; half < 2; ++half) {
    const std::size_t begin = ring.size();
    for (const Corner& x : all) {
      while (ring.size() >= begin + 2 && !left(ring[ring.size() - 2], ring.back(), x)) ring.pop_back();
      ring.push_back(x);
    }
    if (ring.size() > 1) ring.pop_back();
    std::reverse(all.begin(), all.end());
  }
  std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end(), [](const Corner& a, const Corner& b) { return a.place < b.place; }), ring.end());
  ConvexFace out;
  out.normal = n;
  for (const Corner& x : ring) out.corners.push_back(far[x.place]);
  return out;
}

ConvexFace line_along(const ConvexShape& s, const Vector3<double>& n) {
  const V3 top = support(s, n);
  if (s.is_cylinder()) {
    const V3 z = s.axis(), across = s.across(n);
    if (std::abs(n.dot(z)) > 0.1) return point(top);
    const V3 middle = s.centre + s.disc * across.normalized();
    return line(middle - s.half * z, middle + s.half * z);
  }
  const Polytope& p = s.polytope;
  double least = 0.1;
  ConvexFace out = point(top);
  for (const Polytope::Edge& e : p.edges) {
    const V3 &a = p.corners[e.p], &b = p.corners[e.q];
    if (a != top && b != top) continue;
    const double inclined = std::abs(n.dot(b - a)) / (b - a).norm();
    if (inclined < least - 1e-9) least = inclined, out = line(a, b);
  }
  return out;
}

ConvexFace face_along(const ConvexShape& s, const Vector3<double>& n) {
  const V3 z = s.axis();
  if (s.is_cylinder()) {
    if (std::abs(n.dot(z)) >= M_SQRT1_2) return disc_of(s, n.dot(z) < 0 ? -1 : 1);
    const V3 middle = s.centre + s.disc * s.across(n).normalized();
    return line(middle - s.half * z, middle + s.half * z);
  }
  if (s.polytope.corners.size() == 1) return point(s.polytope.corners[0]);
  if (s.polytope.corners.size() == 2) return line(s.polytope.corners[0], s.polytope.corners[1]);
  const std::vector<V3> far = farthest_corners(s, n);
  const V3* best = nullptr;
  for (const V3& m : s.polytope.normals) {
    if (m.dot(n) < 0.1 || (best != nullptr && m.dot(n) <= best->dot(n) + 1e-6)) continue;
    const V3 top = support(s, m);
    if (std::all_of(far.begin(), far.end(), [&](const V3& x) { return m.dot(x - top) >= -flatness * s.size; })) best = &m;
  }
  return best != nullptr ? face_across(s, *best) : line_along(s, n);
}

std::vector<Vector3<double>> overlap(const ConvexFace& reference, const ConvexFace& face, double same) { return Overlap(reference, face, same).run(); }

}  // namespace delassus
