#include "cli/names.h"

#include <algorithm>

namespace delassus::cli {

namespace {

std::string end_name(const Model& model, Index body) {
  return body == ground ? "world" : model.bodies[static_cast<std::size_t>(body)].name;
}

std::string constraint_name(const Model& model, const Constraint& c) {
  if (!c.name.empty()) return c.name;
  const std::string kind(name(c.kind));
  if (acts_on_joint(c.kind)) return kind + " of " + model.bodies[static_cast<std::size_t>(c.a.body)].joint.name;
  if (c.kind == Constraint::Kind::coupling || c.kind == Constraint::Kind::general) return kind;
  return kind + " " + end_name(model, c.a.body) + " to " + end_name(model, c.b.body);
}

std::string part(Index at, Index of, const char* what) {
  return of == 1 ? "" : ", " + std::string(what) + " " + std::to_string(at + 1) + " of " + std::to_string(of);
}

/// Angular degrees of freedom, which come first.
Index turning_dofs(JointType type) {
  switch (type) {
    case JointType::prismatic: return 0;
    case JointType::universal: return 2;
    case JointType::spherical: return 3;
    case JointType::floating: return 3;
    default: return 1;
  }
}

/// Angular rows of a constraint between bodies, which come first.
Index turning_rows(Constraint::Kind kind) {
  switch (kind) {
    case Constraint::Kind::weld:
    case Constraint::Kind::prismatic: return 3;
    case Constraint::Kind::hinge:
    case Constraint::Kind::cylindrical:
    case Constraint::Kind::planar: return 2;
    case Constraint::Kind::universal: return 1;
    default: return 0;
  }
}

}  // namespace

std::string row_name(const Model& model, Index row) {
  Index first = 0;
  for (const Constraint& c : model.constraints) {
    const Index rows = row_count(model, c);
    if (row < first + rows) return constraint_name(model, c) + part(row - first, rows, "row");
    first += rows;
  }
  return "no constraint";
}

Units row_units(const Model& model, Index row) {
  constexpr Units turning{"rad/s²", "N m"}, sliding{"m/s²", "N"};
  const auto joint = [&](Index body, Index dof) {
    const JointType type = model.bodies[static_cast<std::size_t>(body)].joint.type;
    return dof < turning_dofs(type) ? turning : sliding;
  };
  Index first = 0;
  for (const Constraint& c : model.constraints) {
    const Index rows = row_count(model, c), at = row - first;
    first += rows;
    if (row >= first) continue;
    if (c.kind == Constraint::Kind::general) break;
    if (c.kind == Constraint::Kind::coupling) return c.terms.empty() ? sliding : joint(c.terms[0].body, c.terms[0].dof);
    if (c.kind == Constraint::Kind::joint_limit) return joint(c.a.body, c.dof);
    if (acts_on_joint(c.kind)) return joint(c.a.body, at);
    return at < turning_rows(c.kind) ? turning : sliding;
  }
  return {"", ""};
}

std::string joint_name(const Model& model, Index dof) {
  const auto after = std::upper_bound(model.first_dof.begin(), model.first_dof.end(), dof);
  const auto body = static_cast<std::size_t>(after - model.first_dof.begin() - 1);
  const Index first = model.first_dof[body];
  return model.bodies[body].joint.name + part(dof - first, model.first_dof[body + 1] - first, "degree of freedom");
}

std::string place(const Model& model, const Report& report, bool singular) {
  if (report.where < 0) return {};
  if (report.at_row()) return "at row " + std::to_string(report.where) + " (" + row_name(model, report.where) + ")";
  const char* const why = singular ? " (M is singular at this pose: this joint moves nothing that has inertia, or only what another one "
                                     "moves too; give the massless links an inertia, the joint an armature, or take another pose)"
                                   : " (M + JᵀRJ loses all digits there; kkt_elimination and ladder do without it)";
  return "at joint " + joint_name(model, report.where) + why;
}

}  // namespace delassus::cli
