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
