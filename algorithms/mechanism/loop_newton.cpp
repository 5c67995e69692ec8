// The unknowns of assembly, and Newton's method on them.
#include "algorithms/mechanism/loop_newton.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "algorithms/mechanism/constraints.h"

namespace delassus {
namespace {

using Kind = Constraint::Kind;
using Matrix = MatrixX<double>;
using Vector = VectorX<double>;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Whether the coordinates of a joint are those whose rates are ν.
bool has_coordinates(JointType t) { return q_size(t) == dof_count(t); }

Vector coordinates(const Loops& loops, const Vector& q) {
  Vector out = Vector::Zero(loops.columns);
  for (Index k = 0; k < loops.columns; ++k)
    if (loops.coordinate[k] >= 0) out[k] = q[loops.coordinate[k]];
  return out;
}

/// The bodies' trees that loops touch, and those coupled with them.
std::vector<bool> trees_involved(const Model& whole, const Structure& loops, const std::vector<Index>& root) {
  std::vector<bool> in(root.size(), false);
  for (const auto& c : loops.link_constraints)
    for (const auto& l : c.links) in[root[l.body]] = true;
  for (bool grows = true; grows;) {
    grows = false;
    for (const Constraint& c : whole.constraints) {
      if (c.kind != Kind::coupling) continue;
      const auto touches = [&](const Constraint::Term& t) { return in[root[t.body]]; };
      if (std::none_of(c.terms.begin(), c.terms.end(), touches)) continue;
      for (const auto& t : c.terms)
        if (!in[root[t.body]]) in[root[t.body]] = grows = true;
    }
  }
  return in;
}

/// J of the loop constraints: the sum of K_e^i S_j over the joints j on the path from body i to its root.
Matrix loop_jacobian(const Loops& loops, const Problem<double>& p) {
  const Structure& s = *loops.structure;
  Matrix J = Matrix::Zero(s.rows, loops.columns);
  for (const auto& c : s.link_constraints)
    for (const auto& l : c.links)
      for (Index j = l.body; j != ground; j = s.parent[j])
        for (Index k = s.first_dof[j]; k < s.first_dof[j + 1]; ++k)
          if (loops.column[k] >= 0)
            for (Index r = 0; r < c.rows; ++r) J(c.row + r, loops.column[k]) += p.K[l.first + r].dot(p.S[k]);
  return J;
}

/// Lever arms [m or 1]: per loop, the largest entry of its linear rows of J; 1 where all vanish.
std::vector<double> levers_of(const Loops& loops, const Matrix& J) {
  std::vector<double> out;
  Index row = 0;
  for (const Constraint& c : loops.model.constraints) {
    const Index m = row_count(loops.model, c), angles = angles_of(c.kind);
    const double lever = J.cols() == 0 || m == angles ? 0 : J.middleRows(row + angles, m - angles).cwiseAbs().maxCoeff();
    out.push_back(lever > 0 && std::isfinite(lever) ? lever : 1);
    row += m;
  }
  return out;
}

/// The shortest x that minimises |A x − b|, directions of A below `threshold` of the strongest left alone.
Vector shortest(const Matrix& A, const Vector& b, double threshold) {
  if (A.rows() == 0 || A.cols() == 0) return Vector::Zero(A.cols());
  Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition;
  decomposition.setThreshold(threshold);
  decomposition.compute(A);
  return decomposition.solve(b);
}

/// An orthonormal basis of the null space of C.
Matrix null_space(const Matrix& C) {
  if (C.rows() == 0) return Matrix::Identity(C.cols(), C.cols());
  Eigen::ColPivHouseholderQR<Matrix> qr;
  qr.setThreshold(all_directions);
  qr.compute(C.transpose());
  const Matrix Q = qr.householderQ() * Matrix::Identity(C.cols(), C.cols());
  return Q.rightCols(C.cols() - qr.rank());
}

}  // namespace

Index angles_of(Kind kind) {
  switch (kind) {
    case Kind::weld:
    case Kind::prismatic: return 3;
    case Kind::hinge:
    case Kind::cylindrical:
    case Kind::planar: return 2;
    case Kind::universal: return 1;
    default: return 0;
  }
}

double largest(const Vector& x) {
  double out = 0;
  for (Index i = 0; i < x.size(); ++i) {
    if (std::isnan(x[i])) return x[i];
    out = std::max(out, std::fabs(x[i]));
  }
  return out;
}

Vector loop_errors(const Loops& loops, const Vector& q, Poses<double>& at) {
  poses(loops.model, q, at);
  Vector e(loops.structure->rows);
  Index row = 0;
  for (const Constraint& c : loops.model.constraints) {
    const Vector own = closure_error(loops.model, c, at);
    e.segment(row, own.size()) = own;
    row += own.size();
  }
  return e;
}

Loops::Loops(const Model& whole, const Vector& q, const AssemblyOptions& options) {
  model = whole;
  model.constraints.clear();
  std::vector<bool> held = options.held;
  held.resize(whole.dofs(), false);
  for (std::size_t k = 0; k < whole.constraints.size(); ++k) {
    const Constraint& c = whole.constraints[k];
    if (c.loop) model.constraints.push_back(c), constraint.push_back(static_cast<Index>(k));
    if (c.kind == Kind::joint_lock)
      for (Index i = whole.first_dof[c.a.body]; i < whole.first_dof[c.a.body + 1]; ++i) held[i] = true;
  }
  structure = structure_of(model);
  number_columns(whole, held);
  set_limits(q);
  set_couplings(whole, q);
}

void Loops::number_columns(const Model& whole, const std::vector<bool>& held) {
  const Structure& s = *structure;
  std::vector<Index> root(s.parent.size());
  for (Index i = 0; i < s.bodies(); ++i) root[i] = s.parent[i] == ground ? i : root[s.parent[i]];
  const std::vector<bool> in = trees_involved(whole, s, root);
  column.assign(s.dofs(), -1);
  for (Index i = 0; i < s.bodies(); ++i) {
    if (!in[root[i]]) continue;
    for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) {
      if (held[k]) continue;
      column[k] = columns++;
      coordinate.push_back(has_coordinates(model.bodies[i].joint.type) ? model.first_q[i] + k - s.first_dof[i] : -1);
    }
  }
}

