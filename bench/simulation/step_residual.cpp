#include "bench/simulation/step_residual.h"

#include <algorithm>

#include "algorithms/mechanism/kinematics.h"
#include "reference/contact_residual.h"
#include "simulation/cone_rows.h"

namespace delassus::bench {
namespace {

using Kind = Constraint::Kind;
using Vector = VectorX<double>;
using simulation::Cone;

/// The velocity along a one-sided row that it is held to: what is accepted, nearest to the one that it has.
double accepted(double gap, double velocity, double h) {
  if (gap > 0) return -gap / h;
  return std::clamp(velocity, 0.0, simulation::gap_speed);
}

Cone cone_of(Kind kind) {
  switch (kind) {
    case Kind::contact: return Cone::coulomb;
    case Kind::joint_limit: return Cone::half_line;
    case Kind::joint_friction: return Cone::box;
    default: return Cone::free;
  }
}

}  // namespace

StepResidual residual_of(const Model& model, const Stepped& step, double h) {
  Model held = model;
  held.constraints.clear();
  for (Body& b : held.bodies) b.joint.armature.clear();
  for (const HeldRows& r : step.rows) held.constraints.push_back(r.constraint);
  auto problem = std::make_shared<Problem<double>>(kinematics<double>(held, step.q));
  for (Index k = 0; k < step.added.size(); ++k) problem->armature[k] = step.added[k];

  simulation::ContactProblem<double> p;
  p.mechanism = problem;
  p.resize(problem->structure->rows);
  const reference::DenseContact<double> numbers(p);
  const Vector moving = numbers.J * step.after;
  Vector lambda(p.rows());
  StepResidual out;
  Index row = 0;
  for (const HeldRows& r : step.rows) {
    const Index n = r.impulse.size();
    const auto first = static_cast<std::size_t>(row);
    lambda.segment(row, n) = r.impulse;
    const Cone cone = cone_of(r.constraint.kind);
    append(p, cone, n);
    for (Index k = 0; k < n && r.R_inverse.size() > 0; ++k) p.R_inverse[first + static_cast<std::size_t>(k)] = r.R_inverse[k];
    if (cone == Cone::coulomb) p.friction[first + 1] = p.friction[first + 2] = r.constraint.friction;
    if (cone == Cone::box) p.high[first] = h * r.constraint.friction, p.low[first] = -p.high[first];
    if (cone == Cone::coulomb || cone == Cone::half_line) {
      p.target[row] = accepted(r.gap, moving[row] + p.R_inverse[first] * lambda[row], h);
      out.depth = std::max(out.depth, -r.gap);
    }
    row += n;
  }
  // The reference takes u from λ; of a step it is that of ν⁺, whatever its momentum.
  p.free_velocity = moving - numbers.G * lambda;
  const reference::ContactResidual of = reference::contact_residual(p, numbers, lambda, simulation::FrictionLaw::exact);
  out.natural = of.natural, out.approach = of.approach, out.cone = of.cone;
  Vector momentum = numbers.M * (step.after - step.before) - step.pushed - numbers.J.transpose() * lambda;
  for (const Index k : step.held) momentum[k] = 0;
  out.momentum = momentum.size() > 0 ? momentum.cwiseAbs().maxCoeff() : 0;
  return out;
}

}  // namespace delassus::bench
