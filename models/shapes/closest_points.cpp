#include "models/shapes/closest_points.h"

#include <array>

#include <Eigen/LU>

namespace delassus {
namespace {

using V3 = Vector3<double>;

/// At most four points; kept are those whose convex combination is the point nearest to 0.
struct Simplex {
  std::array<V3, 4> x;
  int count = 0;

  /// Nearest point of the affine hull of some of the points, where it is a combination with positive weights.
  std::optional<V3> nearest_of(unsigned subset) const {
    std::array<V3, 4> y;
    int n = 0;
    for (int i = 0; i < count; ++i)
      if (subset >> i & 1) y[static_cast<std::size_t>(n++)] = x[static_cast<std::size_t>(i)];
    if (n == 1) return y[0];
    // min ‖y₀ + D w‖: DᵀD w = −Dᵀy₀
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> D(3, n - 1);
    for (int i = 1; i < n; ++i) D.col(i - 1) = y[static_cast<std::size_t>(i)] - y[0];
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> G = D.transpose() * D;
    const Eigen::FullPivLU<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>> lu(G);
    if (!lu.isInvertible()) return std::nullopt;
    const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> w = lu.solve(-D.transpose() * y[0]);
    if ((w.array() < 0).any() || w.sum() > 1) return std::nullopt;
    return V3(y[0] + D * w);
  }

  V3 reduce() {
    unsigned best = 1;
    V3 nearest = x[0];
    for (unsigned subset = 2; subset < (1u << count); ++subset)
      if (const auto p = nearest_of(subset); p && p->squaredNorm() < nearest.squaredNorm()) nearest = *p, best = subset;
    int n = 0;
    for (int i = 0; i < count; ++i)
      if (best >> i & 1) x[static_cast<std::size_t>(n++)] = x[static_cast<std::size_t>(i)];
    count = n;
    return nearest;
  }
};

}  // namespace

std::optional<Vector3<double>> closest_points(const ConvexShape& a, const ConvexShape& b, double least) {
  Simplex s;
  V3 v = a.polytope.corners[0] - b.polytope.corners[0];
  s.x[0] = v, s.count = 1;
  for (int step = 0; step < 200; ++step) {
    if (v.norm() < least) return std::nullopt;
    const V3 w = support(a, -v) - support(b, v);
    // ‖v‖² − v·w bounds what is left to gain
    bool known = v.squaredNorm() - v.dot(w) <= 1e-15 * v.norm() * (a.size + b.size + v.norm());
    for (int i = 0; i < s.count; ++i) known = known || s.x[static_cast<std::size_t>(i)] == w;
    if (known || s.count == 4) break;
    s.x[static_cast<std::size_t>(s.count++)] = w;
    const V3 next = s.reduce();
    if (!(next.squaredNorm() < v.squaredNorm())) break;
    v = next;
  }
  return v;
}

}  // namespace delassus
