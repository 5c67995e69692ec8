// From Newton's method to an assembled pose: which attempt is taken, what is left open, what moved.
#include "algorithms/mechanism/loop_closing.h"

#include <algorithm>
#include <cmath>

#include "algorithms/errors/message.h"
#include "algorithms/mechanism/constraints.h"
#include "algorithms/mechanism/loop_newton.h"

namespace delassus {
namespace {

using Vector = VectorX<double>;

constexpr double unit = unit_roundoff<double>;

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

/// Of the entries of each loop the largest against what is accepted.
std::vector<Gap> gaps_of(const Loops& loops, const Closing& closing, const Vector& before, double tolerance) {
  Poses<double> at;
  poses(loops.model, closing.q, at);
  std::vector<Gap> out;
  Index row = 0;
  for (std::size_t k = 0; k < loops.model.constraints.size(); ++k) {
    const Constraint& c = loops.model.constraints[k];
    const Index m = row_count(loops.model, c);
    const double given = c.tolerance >= 0 ? c.tolerance : tolerance;
    Gap worst;
    double most = -1;
    for (Index r = 0; r < m; ++r) {
      Gap g;
      g.constraint = loops.constraint[k];
      g.angle = r < angles_of(c.kind);
      g.before = largest(before.segment(row, m));
      g.after = std::fabs(closing.e[row + r]);
      g.rounding = 30 * unit * joints_of(loops, c) * size_of(c, at);
      g.accepted = std::max(g.rounding, given >= 0 ? given : accepted_gap * (g.angle ? 1 : closing.levers[k]));
      const double share = g.after / g.accepted;
      if (r > 0 && share <= most) continue;
      worst = g, most = share;
      if (std::isnan(share)) break;
    }
    out.push_back(worst);
    row += m;
  }
  return out;
}

/// Degrees of freedom beyond the limits that were to be kept.
std::vector<Beyond> beyond_of(const Loops& loops, const Vector& q) {
  std::vector<Beyond> out;
  for (std::size_t i = 0; i < loops.model.bodies.size(); ++i)
    for (Index k = loops.model.first_dof[i]; k < loops.model.first_dof[i + 1]; ++k) {
      const Index c = loops.column[k];
      if (c < 0 || loops.coordinate[c] < 0) continue;
      const double value = q[loops.coordinate[c]], slack = 4 * unit * std::fabs(value);
      const double limit = std::clamp(value, loops.lower[c], loops.upper[c]);
      if (std::fabs(value - limit) > slack) out.push_back({static_cast<Index>(i), k - loops.model.first_dof[i], value, limit});
    }
  return out;
}

/// A run of Newton's method and what it is worth.
struct Attempt {
  Closing closing;
  std::vector<Gap> gaps;
  int grade = 0;  // 0 closed to rounding, 1 within what is accepted, 2 open
};

int grade_of(const std::vector<Gap>& gaps) {
  int grade = 0;
  for (const Gap& g : gaps) grade = std::max(grade, g.open() ? 2 : g.after > g.rounding ? 1 : 0);
  return grade;
}

/// Whether the couplings keep their sums up to rounding.
bool couplings_hold(const Loops& loops, const Closing& closing) {
  const Vector error = closing.coupling_error();
  const double size = largest(closing.q);
  for (Index k = 0; k < error.size(); ++k)
    if (!(std::fabs(error[k]) <= 30 * unit * size * loops.C.row(k).lpNorm<1>())) return false;
  return true;
}

/// Everything that is the same for all attempts.
struct Task {
  const Loops& loops;
  Vector before;
  double tolerance;

