// Constraint rows and damping of a spec.
#include <cmath>

#include "generators/build_detail.h"

namespace delassus::generators::detail {
namespace {

/// Velocity along n of the body's point p, or (p == nullptr) its angular velocity about n.
Vec6 row_along(const Vec3& n, const Vec3* p) {
  Vec6 k;
  if (p) k << p->cross(n), n;
  else k << n, Vec3::Zero();
  return k;
}

/// Rows of a physical constraint on a body: fixed directions of the constraint, its point p from the body's own tree.
void physical_rows(const LinkConstraintSpec& c, const Vec3& p, double sign, Vec6* K) {
  Random r(c.seed ^ 0x77);
  const Vec3 drawn = nonzero_vector(r, 2);
  const Vec3 n = about_unit(c.axis ? Vec3((*c.axis)[0], (*c.axis)[1], (*c.axis)[2]) : drawn), t = orthogonal(n);
  Index k = 0;
  if (c.kind == ConstraintKind::hinge) {
    K[k++] = sign * row_along(t, nullptr);
    K[k++] = sign * row_along(about_unit(n.cross(t)), nullptr);
  }
  if (c.kind == ConstraintKind::weld)
    for (Index j = 0; j < 3; ++j) K[k++] = sign * row_along(Vec3(Vec3::Unit(j)), nullptr);
  if (c.kind == ConstraintKind::distance || c.kind == ConstraintKind::plane) {
    K[k++] = sign * row_along(n, &p);
  } else if (c.kind == ConstraintKind::contact) {
    K[k++] = sign * row_along(t, &p);
    K[k++] = sign * row_along(about_unit(n.cross(t)), &p);
    K[k++] = sign * row_along(n, &p);
  } else {
    for (Index j = 0; j < 3; ++j) K[k++] = sign * row_along(Vec3(Vec3::Unit(j)), &p);
  }
}

/// The constraint's point: near the first body, and at the same place of the second when both are of one tree.
Vec3 shared_point(const LinkConstraintSpec& c, const Place& first) {
  if (c.at) return first.point + first.length * Vec3((*c.at)[0], (*c.at)[1], (*c.at)[2]);
  Random r(c.seed);
  return first.point + first.length / 2 * small_vector(r, 2);
}

void generic_rows(const LinkConstraintSpec& c, Index body, const Place& at, Vec6* K) {
  Random r(c.seed ^ (static_cast<std::uint64_t>(body) << 32));
  for (Index k = 0; k < c.rows; ++k) {
    Vec6 x;
    for (Index j = 0; j < 6; ++j) x[j] = r.integer(-2, 2);
    K[k] = x;
    K[k].head<3>() += at.point.cross(Vec3(x.tail<3>()));
  }
}

/// D L Lᵀ D, L unit lower triangular of small integers over 2, D = √10^decade per row: symmetric positive definite.
MatrixX<double> damping_block(const DampingSpec& d, Index rows, Random& r) {
  MatrixX<double> B = MatrixX<double>::Zero(rows, rows);
  for (Index k = 0; k < rows; ++k) {
    const double scale = std::ldexp(1.0, static_cast<int>(std::lround(r.integer(d.low, d.high) * 1.660964047443681)));
    for (Index j = 0; j <= k; ++j) B(k, j) = j == k ? scale : scale * r.integer(-1, 1) / 2;
  }
  return B.lazyProduct(B.transpose());
}

}  // namespace

Index row_count(const LinkConstraintSpec& c) {
  switch (c.kind) {
    case ConstraintKind::point:
    case ConstraintKind::contact: return 3;
    case ConstraintKind::weld: return 6;
    case ConstraintKind::hinge: return 5;
    case ConstraintKind::distance:
    case ConstraintKind::plane: return 1;
    case ConstraintKind::generic: return c.rows;
  }
  return 0;
}

void fill_link(const LinkConstraintSpec& c, const std::vector<Place>& at, const std::vector<Index>& root,
               const Structure::LinkConstraint& e, Problem<double>& out) {
  for (std::size_t k = 0; k < e.links.size(); ++k) {
    const auto body = static_cast<std::size_t>(e.links[k].body), first = static_cast<std::size_t>(c.bodies[0]);
    Vec6* K = out.K.data() + e.links[k].first;
    if (c.kind == ConstraintKind::generic) {
      generic_rows(c, e.links[k].body, at[body], K);
      continue;
    }
    const bool same_tree = root[body] == root[first];
    physical_rows(c, shared_point(c, same_tree ? at[first] : at[body]), k == 0 ? 1 : -1, K);
  }
}

void fill_joint(const JointConstraintSpec& c, Index rows, Index n, double* K) {
  Random r(c.seed);
  for (Index k = 0; k < rows; ++k)
    for (Index j = 0; j < n; ++j) K[k * n + j] = c.rows == 0 ? (k == j ? 1 : 0) : r.integer(-2, 2);
}

void fill_damping(const DampingSpec& d, Index row, Index rows, Damping<double>& out) {
  Random r(d.seed);
  if (d.kind == DampingKind::block) out.blocks.push_back({row, damping_block(d, rows, r)});
  if (d.kind != DampingKind::rows) return;
  for (Index k = 0; k < rows; ++k)
    out.diagonal[static_cast<std::size_t>(row + k)] = power_of_ten(r.integer(d.low, d.high));
}

}  // namespace delassus::generators::detail
