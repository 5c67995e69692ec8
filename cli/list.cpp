// `delassus list`: the tables, as they are compiled in.
#include <cstdio>

#include "bench/page/scene_facts.h"
#include "bench/text.h"
#include "cli/commands.h"
#include "cli/common.h"
#include "cli/list_laws.h"
#include "cli/effects.h"
#include "cli/solvers.h"
#include "generators/families.h"
#include "property_tests/defects/defects.h"
#include "reference/reference.h"
#include "cli/program/options.h"

namespace delassus::cli {

namespace {

json operators_json() {
  json out = json::array();
  for (const OperatorRow& o : operators())
    out.push_back({{"name", o.name}, {"summary", o.summary}, {"formula", o.formula}, {"cost", o.cost}, {"source", o.source},
                   {"applies", o.applies}, {"solves", o.solves}, {"zero_damping", o.zero_damping},
                   {"terminates_exactly", o.terminates_exactly}, {"apply_error", name(o.apply_error)},
                   {"solve_error", name(o.solve_error)}});
  return out;
}

json references_json() {
  json out = json::array();
  for (const reference::ReferenceRow& r : reference::references())
    out.push_back({{"name", r.name}, {"summary", r.summary}, {"trusted", r.trusted_where}, {"roundoff", r.roundoff}});
  return out;
}

json families_json() {
  json out = json::array();
  for (const generators::FamilyRow& f : generators::families())
    out.push_back({{"name", f.name}, {"summary", f.summary}, {"sizes", f.sizes}, {"regular", f.regular}});
  return out;
}


/// Sizes and constraints of a scene in words, or what is wrong with its file.
json scene_row(const std::string& name) {
  try {
    const Scene scene = open_scene(name);
    const auto s = structure_of(scene.model);
    const std::string sizes = bench::format("%3lld dofs, %3lld rows: ", static_cast<long long>(s->dofs()), static_cast<long long>(s->rows));
    return {{"name", name}, {"summary", sizes + bench::constraint_summary(scene.model)}, {"dof", s->dofs()}, {"rows", s->rows}};
  } catch (const ModelError& e) {
    return {{"name", name}, {"summary", std::string("cannot be opened: ") + e.what()}};
  }
}

json defects_json() {
  json out = json::array();
  for (const laws::DefectRow& d : laws::defects())
    out.push_back({{"name", d.name}, {"summary", d.what}, {"base", d.right() ? "itself" : d.base}});
  return out;
}

json scenes_json() {
  json out = json::array();
  for (const std::string& s : scene_names()) out.push_back(scene_row(s));
  out.push_back({{"name", "swimmer:N"}, {"summary", "chain of N links in the plane, two contacts per link; N ≥ 1"}});
  out.push_back({{"name", "stacks:N"}, {"summary", "N boxes that settle in stacks of five, for simulate; N ≥ 1"}});
  out.push_back({{"name", "wall:N"}, {"summary", "N boxes that settle in a wall of ten courses, for simulate; N ≥ 1"}});
  return out;
}

struct Table {
  const char* name;
  json (*rows)();
};
constexpr Table tables[] = {{"operators", operators_json}, {"references", references_json}, {"families", families_json},
                            {"laws", laws_json},           {"scenes", scenes_json},         {"defects", defects_json},     {"effects", effects_list},
                            {"solvers", solvers_list},     {"integrators", integrators_list}};

void print_table(const json& rows) {
  std::size_t width = 0;
  for (const json& row : rows) width = std::max(width, row["name"].get<std::string>().size());
  for (const json& row : rows)
    std::printf("  %s  %s\n", bench::pad_right(row["name"], width).c_str(), row["summary"].get<std::string>().c_str());
}

/// Table cells: everything a row has, names as code.
void print_markdown(const std::string& table, const json& rows) {
  if (table == "operators") {
    std::printf("| operator | what it is | formula | functions | cost | error of apply / solve | source |\n|---|---|---|---|---|---|---|\n");
    for (const json& r : rows) {
      const bool applies = r["applies"], solves = r["solves"];
      const std::string functions = applies && solves ? "apply, solve" : applies ? "apply" : "solve";
      const std::string error = (applies ? r["apply_error"].get<std::string>() : "–") + " / " +
                                (solves ? r["solve_error"].get<std::string>() : "–");
      std::printf("| `%s` | %s | %s | %s | %s | %s | %s |\n", r["name"].get<std::string>().c_str(),
                  r["summary"].get<std::string>().c_str(), r["formula"].get<std::string>().c_str(), functions.c_str(),
                  r["cost"].get<std::string>().c_str(), error.c_str(), r["source"].get<std::string>().c_str());
    }
    return;
  }
  if (table == "solvers") return print_solvers_markdown(rows);
  if (table == "integrators") return print_integrators_markdown(rows);
  if (table == "effects") {
    std::printf("| effect | what it is | called for by | energy |\n|---|---|---|---|\n");
    for (const json& r : rows)
      std::printf("| %s | %s | %s | %s |\n", r["name"].get<std::string>().c_str(), r["summary"].get<std::string>().c_str(),
                  r["called_by"].get<std::string>().c_str(), r["energy"].get<std::string>().c_str());
    return;
  }
  const char* last = table == "laws" ? "bound" : table == "defects" ? "base" : table == "references" ? "trusted" : nullptr;
  std::printf("| %s | %s |%s\n|---|---|%s\n", table.c_str(), table == "laws" ? "identity" : "what it is",
              last ? (std::string(" ") + last + " |").c_str() : "", last ? "---|" : "");
  for (const json& r : rows)
    std::printf("| `%s` | %s |%s\n", r["name"].get<std::string>().c_str(), r["summary"].get<std::string>().c_str(),
                last ? (" " + r[last].get<std::string>() + " |").c_str() : "");
}

int list(const std::string& wanted, bool as_json, bool as_markdown) {
  json all = json::array();
  for (const Table& t : tables) {
    if (!wanted.empty() && wanted != t.name) continue;
    const json rows = t.rows();
    if (as_markdown) {
      print_markdown(t.name, rows);
      if (t.rows == laws_json) print_applies_markdown(rows);
    } else if (!as_json) {
      std::printf("%s%s\n", t.name, wanted.empty() ? ":" : "");
      print_table(rows);
      if (t.rows == laws_json) print_applies(rows);
    } else if (!wanted.empty()) {
      all = rows;
    } else {
      all.push_back({{"name", t.name}, {"rows", rows}});
    }
  }
  if (as_json) std::printf("%s\n", all.dump(1).c_str());
  return good;
}

}  // namespace

void add_list(options::Command& app, Run& run) {
  options::Command* c = app.add_subcommand("list", "print the tables: operators, references, families, laws, scenes, defects, effects, solvers, integrators");
  auto table = std::make_shared<std::string>();
  auto as_json = std::make_shared<bool>(false), as_markdown = std::make_shared<bool>(false);
  std::vector<std::string> names;
  for (const Table& t : tables) names.emplace_back(t.name);
  c->add_option("table", *table, "one table; all when left out")->check(options::one_of(names));
  options::Option* json_flag = c->add_flag("--json", *as_json, "an array of objects with `name`");
  c->add_flag("--markdown", *as_markdown, "a table for a page")->excludes(json_flag);
  c->callback([=, &run] { run = [=] { return list(*table, *as_json, *as_markdown); }; });
}

}  // namespace delassus::cli