  [[nodiscard]] Attempt graded(const Closing& closing) const {
    Attempt a{closing, gaps_of(loops, closing, before, tolerance), 0};
    a.grade = couplings_hold(loops, closing) ? grade_of(a.gaps) : 2;
    return a;
  }
  /// Along the strong directions first; the weak ones where they close the loops to rounding, or are needed.
  [[nodiscard]] Attempt run(const Vector& start, bool limits) const {
    Closing closing(loops, start);
    closing.descend(strong_directions, limits);
    Attempt first = graded(closing);
    if (first.grade == 0) return first;
    closing.descend(all_directions, limits);
    Attempt second = graded(closing);
    return second.grade < first.grade || first.grade == 2 ? second : first;
  }
};

/// The middle of their ranges for the degrees of freedom that left them.
Vector middle(const Model& model, Vector q, const std::vector<Beyond>& beyond) {
  for (const Beyond& b : beyond) {
    const Joint& joint = model.bodies[b.body].joint;
    if (joint.lower.empty() || joint.upper.empty()) continue;
    const double m = joint.lower[b.dof] / 2 + joint.upper[b.dof] / 2;
    if (std::isfinite(m)) q[model.first_q[b.body] + b.dof] = m;
  }
  return q;
}

std::vector<Move> moves_of(const Model& model, const Vector& from, const Vector& to) {
  std::vector<Move> out;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const JointType type = model.bodies[i].joint.type;
    const Index k = model.first_q[i], n = q_size(type);
    const Vector a = from.segment(k, n), b = to.segment(k, n);
    const Vector d = b - a;
    Move m{static_cast<Index>(i), 0, 0};
    const auto angle = [](const Eigen::Vector4d& x, const Eigen::Vector4d& y) {
      const double along = std::fabs(x.dot(y));
      return 2 * std::atan2((y - x * x.dot(y)).norm(), along);
    };
    switch (type) {
      case JointType::revolute: m.turned = std::fabs(d[0]); break;
      case JointType::prismatic: m.shifted = std::fabs(d[0]); break;
      case JointType::universal: m.turned = largest(d); break;
      case JointType::planar: m.turned = std::fabs(d[0]), m.shifted = d.tail(2).norm(); break;
      case JointType::spherical: m.turned = angle(a, b); break;
      case JointType::floating: m.turned = angle(a.tail(4), b.tail(4)), m.shifted = d.head(3).norm(); break;
      case JointType::cylindrical: m.turned = std::fabs(d[0]), m.shifted = std::fabs(d[1]); break;
    }
    if (std::max(m.turned, m.shifted) > 30 * unit * static_cast<double>(model.bodies.size()) * std::max(1.0, largest(a))) out.push_back(m);
  }
  return out;
}

std::string told(const Model& model, const Gap& g) {
  const Constraint& c = model.constraints[g.constraint];
  return (c.name.empty() ? std::string(name(c.kind)) : c.name) + " by " + number_text(g.after) + (g.angle ? " rad" : " m");
}

}  // namespace

Assembly close_loops(const Model& model, const VectorX<double>& q, const AssemblyOptions& options) {
  require(q.size() == model.q_size(), "close_loops: q does not have Model::q_size() entries");
  require(options.held.empty() || static_cast<Index>(options.held.size()) == model.dofs(), "close_loops: held does not have Model::dofs() entries");
  Assembly result;
  result.q = q;
  if (std::none_of(model.constraints.begin(), model.constraints.end(), [](const Constraint& c) { return c.loop; }))
    return result;
  const Loops loops(model, q, options);
  Poses<double> at;
  const Task task{loops, loop_errors(loops, q, at), options.tolerance};
  Attempt best = task.run(q, false);
  result.beyond = beyond_of(loops, best.closing.q);
  if (!result.beyond.empty() && best.grade < 2)
    for (const Vector& start : {q, middle(model, q, result.beyond)}) {
      Attempt within = task.run(start, true);
      if (within.grade > best.grade || !beyond_of(loops, within.closing.q).empty()) continue;
      best = std::move(within);
      result.beyond.clear();
      break;
    }
  result.q = best.closing.q;
  result.residual_before = largest(task.before);
  result.residual = largest(best.closing.e);
  result.steps = best.closing.steps;
  result.gaps = best.gaps;
  result.moves = moves_of(model, q, result.q);
  return result;
}

OpenLoops open_loops(const Model& model, const Assembly& a) {
  OpenLoops out;
  std::string others;
  const auto share = [](const Gap& g) { return g.after / g.accepted; };
  for (const Gap& g : a.gaps)
    if (g.open() && (out.worst == nullptr || std::isnan(g.after) || share(g) > share(*out.worst))) out.worst = &g;
  if (out.worst == nullptr) return out;
  for (const Gap& g : a.gaps)
    if (g.open() && &g != out.worst) others += (others.empty() ? "; also open: " : ", ") + told(model, g);
  const Gap& w = *out.worst;
  const std::string unit_of = w.angle ? " rad" : " m";
  out.problem = "the loop cannot be closed from this pose: open by " + number_text(w.after) + unit_of + " after " + std::to_string(a.steps) +
                " steps of assembly, by " + number_text(w.before) + " before" + others;
  out.accepted = "at most " + number_text(w.accepted) + unit_of;
  return out;
}

Assembly assemble(const Model& model, const VectorX<double>& q, const std::string& file, const AssemblyOptions& options) {
  Assembly a = close_loops(model, q, options);
  const OpenLoops open = open_loops(model, a);
  if (open.worst == nullptr) return a;
  const Constraint& c = model.constraints[open.worst->constraint];
  throw ModelError(file, std::string(name(c.kind)) + " constraint" + (c.name.empty() ? "" : " " + c.name), open.problem,
                   open.accepted + "; start nearer to a closed pose, hold fewer joints, or give the constraint a tolerance");
}

}  // namespace delassus
