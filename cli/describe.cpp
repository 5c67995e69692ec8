// `delassus describe SCENE`: what a scene is made of, how it will be eliminated, what every operator will hold.
#include <algorithm>
#include <cstdio>
#include <new>

#include "algorithms/dynamics/spectrum.h"
#include "algorithms/factors/plan.h"
#include "bench/page/scene_facts.h"
#include "bench/text.h"
#include "cli/commands.h"
#include "cli/common.h"
#include "cli/describe_robot.h"
#include "cli/effects.h"
#include "cli/names.h"
#include "cli/program/options.h"

namespace delassus::cli {

namespace {

/// The elimination order as body names, and the off-diagonal 6×6 blocks before and after fill.
json plan_json(const Scene& scene, const Structure& structure, Matrix matrix) {
  const Plan plan = make_plan(structure, matrix);
  json order = json::array();
  for (const int body : plan.body) order.push_back(scene.model.bodies[static_cast<std::size_t>(body)].name);
  std::vector<int> first(plan.constraint_pairs.begin(), plan.constraint_pairs.end());
  std::sort(first.begin(), first.end());
  const auto before = std::unique(first.begin(), first.end()) - first.begin();
  return {{"order", order}, {"blocks_of_constraints", before}, {"blocks_with_fill", plan.blocks},
          {"steps_without_rows", plan.first_active}};
}

constexpr double most_described = 256e6;  ///< [B] of one matrix: what is larger takes longer than a description should

/// The sizes of all operators. Those that would be larger say how large they are at least.
json operators_json(const std::shared_ptr<const Structure>& structure) {
  json out = json::array();
  const auto square = [](Index n) { return 8 * static_cast<double>(n) * static_cast<double>(n); };
  for (const OperatorRow& row : operators()) {
    json j = {{"name", row.name}, {"bytes", nullptr}, {"workspace_bytes", nullptr}};
    const double least = row.holds == Holds::sparse ? 0 : square(structure->rows) + (row.holds == Holds::all_squared ? square(structure->dofs()) : 0);
    if (least > most_described) {
      j["bytes_at_least"] = least;
      out.push_back(j);
      continue;
    }
    try {
      const auto op = row.make<double>();
      op->analyze(structure);
      j["bytes"] = op->bytes();
      j["workspace_bytes"] = op->workspace() * static_cast<Index>(sizeof(double));
    } catch (const std::bad_alloc&) {  // more than the machine has: the sizes stay null
    }
    out.push_back(j);
  }
  return out;
}

json constraints_json(const Model& model) {
  json out = json::array();
  Index row = 0;
  for (const Constraint& c : model.constraints) {
    const auto end = [&](Index b) { return b == ground ? std::string("world") : model.bodies[static_cast<std::size_t>(b)].name; };
    const Index rows = row_count(model, c);
    json j = {{"kind", name(c.kind)}, {"row", row}, {"rows", rows}};
    if (!c.name.empty()) j["name"] = c.name;
    if (c.kind != Constraint::Kind::coupling && c.kind != Constraint::Kind::general) {
      j["of"] = end(c.a.body);
      if (!acts_on_joint(c.kind)) j["to"] = end(c.b.body);
    }
    out.push_back(j);
    row += rows;
  }
  return out;
}

/// [{joint, type, q}] at the configuration of the scene, after assembly.
json configuration_json(const Scene& scene) {
  json out = json::array();
  for (std::size_t i = 0; i < scene.model.bodies.size(); ++i) {
    const Joint& joint = scene.model.bodies[i].joint;
    const auto first = scene.q.begin() + scene.model.first_q[i], end = scene.q.begin() + scene.model.first_q[i + 1];
    out.push_back({{"joint", joint.name.empty() ? scene.model.bodies[i].name : joint.name}, {"type", name(joint.type)}, {"q", std::vector<double>(first, end)}});
  }
  return out;
}

/// Per loop what is left open, per joint how far it was moved.
json assembly_json(const Scene& scene) {
  const Assembly& a = scene.assembly;
  json out = {{"residual", a.residual}, {"residual_before", a.residual_before}, {"steps", a.steps}, {"gaps", json::array()}, {"moves", json::array()}, {"beyond_limits", json::array()}};
  const auto joint = [&](Index i) { return scene.model.bodies[static_cast<std::size_t>(i)].joint.name; };
  for (const Gap& g : a.gaps)
    out["gaps"].push_back({{"name", scene.model.constraints[static_cast<std::size_t>(g.constraint)].name}, {"before", g.before}, {"after", g.after},
                           {"rounding", g.rounding}, {"accepted", g.accepted}, {"unit", g.angle ? "rad" : "m"}});
  for (const Move& m : a.moves) out["moves"].push_back({{"joint", joint(m.body)}, {"turned", m.turned}, {"shifted", m.shifted}});
  for (const Beyond& b : a.beyond) out["beyond_limits"].push_back({{"joint", joint(b.body)}, {"dof", b.dof}, {"value", b.value}, {"limit", b.limit}});
  return out;
}

/// {largest, smallest: {lower, upper}} of the eigenvalues of Λ⁻¹, to a part in a thousand; null without rows, or where M is singular.
json spectrum_json(const Scene& scene) {
  const Problem<double> problem = problem_of(scene);
  if (problem.structure->rows == 0) return nullptr;
  Spectrum<double> spectrum(problem.structure);
  Spectrum<double>::Interval largest, smallest;
  if (!spectrum.update(problem).ok() || !spectrum.largest(1e-3, largest).ok() || !spectrum.smallest(1e-3, smallest).ok()) return nullptr;
  const auto interval = [](const Spectrum<double>::Interval& i) { return json{{"lower", i.lower}, {"upper", i.upper}}; };
  return {{"largest", interval(largest)}, {"smallest", interval(smallest)}};
}

json describe_json(const Scene& scene) {
  const auto structure = structure_of(scene.model);
  const bench::SceneResult facts = bench::facts_of(scene, false);
  json j = {{"scene", scene.name}, {"bodies", facts.bodies}, {"dof", facts.dofs}, {"rows", facts.rows},
            {"trees", facts.trees}, {"summary", facts.summary}, {"constraints", constraints_json(scene.model)}, {"configuration", configuration_json(scene)},
            {"robots", robots_json(scene)}, {"damping", damping_json(scene.damping)}, {"effects", effects_json(scene)}, {"notes", facts.notes},
            {"eigenvalues", spectrum_json(scene)}, {"warnings", warnings_json(scene)},
            {"provisional_pose", scene.provisional_pose},
            {"elimination", {{"M", plan_json(scene, *structure, Matrix::M)}, {"M_R", plan_json(scene, *structure, Matrix::M_R)}}},
            {"operators", operators_json(structure)}};
  j["loops"] = {{"any", scene.has_loops}};
  if (scene.has_loops)
    j["loops"].update(assembly_json(scene));
  return j;
}

/// A long list shortened in the middle of its text.
std::string some(const json& list, std::size_t most) {
  std::string text;
  for (std::size_t i = 0; i < std::min(most, list.size()); ++i) text += (i ? ", " : "") + list[i].get<std::string>();
  return list.size() > most ? text + bench::format(", … (%zu in all; --json lists them)", list.size()) : text;
}

void print_line(const char* key, const std::string& value) { std::printf("%-18s %s\n", key, value.c_str()); }

void print_spectrum(const json& s) {
  if (s.is_null()) return;
  const auto number = [&](const char* which, const char* end) { return s[which][end].get<double>(); };
  print_line("eigenvalues", number("smallest", "lower") > 0
      ? bench::format("of Λ⁻¹, %.4g to %.4g: condition number at most %.3g", number("smallest", "lower"), number("largest", "upper"),
                      number("largest", "upper") / number("smallest", "lower"))
      : bench::format("of Λ⁻¹, up to %.4g; the least is not told from 0 (at most %.1e): rows depend on others, or nearly", number("largest", "upper"), number("smallest", "upper")));
}

constexpr std::size_t most_lines = 24;

/// The first lines, then how many more there are.
template <class Line> void print_list(const json& list, Line&& line) {
  for (std::size_t i = 0; i < std::min(most_lines, list.size()); ++i) std::printf("  %s\n", line(list[i]).c_str());
  if (list.size() > most_lines) std::printf("  … (%zu in all; --json lists them)\n", list.size());
}

/// Rows `first–last`, the constraint they belong to and its unit.
void print_rows(const json& constraints, const Model& model) {
  print_list(constraints, [&](const json& c) {
    const Index first = c["row"], rows = c["rows"];
    std::string name = row_name(model, first);
    name = name.substr(0, name.rfind(", row "));
    const std::string_view unit = row_units(model, first).force, last = rows > 0 ? row_units(model, first + rows - 1).force : "";
    return bench::pad_right(std::to_string(first) + (rows > 1 ? "–" + std::to_string(first + rows - 1) : ""), 10) + name + "  [" + std::string(unit) +
           (last != unit ? ", " + std::string(last) : "") + "]";
  });
}

/// Joints with their coordinates, those at zero left out.
void print_configuration(const json& configuration) {
  json moved = json::array();
  for (const json& j : configuration)
    if (std::any_of(j["q"].begin(), j["q"].end(), [](const json& x) { return x != 0.0; })) moved.push_back(j);
  std::printf("q%s\n", moved.empty() ? "                  0 at every joint" : "                  rad, m, quaternions w x y z; joints at 0 left out");
  print_list(moved, [](const json& j) {
    std::string text = bench::pad_right(j["joint"].get<std::string>(), 32);
    for (const json& x : j["q"]) text += bench::format(" %.9g", x.get<double>());
    return text;
  });
}

void print_moves(const json& moves) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(moves.size(), 8); ++i) {
    const double turned = moves[i]["turned"], shifted = moves[i]["shifted"];
    text += (i ? ", " : "") + moves[i]["joint"].get<std::string>() + " by";
    if (turned > 0) text += bench::format(" %.3g rad", turned);
    if (shifted > 0) text += bench::format(" %.3g m", shifted);
  }
  if (moves.size() > 8) text += bench::format(", … (%zu in all; --json lists them)", moves.size());
  if (!text.empty()) print_line("  moved", text);
}

