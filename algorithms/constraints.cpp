#include "algorithms/constraints.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "algorithms/regularity.h"

namespace delassus {
namespace {

using Kind = Constraint::Kind;

std::string element_of(const Constraint& c) {
  return std::string(name(c.kind)) + " constraint" + (c.name.empty() ? "" : " " + c.name);
}

Index body_count(const Model& model) { return static_cast<Index>(model.bodies.size()); }

void check_range(const Model& model, Index body, Index lowest, const std::string& file, const std::string& element) {
  if (body < lowest || body >= body_count(model))
    throw ModelError(file, element, "body " + std::to_string(body) + " does not exist",
                     (lowest == ground ? "-1 (the world) to " : "0 to ") + std::to_string(body_count(model) - 1));
}

void check_frames(const Model& model, const Constraint& c, const std::string& file, const std::string& element) {
  for (const Frame* f : {&c.a, &c.b}) {
    check_range(model, f->body, ground, file, element);
    check_pose(f->placement, file, element + (f == &c.a ? " frame a" : " frame b"));
  }
  if (c.a.body == c.b.body)
    throw ModelError(file, element,
                     c.a.body == ground ? "both frames are fixed in the world"
                                        : "both frames are on " + model.bodies[c.a.body].name,
                     "frames on two different bodies, or on one body and the world");
}

void check_terms(const Model& model, const Constraint& c, const std::string& file, const std::string& element) {
  if (c.terms.empty()) throw ModelError(file, element, "has no terms", "1 or more");
  bool moves = false;
  for (const Constraint::Term& t : c.terms) {
    check_range(model, t.body, c.kind == Kind::general ? ground : 0, file, element);
    moves = moves || t.body != ground;
    if (c.kind == Kind::general) {
      if (t.K.rows() < 1 || t.K.rows() != c.terms.front().K.rows() || t.K.cols() != 6)
        throw ModelError(file, element, "K of " + std::to_string(t.K.rows()) + " x " + std::to_string(t.K.cols()),
                         "the same number of rows (1 or more) in every term, 6 columns");
      if (!t.K.allFinite()) throw ModelError(file, element, "K is not finite", "finite numbers");
      continue;
    }
    const Index n = dof_count(model.bodies[t.body].joint.type);
    if (t.dof < 0 || t.dof >= n)
      throw ModelError(file, element, "degree of freedom " + std::to_string(t.dof) + " of " + model.bodies[t.body].name,
                       "0 to " + std::to_string(n - 1));
    if (!std::isfinite(t.coefficient)) throw ModelError(file, element, "coefficient is not finite", "finite numbers");
  }
  if (!moves) throw ModelError(file, element, "every term is on the ground", "a term on a body");
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
  Vector3<T> at_a, at_b;  // the point of each side, from its own tree's reference point

  void angular(const Vector3<T>& u) {
    Vector6<T> row;
    row << u, Vector3<T>::Constant(T(0));
    if (a) *a++ = row;
    if (b) *b++ = -row;
  }
  void linear(const Vector3<T>& u) {
    if (a) *a++ << at_a.cross(u), u;
    if (b) *b++ << u.cross(at_b), -u;
  }
};

/// Kinds that let the origins drift apart. Their axes are fixed on a, so the rate of the offset in these axes is
/// the relative velocity at the origin of b, for both sides.
bool slides(Kind kind) { return kind == Kind::cylindrical || kind == Kind::prismatic || kind == Kind::planar; }

template <class T> void pair_rows(Kind kind, const End<T>& a, const End<T>& b, Rows<T> rows) {
  if (slides(kind)) rows.at_a -= offset(a, b);
  const Vector3<T> x = a.rotation.col(0), y = a.rotation.col(1), z = a.rotation.col(2);
  switch (kind) {
    case Kind::point: rows.linear(x), rows.linear(y), rows.linear(z); return;
    case Kind::weld:
      rows.angular(x), rows.angular(y), rows.angular(z);
      rows.linear(x), rows.linear(y), rows.linear(z);
      return;
    case Kind::hinge:
      rows.angular(x), rows.angular(y);
      rows.linear(x), rows.linear(y), rows.linear(z);
      return;
    case Kind::universal:
      rows.angular(z.cross(Vector3<T>(b.rotation.col(0))));
      rows.linear(x), rows.linear(y), rows.linear(z);
      return;
    case Kind::cylindrical: rows.angular(x), rows.angular(y), rows.linear(x), rows.linear(y); return;
    case Kind::prismatic:
      rows.angular(x), rows.angular(y), rows.angular(z);
      rows.linear(x), rows.linear(y);
      return;
    case Kind::planar: rows.angular(x), rows.angular(y), rows.linear(z); return;
    case Kind::distance: {
      using std::sqrt;
      const Vector3<T> d = offset(a, b);
      rows.linear(d / T(sqrt(T(d.dot(d)))));
      return;
    }
    case Kind::contact: rows.linear(z), rows.linear(x), rows.linear(y); return;
    default: return;  // not between two frames
  }
}

Index first_row(const Structure::LinkConstraint& to, Index body) {
  for (const auto& l : to.links)
    if (l.body == body) return l.first;
  return -1;
}

void zero_rows(const Structure::LinkConstraint& to, auto& K) {
  for (const auto& l : to.links)
    for (Index k = 0; k < to.rows; ++k) K[l.first + k].setConstant(0);
}

/// Σ c_k ν_k with ν_k = S_k⁺ (a_i − a_π(i)).
template <class T>
void coupling_rows(const Model& model, const Constraint& c, const std::vector<Vector6<T>>& S,
                   const Structure::LinkConstraint& to, std::vector<Vector6<T>>& K) {
  zero_rows(to, K);
  for (const Constraint::Term& t : c.terms) {
    const Body& body = model.bodies[t.body];
    const Vector6<T> row =
        T(t.coefficient) * dual_row(S.data() + model.first_dof[t.body], dof_count(body.joint.type), t.dof);
    K[first_row(to, t.body)] += row;
    if (body.parent != ground) K[first_row(to, body.parent)] -= row;
  }
}

/// Rows (k_ω; k_v) in body axes about the body frame's origin p: (R k_ω + p × R k_v; R k_v).
template <class T>
void general_rows(const Constraint& c, const Poses<T>& poses, const Structure::LinkConstraint& to,
                  std::vector<Vector6<T>>& K) {
  zero_rows(to, K);
  for (const Constraint::Term& t : c.terms) {
    if (t.body == ground) continue;
    const Index first = first_row(to, t.body);
    for (Index k = 0; k < to.rows; ++k) {
      const Vector6<T> row = t.K.row(k).transpose().template cast<T>();
      const Vector3<T> linear = poses.rotation[t.body] * row.template tail<3>();
      const Vector3<T> angular = poses.rotation[t.body] * row.template head<3>() + poses.position[t.body].cross(linear);
      K[first + k].template head<3>() += angular;
      K[first + k].template tail<3>() += linear;
    }
  }
}

}  // namespace

bool acts_on_joint(Kind kind) { return kind == Kind::joint_friction || kind == Kind::joint_lock || kind == Kind::joint_limit; }

bool has_closure(Kind kind) {
  return !acts_on_joint(kind) && kind != Kind::coupling && kind != Kind::general;
}

std::vector<Index> attached_bodies(const Model& model, const Constraint& c) {
  std::vector<Index> on;
  const auto add = [&on](Index body) {
    if (body != ground && std::find(on.begin(), on.end(), body) == on.end()) on.push_back(body);
  };
  if (has_closure(c.kind)) add(c.a.body), add(c.b.body);
  for (const Constraint::Term& t : c.terms) {
    if (c.kind == Kind::coupling) add(t.body), add(model.bodies[t.body].parent);
    if (c.kind == Kind::general) add(t.body);
  }
  return on;
}

void validate_constraint(const Model& model, const Constraint& c, const std::string& file) {
  const std::string element = element_of(c);
  if (has_closure(c.kind)) check_frames(model, c, file, element);
  else if (acts_on_joint(c.kind)) check_range(model, c.a.body, 0, file, element);
  else check_terms(model, c, file, element);
  if (c.kind == Kind::joint_limit) {
    const Index n = dof_count(model.bodies[c.a.body].joint.type);
    if (c.dof < 0 || c.dof >= n)
      throw ModelError(file, element, "degree of freedom " + std::to_string(c.dof) + " of " + model.bodies[c.a.body].name,
                       "0 to " + std::to_string(n - 1));
    if (c.side != 1 && c.side != -1) throw ModelError(file, element, "side " + std::to_string(c.side), "1 (lower) or -1 (upper)");
  }
  if (c.kind == Kind::distance && (!(c.length > 0) || std::isinf(c.length))) {
    char digits[32];
    const char* end = std::to_chars(digits, digits + sizeof digits, c.length).ptr;
    throw ModelError(file, element + " length", std::string(static_cast<const char*>(digits), end) + " m", "finite and above 0 m");
  }
  if (!std::isfinite(c.friction))
    throw ModelError(file, element + " friction", "not finite", "a finite number, negative: not given");
  if (c.loop && !has_closure(c.kind))
    throw ModelError(file, element, "is marked as a loop but has no position level",
                     "loop only on kinds between two frames");
}

template <class T> End<T> end_of(const Poses<T>& poses, const Frame& frame) {
  const Matrix3<T> R = rotation_as<T>(frame.placement.rotation);
  const Vector3<T> p = frame.placement.translation.template cast<T>();
  if (frame.body == ground) return {ground, ground, R, Vector3<T>::Constant(T(0)), p};
  const Index i = frame.body, tree = poses.tree[i];
  return {i, tree, poses.rotation[i] * R, poses.position[i] + poses.rotation[i] * p, poses.reference[tree]};
}

template <class T>
void fill_link_rows(const Model& model, const Constraint& c, const Poses<T>& poses, const std::vector<Vector6<T>>& S,
                    const Structure::LinkConstraint& to, std::vector<Vector6<T>>& K) {
  if (c.kind == Kind::coupling) return coupling_rows(model, c, S, to, K);
  if (c.kind == Kind::general) return general_rows(c, poses, to, K);
  const End<T> a = end_of(poses, c.a), b = end_of(poses, c.b);
  const auto rows_of = [&](const End<T>& end) {
    return end.body == ground ? nullptr : K.data() + first_row(to, end.body);
  };
  pair_rows(c.kind, a, b, Rows<T>{rows_of(a), rows_of(b), a.position, b.position});
}

#define DELASSUS_INSTANTIATE(T)                                                                                     \
  template End<T> end_of<T>(const Poses<T>&, const Frame&);                                                         \
  template void fill_link_rows<T>(const Model&, const Constraint&, const Poses<T>&, const std::vector<Vector6<T>>&, \
                                  const Structure::LinkConstraint&, std::vector<Vector6<T>>&);
DELASSUS_INSTANTIATE(double)
DELASSUS_INSTANTIATE(float)
DELASSUS_INSTANTIATE(Quad)
DELASSUS_INSTANTIATE(Counted)
#undef DELASSUS_INSTANTIATE

}  // namespace delassus
