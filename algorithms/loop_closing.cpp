// Position-level errors φ(q) of the constraints, and Newton's method that closes the loops of a model.
#include "algorithms/loop_closing.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "algorithms/constraints.h"

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

template <class T> void pair_error(const Constraint& c, const End<T>& a, const End<T>& b, VectorX<T>& e) {
  using std::sqrt;
  const Vector3<T> d = offset(a, b);
  const Vector3<T> along = a.rotation.transpose() * d;
  switch (c.kind) {
    case Kind::point: e = along; return;
    case Kind::weld: e << rotation_error(a.rotation, b.rotation), along; return;
    case Kind::hinge:
      axis_error(a.rotation, b.rotation, e.data());
      e.template tail<3>() = along;
      return;
    case Kind::universal: e << a.rotation.col(2).dot(b.rotation.col(0)), along; return;
    case Kind::cylindrical:
      axis_error(a.rotation, b.rotation, e.data());
      e.template tail<2>() = along.template head<2>();
      return;
    case Kind::prismatic: e << rotation_error(a.rotation, b.rotation), along.template head<2>(); return;
    case Kind::planar:
      axis_error(a.rotation, b.rotation, e.data());
      e[2] = along[2];
      return;
    case Kind::distance: e[0] = T(sqrt(T(d.dot(d)))) - T(c.length); return;
    case Kind::contact: e[0] = along[2]; return;
    default: return;
  }
}

/// The loop constraints of a model on their own, and the degrees of freedom of the trees they touch.
struct Loops {
  Model model;                      // the same bodies; loop constraints only
  std::shared_ptr<const Structure> structure;
  std::vector<Index> column;        // per degree of freedom: its column in J, −1 for trees without loops
  Index columns = 0;
  explicit Loops(const Model& whole);
};

Loops::Loops(const Model& whole) {
  model = whole;
  std::erase_if(model.constraints, [](const Constraint& c) { return !c.loop; });
  structure = structure_of(model);
  const Structure& s = *structure;
  std::vector<Index> root(s.parent.size());
  std::vector<bool> involved(s.parent.size(), false);
  for (Index i = 0; i < s.bodies(); ++i) root[i] = s.parent[i] == ground ? i : root[s.parent[i]];
  for (const auto& c : s.link_constraints)
    for (const auto& l : c.links) involved[root[l.body]] = true;
  column.assign(s.dofs(), -1);
  for (Index i = 0; i < s.bodies(); ++i)
    if (involved[root[i]])
      for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) column[k] = columns++;
}

/// J of the loop constraints: the sum of K_e^i S_j over the joints j on the path from body i to its root.
MatrixX<double> loop_jacobian(const Loops& loops, const Problem<double>& p) {
  const Structure& s = *loops.structure;
  MatrixX<double> J = MatrixX<double>::Zero(s.rows, loops.columns);
  for (const auto& c : s.link_constraints)
    for (const auto& l : c.links)
      for (Index j = l.body; j != ground; j = s.parent[j])
        for (Index k = s.first_dof[j]; k < s.first_dof[j + 1]; ++k)
          for (Index r = 0; r < c.rows; ++r) J(c.row + r, loops.column[k]) += p.K[l.first + r].dot(p.S[k]);
  return J;
}

/// Position errors of every loop constraint at q, one after the other.
VectorX<double> loop_errors(const Loops& loops, const VectorX<double>& q, Poses<double>& at) {
  poses(loops.model, q, at);
  VectorX<double> e(loops.structure->rows);
  Index row = 0;
  for (const Constraint& c : loops.model.constraints) {
    const VectorX<double> own = closure_error(loops.model, c, at);
    e.segment(row, own.size()) = own;
    row += own.size();
  }
  return e;
}

/// Largest magnitude of a non-empty vector; NaN when an entry is NaN.
double largest(const VectorX<double>& x) {
  double out = 0;
  for (Index i = 0; i < x.size(); ++i) {
    if (std::isnan(x[i])) return x[i];
    out = std::max(out, std::fabs(x[i]));
  }
  return out;
}

