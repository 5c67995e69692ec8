// Shared by build.cpp (bodies) and build_rows.cpp (constraints and damping): small exact vectors, places of bodies.
#pragma once

#include "generators/build.h"
#include "generators/random.h"

namespace delassus::generators::detail {

using Vec3 = Vector3<double>;
using Vec6 = Vector6<double>;
using Mat3 = Matrix3<double>;

inline Vec3 small_vector(Random& r, int reach) {
  Vec3 v;
  for (int k = 0; k < 3; ++k) v[k] = r.integer(-reach, reach);
  return v;
}

inline Vec3 nonzero_vector(Random& r, int reach) {
  Vec3 v = small_vector(r, reach);
  while (v.isZero(0)) v = small_vector(r, reach);
  return v;
}

/// v times the power of two that brings its length into (1/√2, √2].
inline Vec3 about_unit(const Vec3& v) {
  const double squared = v.squaredNorm();
  double scale = 1;
  while (squared * scale * scale > 2) scale /= 2;
  while (2 * squared * scale * scale <= 1) scale *= 2;
  return v * scale;
}

/// A small-integer direction orthogonal to v, of about unit length.
inline Vec3 orthogonal(const Vec3& v) {
  Index k = 0;
  v.cwiseAbs().minCoeff(&k);
  return about_unit(v.cross(Vec3::Unit(k)));
}

/// Where a body's joint is, from the reference point of its tree, and how large the body is.
struct Place {
  Vec3 point = Vec3::Zero();
  double length = 1;
};

/// Number of rows of a link constraint of this kind.
[[nodiscard]] Index row_count(const LinkConstraintSpec& c);
/// Fills the blocks K of one link constraint; `root` is the root body of each body's tree.
void fill_link(const LinkConstraintSpec& c, const std::vector<Place>& at, const std::vector<Index>& root,
               const Structure::LinkConstraint& e, Problem<double>& out);
/// Fills a rows × n block 𝒦, row-major.
void fill_joint(const JointConstraintSpec& c, Index rows, Index n, double* K);
/// Fills R⁻¹ of rows [row, row + rows).
void fill_damping(const DampingSpec& d, Index row, Index rows, Damping<double>& out);

}  // namespace delassus::generators::detail