void print_text(const json& j, const Model& model, bool joints_too) {
  print_line("scene", j["scene"]);
  print_line("bodies", j["bodies"].dump() + " in " + j["trees"].dump() + " tree(s)");
  print_line("dofs", j["dof"].dump());
  print_robots(j["robots"], joints_too);
  print_line("rows", j["rows"].dump() + ": " + j["summary"].get<std::string>());
  print_rows(j["constraints"], model);
  print_line("damping [1/kg]", j["damping"].is_array() ? "per row (--json lists it)" : j["damping"].dump());
  print_spectrum(j["eigenvalues"]);
  if (j["loops"]["any"].get<bool>()) {
    print_line("loops", bench::format("largest closure error %.2e after %d steps of assembly, %.2e before [m or rad]",
                                      j["loops"]["residual"].get<double>(), j["loops"]["steps"].get<int>(),
                                      j["loops"]["residual_before"].get<double>()));
    print_moves(j["loops"]["moves"]);
  }
  print_configuration(j["configuration"]);
  for (const char* matrix : {"M", "M_R"}) {
    const json& plan = j["elimination"][matrix];
    print_line(matrix == std::string("M") ? "elimination of M" : "of M + Jᵀ R J",
               plan["blocks_with_fill"].dump() + " off-diagonal 6×6 blocks, " + plan["blocks_of_constraints"].dump() +
                   " before fill; " + plan["steps_without_rows"].dump() + " joints carry no row");
    print_line("  order", some(plan["order"], 8));
  }
  std::printf("effects\n");
  for (const json& e : j["effects"])
    std::printf("  %s %-19s %s\n", e["called_for"].get<bool>() ? "+" : "-", e["name"].get<std::string>().c_str(),
                e["why"].get<std::string>().c_str());
  std::printf("operators\n");
  for (const json& o : j["operators"]) {
    if (o.contains("bytes_at_least")) {
      std::printf("  %-18s at least %s: not held to say how much\n", o["name"].get<std::string>().c_str(), bench::short_bytes(o["bytes_at_least"]).c_str());
      continue;
    }
    if (o["bytes"].is_null()) {
      std::printf("  %-18s more memory than this machine has\n", o["name"].get<std::string>().c_str());
      continue;
    }
    std::printf("  %-18s %10s, workspace %s\n", o["name"].get<std::string>().c_str(),
                bench::short_bytes(o["bytes"]).c_str(), bench::short_bytes(o["workspace_bytes"]).c_str());
  }
  for (const json& note : j["notes"]) print_line("note", note);
}

int describe(const std::string& name, const SceneOptions& opening, bool as_json) {
  const Scene scene = open(name, opening);
  const json j = describe_json(scene);
  if (as_json) std::printf("%s\n", j.dump(1).c_str());
  else print_text(j, scene.model, scene.is_robot_file);
  return good;
}

}  // namespace

void add_describe(options::Command& app, Run& run) {
  options::Command* c = app.add_subcommand("describe", "bodies, rows, elimination order, fill, bytes, effects called for and skipped");
  auto scene = std::make_shared<std::string>();
  auto as_json = std::make_shared<bool>(false);
  auto opening = std::make_shared<SceneOptions>();
  c->add_option("scene", *scene, "name, .yaml file, robot's file (URDF) or swimmer:N")->required();
  c->add_flag("--json", *as_json, "everything, as JSON");
  add_scene_options(*c, *opening);
  c->callback([=, &run] { run = [=] { return describe(*scene, *opening, *as_json); }; });
}

}  // namespace delassus::cli
