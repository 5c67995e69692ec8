// The rows K of the constraint kinds, at the frames of a Mechanism.
#include <algorithm>
#include <cmath>

#include "algorithms/kit/counted.h"
#include "algorithms/kit/quad.h"
#include "algorithms/mechanism/constraints.h"
#include "algorithms/mechanism/mechanism.h"

namespace delassus {
namespace {

using Kind = Constraint::Kind;

Index first_row(const Structure::LinkConstraint& to, Index body) {
  for (const auto& l : to.links)
    if (l.body == body) return l.first;
  return -1;
}

/// Dual row of column k: w with w·s_k = 1 and w·s_j = 0, in the span of the columns (a row of the Moore–Penrose
/// inverse). The other columns are orthogonalised first, then s_k against them, twice.
template <class T> Vector6<T> dual_row(const Vector6<T>* S, Index n, Index k) {
  Vector6<T> basis[6];
  Index count = 0;
  const auto remove = [&](Vector6<T>& x) {
    for (Index j = 0; j < count; ++j) x -= basis[j] * T(basis[j].dot(x) / basis[j].dot(basis[j]));
  };
  for (Index j = 0; j < n; ++j) {
    if (j == k) continue;
    Vector6<T> x = S[j];
    remove(x);
    remove(x);
    basis[count++] = x;
  }
  Vector6<T> w = S[k];
  remove(w);
  remove(w);
  return w / T(w.dot(S[k]));
}

/// Rows of the two ends of a constraint: side a's motion minus side b's. A null pointer: that end is the world.
template <class T> struct Rows {
  Vector6<T>* a;
  Vector6<T>* b;
  Three<T> at_a, at_b;  // the point of each side, from its own tree's reference point

  void angular(const Three<T>& u) {
    const Three<T> zero = three<T>(T(0), T(0), T(0));
    if (a) store((a++)->data(), u, zero);
    if (b) store((b++)->data(), -u, -zero);
  }
  void linear(const Three<T>& u) {
    if (a) store((a++)->data(), cross(at_a, u), u);
    if (b) store((b++)->data(), cross(u, at_b), -u);
  }
};

/// Kinds that let the origins drift apart. Their axes are fixed on a, so the rate of the offset in these axes is
/// the relative velocity at the origin of b, for both sides.
bool slides(Kind kind) { return kind == Kind::cylindrical || kind == Kind::prismatic || kind == Kind::planar; }

}  // namespace

template <class T>
void Mechanism<T>::compile_constraint(const Model& model, const Constraint& c, const Structure::LinkConstraint& to, std::size_t e) {
  if (has_closure(c.kind)) {
    const auto end = [&](const Frame& f) {
      return End{f.body, f.body == ground ? -1 : first_row(to, f.body), three_by_three<T>(rotation_as<T>(f.placement.rotation)),
                 three<T>(Vector3<T>(f.placement.translation.template cast<T>()))};
    };
    pairs_.push_back({c.kind, to.row, end(c.a), end(c.b)});
    return;
  }
  Terms all{c.kind, e, {}};
  for (const Constraint::Term& t : c.terms) {
    if (t.body == ground) continue;
    const Body& body = model.bodies[t.body];
    const Index parent = c.kind == Kind::coupling ? body.parent : ground;
    all.terms.push_back({t.body, parent, model.first_dof[t.body], dof_count(body.joint.type), t.dof, first_row(to, t.body),
                         parent == ground ? -1 : first_row(to, parent), T(t.coefficient), t.K.template cast<T>()});
  }
  terms_.push_back(std::move(all));
}

template <class T> Three<T> Mechanism<T>::position_of(const End& end) const {
  return end.body == ground ? three<T>(T(0), T(0), T(0)) : position_[end.body] + rotation_[end.body] * end.position;
}

// Origin of a minus origin of b, world axes. Within one tree no world position enters.
template <class T> Three<T> Mechanism<T>::offset(const End& a, const End& b) const {
  const Three<T> local = position_of(a) - position_of(b);
  const Index tree_a = a.body == ground ? ground : joints_[a.body].tree, tree_b = b.body == ground ? ground : joints_[b.body].tree;
  if (tree_a == tree_b && tree_a != ground) return local;
  return local + ((tree_a == ground ? a.position : reference_[tree_a]) - (tree_b == ground ? b.position : reference_[tree_b]));
}

template <class T> void Mechanism<T>::pair_rows(const Pair& pair, std::vector<Vector6<T>>& K) const {
  const End &a = pair.a, &b = pair.b;
  Rows<T> rows{a.first < 0 ? nullptr : K.data() + a.first, b.first < 0 ? nullptr : K.data() + b.first, position_of(a), position_of(b)};
  if (slides(pair.kind)) rows.at_a = rows.at_a - offset(a, b);
  if (pair.kind == Kind::distance) {
    using std::sqrt;
    const Three<T> d = offset(a, b);
    return rows.linear(d * T(T(1) / T(sqrt(dot(d, d)))));
  }
  const ThreeByThree<T> axes = a.body == ground ? a.rotation : rotation_[a.body] * a.rotation;
  const Three<T>&x = axes.column[0], &y = axes.column[1], &z = axes.column[2];
  switch (pair.kind) {
    case Kind::point: rows.linear(x), rows.linear(y), rows.linear(z); return;
    case Kind::weld:
      rows.angular(x), rows.angular(y), rows.angular(z);
      rows.linear(x), rows.linear(y), rows.linear(z);
      return;
    case Kind::hinge:
      rows.angular(x), rows.angular(y);
      rows.linear(x), rows.linear(y), rows.linear(z);
      return;
    case Kind::universal: {
      const Three<T> of_b = b.rotation.column[0];
      rows.angular(cross(z, b.body == ground ? of_b : rotation_[b.body] * of_b));
      rows.linear(x), rows.linear(y), rows.linear(z);
      return;
    }
    case Kind::cylindrical: rows.angular(x), rows.angular(y), rows.linear(x), rows.linear(y); return;
    case Kind::prismatic:
      rows.angular(x), rows.angular(y), rows.angular(z);
      rows.linear(x), rows.linear(y);
      return;
    case Kind::planar: rows.angular(x), rows.angular(y), rows.linear(z); return;
    case Kind::contact: rows.linear(z), rows.linear(x), rows.linear(y); return;
    default: return;  // not between two frames
  }
}

// Of a coupling Σ c_k ν_k with ν_k = S_k⁺ (a_i − a_π(i)); of user rows (k_ω; k_v) in body axes about the body frame's origin
// p: (R k_ω + p × R k_v; R k_v).
template <class T>
void Mechanism<T>::term_rows(const Terms& all, const std::vector<Vector6<T>>& S, std::vector<Vector6<T>>& K) const {
  const Structure::LinkConstraint& to = structure_->link_constraints[all.constraint];
  for (const auto& l : to.links)
    for (Index k = 0; k < to.rows; ++k) K[l.first + k].setConstant(T(0));
  for (const Term& t : all.terms) {
    if (all.kind == Kind::coupling) {
      const Vector6<T> row = t.coefficient * dual_row(S.data() + t.first_dof, t.dofs, t.dof);
      K[t.first] += row;
      if (t.parent != ground) K[t.first_of_parent] -= row;
      continue;
    }
    for (Index k = 0; k < to.rows; ++k) {
      const auto part = [&](int first) { return rotation_[t.body] * three<T>(t.K(k, first), t.K(k, first + 1), t.K(k, first + 2)); };
      const Three<T> linear = part(3), angular = part(0) + cross(position_[t.body], linear);
      K[t.first + k].template head<3>() += vector(angular);
      K[t.first + k].template tail<3>() += vector(linear);
    }
  }
}

#ifndef DELASSUS_DEFINITIONS_ONLY  // property_tests/unit/mechanism/jet.cpp has scalars of its own
#define DELASSUS_INSTANTIATE(T)                                                                                                   \
  template void Mechanism<T>::compile_constraint(const Model&, const Constraint&, const Structure::LinkConstraint&, std::size_t); \
  template void Mechanism<T>::pair_rows(const Pair&, std::vector<Vector6<T>>&) const;                                             \
  template void Mechanism<T>::term_rows(const Terms&, const std::vector<Vector6<T>>&, std::vector<Vector6<T>>&) const;
DELASSUS_INSTANTIATE(double)
DELASSUS_INSTANTIATE(float)
DELASSUS_INSTANTIATE(Quad)
DELASSUS_INSTANTIATE(Counted)
#undef DELASSUS_INSTANTIATE
#endif

}  // namespace delassus
