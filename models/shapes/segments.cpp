#include "models/shapes/segments.h"

#include <algorithm>

#include <Eigen/Geometry>

namespace delassus {

// The lines first: (p + s u − q − t v) ⊥ u, v. Then the point of the second nearest to that of the first, and back.
std::pair<double, double> closest_on_segments(const Vector3<double>& p, const Vector3<double>& u, const Vector3<double>& q, const Vector3<double>& v) {
  const Vector3<double> d = q - p, w = u.cross(v);
  const double a = u.squaredNorm(), b = u.dot(v), c = v.squaredNorm(), ww = w.squaredNorm();
  double s = ww > 1e-18 * a * c ? std::clamp(d.cross(v).dot(w) / ww, -1.0, 1.0) : 0;
  const double t = c > 0 ? std::clamp((s * b - d.dot(v)) / c, -1.0, 1.0) : 0;
  if (a > 0) s = std::clamp((d.dot(u) + t * b) / a, -1.0, 1.0);
  return {s, t};
}

}  // namespace delassus