/// Limits that q breaks already are moved to where it is.
void Loops::set_limits(const Vector& q) {
  lower = Vector::Constant(columns, -infinity), upper = Vector::Constant(columns, infinity);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Joint& joint = model.bodies[i].joint;
    for (Index k = model.first_dof[i]; k < model.first_dof[i + 1]; ++k) {
      const Index to = column[k], dof = k - model.first_dof[i];
      if (to < 0 || coordinate[to] < 0) continue;
      if (!joint.lower.empty()) lower[to] = std::min(joint.lower[dof], q[coordinate[to]]);
      if (!joint.upper.empty()) upper[to] = std::max(joint.upper[dof], q[coordinate[to]]);
    }
  }
}

void Loops::set_couplings(const Model& whole, const Vector& q) {
  std::vector<Vector> rows;
  for (const Constraint& c : whole.constraints) {
    if (c.kind != Kind::coupling) continue;
    Vector row = Vector::Zero(columns);
    for (const auto& t : c.terms) {
      const Index k = column[whole.first_dof[t.body] + t.dof];
      if (k >= 0 && coordinate[k] >= 0) row[k] += t.coefficient;
    }
    if (!row.isZero(0)) rows.push_back(row);
  }
  C.resize(static_cast<Index>(rows.size()), columns);
  for (std::size_t k = 0; k < rows.size(); ++k) C.row(static_cast<Index>(k)) = rows[k];
  kept = C * coordinates(*this, q);
}

Closing::Closing(const Loops& loops, const Vector& start) : q(start), loops_(&loops), problem_(loops.structure) {
  kinematics(loops.model, q, at_, problem_);
  levers = levers_of(loops, loop_jacobian(loops, problem_));
  e = loop_errors(loops, q, at_);
  weights = Vector::Ones(e.size());
  Index row = 0;
  for (std::size_t k = 0; k < levers.size(); ++k) {
    const Constraint& c = loops.model.constraints[k];
    const Index m = row_count(loops.model, c), angles = angles_of(c.kind);
    weights.segment(row + angles, m - angles).setConstant(1 / levers[k]);
    row += m;
  }
}

Vector Closing::coupling_error() const { return loops_->C * coordinates(*loops_, q) - loops_->kept; }

/// Given the step on some columns: first what the couplings ask of the others, then the least squares among the
/// directions that the couplings leave.
Vector Closing::free_step(const Matrix& J, Vector x, const std::vector<Index>& free, double threshold) const {
  if (free.empty()) return x;
  const Matrix C = loops_->C(Eigen::all, free), own = weights.asDiagonal() * J(Eigen::all, free);
  const Vector y = shortest(C, -coupling_error() - loops_->C * x, all_directions);
  const Matrix Z = null_space(C);
  const Vector left = weights.cwiseProduct(e + J * x) + own * y;
  const Vector move = y + Z * shortest(own * Z, -left, threshold);
  for (std::size_t k = 0; k < free.size(); ++k) x[free[k]] = move[static_cast<Index>(k)];
  return x;
}

Vector Closing::on_all(const Vector& x) const {
  Vector v = Vector::Zero(loops_->structure->dofs());
  for (Index k = 0; k < v.size(); ++k)
    if (loops_->column[k] >= 0) v[k] = x[loops_->column[k]];
  return v;
}

/// The step on all degrees of freedom. With limits, columns that would pass theirs go there and no further, until none
/// is left that would.
Vector Closing::step(double threshold, bool limits) {
  kinematics(loops_->model, q, at_, problem_);
  const Matrix J = loop_jacobian(*loops_, problem_);
  const Vector from = coordinates(*loops_, q);
  Vector fixed = Vector::Zero(loops_->columns);
  std::vector<Index> free(static_cast<std::size_t>(loops_->columns));
  for (Index k = 0; k < loops_->columns; ++k) free[static_cast<std::size_t>(k)] = k;
  for (;;) {
    Vector x = free_step(J, fixed, free, threshold);
    const std::size_t before = free.size();
    if (limits)
      std::erase_if(free, [&](Index k) {
        const double to = from[k] + x[k], nearest = std::clamp(to, loops_->lower[k], loops_->upper[k]);
        if (loops_->coordinate[k] < 0 || to == nearest || std::isnan(to)) return false;
        fixed[k] = nearest - from[k];
        return true;
      });
    if (free.size() == before) return on_all(x);
  }
}

void Closing::descend(double threshold, bool limits) {
  constexpr int most = 300;
  double norm = norm_of(e);
  for (bool falling = true; falling && norm > 0 && steps < most;) {
    falling = false;
    Vector v = step(threshold, limits);
    // Half the step while the error does not fall; 53 halvings leave q unchanged.
    for (int halving = 0; halving < 53 && !falling; ++halving, v /= 2) {
      const Vector trial = integrate(loops_->model, q, v);
      const Vector trial_error = loop_errors(*loops_, trial, at_);
      if (!(norm_of(trial_error) < norm)) continue;
      q = trial;
      e = trial_error;
      falling = norm_of(e) < norm * (1 - 1e-6);
      norm = norm_of(e);
      ++steps;
      if (!falling) return;
    }
  }
}

}  // namespace delassus
