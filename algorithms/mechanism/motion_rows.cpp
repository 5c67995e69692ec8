// J̇ν of the constraint kinds: the time derivative of each row of mechanism_rows.cpp at ν̇ = 0.
//
//   u fixed on a      d/dt u·(ω_a − ω_b) = u·(α_a − α_b + ω_a × ω_b)
//                     d/dt u·(v_a − v_b) = u·(a_a − a_b − ω_a × (v_a − v_b))
//   origins that drift apart, d = x_b − x_a, v = v_a + ω_a × d − v_b
//                     d/dt u·v = u·(a_a + α_a × d + ω_a × (ω_a × d) − a_b − 2 ω_a × v)
//   universal         u = z_a × x_b:  u·(α_a − α_b) + ((ω_a × z_a) × x_b + z_a × (ω_b × x_b))·(ω_a − ω_b)
//   distance          u = e/|e|, e = x_a − x_b, ė = v_a − v_b:  u·(a_a − a_b) + |u × ė|²/|e|
//   general           k_ω, k_v in body axes:  k_ω·Rᵀα + k_v·Rᵀ(a − ω × v)
#include <algorithm>
#include <cmath>

#include "algorithms/kit/counted.h"
#include "algorithms/kit/quad.h"
#include "algorithms/mechanism/motion.h"

namespace delassus {
namespace {

using Kind = Constraint::Kind;

}  // namespace

// The frame of an end: a vector fixed in it turns with ω, its origin moves with v (less that of the reference point) and a.
template <class T> struct Motion<T>::Moving {
  Three<T> omega, velocity, alpha, acceleration;
};

template <class T> auto Motion<T>::moving(const End& end) const -> Moving {
  const Three<T> rest = three<T>(T(0), T(0), T(0));
  if (end.body == ground) return {rest, rest, rest, rest};
  const Parts &v = velocity_[end.body], &a = product_[end.body];
  const Three<T> r = mechanism_->rotation_[end.body] * end.position, turning = cross(v.angular, r);
  return {v.angular, v.linear + turning, a.angular, a.linear + cross(a.angular, r) + cross(v.angular, turning)};
}

template <class T> void Motion<T>::pair_bias(const Pair& pair, T* out) const {
  const Mechanism<T>& m = *mechanism_;
  const End &end_a = pair.a, &end_b = pair.b;
  const Moving a = moving(end_a), b = moving(end_b);
  const auto axes_of = [&](const End& e) { return e.body == ground ? e.rotation : m.rotation_[e.body] * e.rotation; };
  const auto tree = [&](const End& e) { return e.body == ground ? ground : m.joints_[e.body].tree; };
  Three<T> velocity = a.velocity - b.velocity;  // of the origins
  if (tree(end_a) != tree(end_b)) velocity = velocity + (reference_velocity(end_a.body) - reference_velocity(end_b.body));

  const Three<T> angular = a.alpha - b.alpha + cross(a.omega, b.omega), apart = a.acceleration - b.acceleration;
  Three<T> linear = apart - cross(a.omega, velocity);
  if (pair.kind == Kind::cylindrical || pair.kind == Kind::prismatic || pair.kind == Kind::planar) {
    const Three<T> d = -m.offset(end_a, end_b), turning = cross(a.omega, d);
    linear = apart + cross(a.alpha, d) + cross(a.omega, turning) - cross(a.omega, velocity + turning) * T(2);
  }
  if (pair.kind == Kind::distance) {
    using std::sqrt;
    const Three<T> e = m.offset(end_a, end_b);
    const T one_by_length = T(1) / T(sqrt(dot(e, e)));
    const Three<T> u = e * one_by_length, across = cross(u, velocity);
    *out = dot(u, apart) + dot(across, across) * one_by_length;
    return;
  }
  const ThreeByThree<T> axes = axes_of(end_a);
  const Three<T>&x = axes.column[0], &y = axes.column[1], &z = axes.column[2];
  const auto rows = [&](const Three<T>& of, auto... along) { ((*out++ = dot(along, of)), ...); };
  switch (pair.kind) {
    case Kind::point: return rows(linear, x, y, z);
    case Kind::weld: return rows(angular, x, y, z), rows(linear, x, y, z);
    case Kind::hinge: return rows(angular, x, y), rows(linear, x, y, z);
    case Kind::universal: {
      const Three<T> of_b = axes_of(end_b).column[0];
      const Three<T> rate = cross(cross(a.omega, z), of_b) + cross(z, cross(b.omega, of_b));
      *out++ = dot(cross(z, of_b), a.alpha - b.alpha) + dot(rate, a.omega - b.omega);
      return rows(linear, x, y, z);
    }
    case Kind::cylindrical: return rows(angular, x, y), rows(linear, x, y);
    case Kind::prismatic: return rows(angular, x, y, z), rows(linear, x, y);
    case Kind::planar: return rows(angular, x, y), rows(linear, z);
    case Kind::contact: return rows(linear, z, x, y);
    default: return;  // not between two frames
  }
}

template <class T> void Motion<T>::terms_bias(const Terms& all, T* out) const {
  const Index rows = mechanism_->structure_->link_constraints[all.constraint].rows;
  if (all.kind == Kind::coupling) return;  // Σ c_k ν_k
  for (const auto& t : all.terms) {
    const ThreeByThree<T>& R = mechanism_->rotation_[t.body];
    const Parts &v = velocity_[t.body], &a = product_[t.body];
    const Three<T> angular = transposed_times(R, a.angular);
    const Three<T> linear = transposed_times(R, a.linear - cross(v.angular, v.linear + reference_velocity(t.body)));
    for (Index k = 0; k < rows; ++k)
      for (int c = 0; c < 3; ++c) out[k] += t.K(k, c) * angular[c] + t.K(k, 3 + c) * linear[c];
  }
}

template <class T> void Motion<T>::bias_rows(VectorX<T>& out) const {
  const Structure& s = *mechanism_->structure_;
  out.resize(s.rows);
  std::fill(out.data(), out.data() + out.size(), T(0));
  for (const Pair& pair : mechanism_->pairs_) pair_bias(pair, out.data() + pair.row);
  for (const Terms& terms : mechanism_->terms_) terms_bias(terms, out.data() + s.link_constraints[terms.constraint].row);
}

#ifndef DELASSUS_DEFINITIONS_ONLY  // property_tests/unit/mechanism/jet.cpp has scalars of its own
#define DELASSUS_INSTANTIATE(T) template void Motion<T>::bias_rows(VectorX<T>&) const;
DELASSUS_INSTANTIATE(double)
DELASSUS_INSTANTIATE(float)
DELASSUS_INSTANTIATE(Quad)
DELASSUS_INSTANTIATE(Counted)
#undef DELASSUS_INSTANTIATE
#endif

}  // namespace delassus
