// Position-level errors φ(q) of the constraints between two frames.
#include <algorithm>
#include <cmath>

#include "algorithms/kit/counted.h"
#include "algorithms/kit/quad.h"
#include "algorithms/mechanism/constraints.h"
#include "algorithms/mechanism/loop_closing.h"

namespace delassus {
namespace {

using Kind = Constraint::Kind;

/// Rotation of a relative to b, in the axes of a: 2 sin(θ/2) × axis, from the quaternion of R_bᵀ R_a. Its rate at
/// coincidence is that of the relative rotation; its length grows up to half a turn.
template <class T> Vector3<T> rotation_error(const Matrix3<T>& a, const Matrix3<T>& b) {
  using std::sqrt;
  const Matrix3<T> R = b.transpose() * a;
  const Vector3<T> skew(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  const T trace = R.trace();
  Index i = 0;  // the largest diagonal entry
  for (Index k = 1; k < 3; ++k)
    if (R(k, k) > R(i, i)) i = k;
  if (trace > R(i, i)) return skew / T(sqrt(T(1) + trace));
  const T twice = sqrt(T(1) + T(2) * R(i, i) - trace);  // 2 v_i
  Vector3<T> v = (R.col(i) + R.row(i).transpose()) / twice;
  v[i] = twice;
  return skew[i] < T(0) ? Vector3<T>(-v) : v;
}

/// The same for the z axes alone: angle from b's to a's, x and y components in the axes of a.
template <class T> void axis_error(const Matrix3<T>& a, const Matrix3<T>& b, T* out) {
  using std::sqrt;
  const Vector3<T> z = a.transpose() * b.col(2);
  if (!(z[2] > T(-1))) {  // opposite: any axis across turns one into the other
    out[0] = T(2);
    out[1] = T(0);
    return;
  }
  const T scale = sqrt(T(T(2) / (T(1) + z[2])));
  out[0] = scale * z[1];
  out[1] = -scale * z[0];
}

template <class T> void put(const Vector3<T>& from, Index n, T* to) {
  for (Index k = 0; k < n; ++k) to[k] = from[k];
}

template <class T> void pair_error(const Constraint& c, const End<T>& a, const End<T>& b, T* e) {
  using std::sqrt;
  const Vector3<T> d = offset(a, b);
  const Vector3<T> along = a.rotation.transpose() * d;
  switch (c.kind) {
    case Kind::point: put(along, 3, e); return;
    case Kind::weld: put(rotation_error(a.rotation, b.rotation), 3, e), put(along, 3, e + 3); return;
    case Kind::hinge: axis_error(a.rotation, b.rotation, e), put(along, 3, e + 2); return;
    case Kind::universal: e[0] = a.rotation.col(2).dot(b.rotation.col(0)), put(along, 3, e + 1); return;
    case Kind::cylindrical: axis_error(a.rotation, b.rotation, e), put(along, 2, e + 2); return;
    case Kind::prismatic: put(rotation_error(a.rotation, b.rotation), 3, e), put(along, 2, e + 3); return;
    case Kind::planar: axis_error(a.rotation, b.rotation, e), e[2] = along[2]; return;
    case Kind::distance: e[0] = T(sqrt(T(d.dot(d)))) - T(c.length); return;
    case Kind::contact: e[0] = along[2]; return;
    default: return;
  }
}

}  // namespace

template <class T> Index closure_error(const Model& model, const Constraint& c, const Poses<T>& at, T* e) {
  const Index rows = row_count(model, c);
  std::fill_n(e, rows, T(0));
  if (has_closure(c.kind)) pair_error(c, end_of(at, c.a), end_of(at, c.b), e);
  return rows;
}

template <class T> VectorX<T> closure_error(const Model& model, const Constraint& c, const Poses<T>& at) {
  VectorX<T> e(row_count(model, c));
  closure_error(model, c, at, e.data());
  return e;
}

#define DELASSUS_INSTANTIATE(T)                                                             \
  template VectorX<T> closure_error<T>(const Model&, const Constraint&, const Poses<T>&);   \
  template Index closure_error<T>(const Model&, const Constraint&, const Poses<T>&, T*);
DELASSUS_INSTANTIATE(double)
DELASSUS_INSTANTIATE(float)
DELASSUS_INSTANTIATE(Quad)
DELASSUS_INSTANTIATE(Counted)

}  // namespace delassus