/// Lengths that the linear errors of a constraint are differences of [m], at least the 1 of its angles [rad].
double size_of(const Constraint& c, const Poses<double>& at) {
  const End<double> a = end_of(at, c.a), b = end_of(at, c.b);
  double size = std::max({1.0, a.position.norm(), b.position.norm(), c.length});
  if (a.tree != b.tree) size = std::max({size, a.reference.norm(), b.reference.norm()});
  return size;
}

/// Joints whose rounding reaches the errors of a constraint: those on the ways from its bodies to their roots, and itself.
int joints_of(const Loops& loops, const Constraint& c) {
  int joints = 1;
  for (const Index end : {c.a.body, c.b.body})
    for (Index i = end; i != ground; i = loops.structure->parent[i]) ++joints;
  return joints;
}

/// @throws ModelError for the loop whose remaining error is largest against what is accepted, if any is.
void check_closed(const Loops& loops, const VectorX<double>& e, const Poses<double>& at, const std::string& file) {
  Index row = 0;
  for (const Constraint& c : loops.model.constraints) {
    const Index m = row_count(loops.model, c);
    const double worst = largest(e.segment(row, m)), accepted = 30 * unit_roundoff<double> * joints_of(loops, c) * size_of(c, at);
    row += m;
    if (worst <= accepted) continue;
    std::ostringstream found, limit;
    found << "loop cannot be closed from this configuration, residual " << worst << " m or rad";
    limit << "at most " << accepted << " m or rad after Newton's method";
    throw ModelError(file, std::string(name(c.kind)) + " constraint" + (c.name.empty() ? "" : " " + c.name), found.str(),
                     limit.str());
  }
}

/// The least-squares step −J⁺ φ, on all degrees of freedom.
VectorX<double> newton_step(const Loops& loops, const Problem<double>& p, const VectorX<double>& e) {
  const VectorX<double> x = loop_jacobian(loops, p).completeOrthogonalDecomposition().solve(e);
  VectorX<double> v = VectorX<double>::Zero(loops.structure->dofs());
  for (Index k = 0; k < v.size(); ++k)
    if (loops.column[k] >= 0) v[k] = -x[loops.column[k]];
  return v;
}

}  // namespace

template <class T> VectorX<T> closure_error(const Model& model, const Constraint& c, const Poses<T>& at) {
  VectorX<T> e = VectorX<T>::Constant(row_count(model, c), T(0));
  if (has_closure(c.kind)) pair_error(c, end_of(at, c.a), end_of(at, c.b), e);
  return e;
}

Assembly assemble(const Model& model, const VectorX<double>& q, const std::string& file) {
  require(q.size() == model.q_size(), "assemble: q does not have Model::q_size() entries");
  Assembly result{q, 0, 0, 0};
  if (std::none_of(model.constraints.begin(), model.constraints.end(), [](const Constraint& c) { return c.loop; }))
    return result;
  const Loops loops(model);
  Problem<double> problem(loops.structure);
  Poses<double> at;
  VectorX<double> e = loop_errors(loops, q, at);
  result.residual_before = result.residual = largest(e);
  double norm = e.norm();
  for (bool falling = true; falling && norm > 0;) {
    falling = false;
    kinematics(loops.model, result.q, at, problem);
    VectorX<double> v = newton_step(loops, problem, e);
    // Half the step while the error does not fall; 53 halvings leave q unchanged.
    for (int halving = 0; halving < 53 && !falling; ++halving, v /= 2) {
      const VectorX<double> trial = integrate(loops.model, result.q, v);
      const VectorX<double> trial_error = loop_errors(loops, trial, at);
      if (!(trial_error.norm() < norm)) continue;
      result.q = trial;
      e = trial_error;
      norm = e.norm();
      ++result.steps;
      falling = true;
    }
  }
  result.residual = largest(e);
  poses(loops.model, result.q, at);
  check_closed(loops, e, at, file);
  return result;
}

template VectorX<double> closure_error<double>(const Model&, const Constraint&, const Poses<double>&);
template VectorX<float> closure_error<float>(const Model&, const Constraint&, const Poses<float>&);
template VectorX<Quad> closure_error<Quad>(const Model&, const Constraint&, const Poses<Quad>&);
template VectorX<Counted> closure_error<Counted>(const Model&, const Constraint&, const Poses<Counted>&);

}  // namespace delassus
