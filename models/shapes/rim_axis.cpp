#include "models/shapes/rim_axis.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "models/shapes/convex_axis.h"

namespace delassus {
namespace {

using V3 = Vector3<double>;

/// Rim tangent's part in the Hessian of −h_C at n.
Matrix3<double> bending(const ConvexShape& c, const V3& n) {
  const V3 t = c.axis().cross(n);  // ‖t‖ = ‖n_⊥‖
  const double length = t.norm();
  return length > 0 ? Matrix3<double>(c.disc / (length * length * length) * t * t.transpose()) : Matrix3<double>(Matrix3<double>::Zero());
}

V3 climb(const ConvexShape& a, const ConvexShape& b, V3 n) {
  double s = separation(a, b, n);
  for (int step = 0; step < 60; ++step) {
    const V3 w = support(a, -n) - support(b, n), g = w - w.dot(n) * n;
    const V3 x = n.unitOrthogonal(), y = n.cross(x);
    const Matrix3<double> H = -bending(a, n) - bending(b, n) - s * Matrix3<double>::Identity();
    const double xx = x.dot(H * x), xy = x.dot(H * y), yy = y.dot(H * y), det = xx * yy - xy * xy, gx = g.dot(x), gy = g.dot(y);
    V3 move = xx < 0 && det > 0 ? V3((-yy * gx + xy * gy) / det * x + (xy * gx - xx * gy) / det * y) : V3(g / (a.size + b.size));
    if (move.norm() > 0.2) move *= 0.2 / move.norm();
    bool up = false;
    for (int halving = 0; halving < 20 && !up; ++halving, move /= 2) {
      const V3 next = (n + move).normalized();
      const double there = separation(a, b, next);
      if (there > s) n = next, s = there, up = true;
    }
    if (!up) break;
  }
  return n;
}

constexpr double aside = 1e-3;  // of a kink [rad]

/// On the slope that rises from n = ±axis of c, where one does.
void beside_disc(const ConvexShape& a, const ConvexShape& b, const ConvexShape& c, std::vector<V3>& out) {
  for (const double side : {1.0, -1.0}) {
    const V3 n = side * c.axis(), middle = c.centre + (&c == &a ? -c.half : c.half) * n;  // of the disc that faces the other one
    const V3 w = c.across(&c == &a ? V3(middle - support(b, n)) : V3(support(a, -n) - middle));
    if (w.norm() > c.disc) out.push_back((n + aside / w.norm() * w).normalized());
  }
}

void grid_maxima(const ConvexShape& a, const ConvexShape& b, std::vector<V3>& out) {
  constexpr int around = 24, up = 12;
  const Matrix3<double>& axes = a.placement.rotation;
  std::array<std::array<double, around>, up> s;
  const auto at = [&](int i, int j) {
    const double t = M_PI * (i + 0.5) / up, p = 2 * M_PI * j / around;
    return V3(axes * V3(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)));
  };
  const auto value = [&](int i, int j) -> double& { return s[static_cast<std::size_t>(i)][static_cast<std::size_t>((j + around) % around)]; };
  for (int i = 0; i < up; ++i)
    for (int j = 0; j < around; ++j) value(i, j) = separation(a, b, at(i, j));
  for (int i = 0; i < up; ++i)
    for (int j = 0; j < around; ++j) {
      bool highest = true;
      for (int di = -1; di <= 1; ++di)
        for (int dj = -1; dj <= 1; ++dj)
          if (i + di >= 0 && i + di < up) highest = highest && value(i + di, j + dj) <= value(i, j);
      if (highest) out.push_back(at(i, j));
    }
}

}  // namespace

std::vector<Vector3<double>> arc_axes(const ConvexShape& c, const Vector3<double>& x, const Arc& arc) {
  const V3 z = c.axis();
  const double fz = arc.from.dot(z), tz = arc.to.dot(z);
  const auto n = [&](double t) { return V3(std::cos(t) * arc.from + std::sin(t) * arc.to); };
  /// n′·(x − q), q on the rim towards side·z
  const auto slope = [&](double t, double side) {
    const V3 at = n(t), across = c.across(at), along = -std::sin(t) * arc.from + std::cos(t) * arc.to;
    const double length = across.norm();
    return along.dot(x - c.centre - side * c.half * z) - (length > 0 ? c.disc * along.dot(across) / length : 0);
  };
  std::vector<double> ends{0};
  std::vector<V3> out{arc.from};  // a maximum at the seam of a circle has its slope's signs on either end
  for (double t = std::atan2(-fz, tz) - 2 * M_PI; t < arc.angle; t += M_PI)
    if (t > 0) ends.push_back(t), out.push_back(n(t));
  ends.push_back(arc.angle);
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    const double width = ends[k + 1] - ends[k], side = n((ends[k] + ends[k + 1]) / 2).dot(z) < 0 ? -1 : 1;
    const int parts = 1 + static_cast<int>(width / 0.1);
    double low = ends[k], before = slope(low, side);
    for (int i = 1; i <= parts; ++i) {
      const double high = i == parts ? ends[k + 1] : ends[k] + width * i / parts, after = slope(high, side);
      if (before > 0 && after <= 0) {
        double l = low, h = high;
        for (int j = 0; j < 60 && l < h; ++j) {
          const double middle = (l + h) / 2;
          (slope(middle, side) > 0 ? l : h) = middle;
        }
        out.push_back(n((l + h) / 2));
      }
      low = high, before = after;
    }
  }
  return out;
}

std::vector<Vector3<double>> cylinder_axes(const ConvexShape& a, const ConvexShape& b) {
  std::vector<V3> out, starts;
  for (const ConvexShape* c : {&a, &b}) {
    const ConvexShape& other = c == &a ? b : a;
    const double sign = c == &a ? 1 : -1;
    for (const V3& n : arc_axes(other, c->centre, {c->placement.rotation.col(0), c->placement.rotation.col(1), 2 * M_PI})) {
      out.push_back(sign * n);
      for (const double side : {aside, -aside}) starts.push_back((sign * n + side * c->axis()).normalized());
    }
    beside_disc(a, b, *c, starts);
  }
  grid_maxima(a, b, starts);
  for (const V3& n : starts) out.push_back(climb(a, b, n));
  return out;
}

}  // namespace delassus
