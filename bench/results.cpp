#include "bench/results.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace delassus::bench {

using nlohmann::json;

int Cell::checked() const {
  int n = 0;
  for (const LawResult& l : laws) n += l.skipped.empty();
  return n;
}

int Cell::failed() const {
  int n = 0;
  for (const LawResult& l : laws) n += l.skipped.empty() && !l.passed;
  return n;
}

int Cell::left_out() const {
  int n = 0;
  for (const LawResult& l : laws) n += l.left_out;
  return n;
}

bool Cell::against_definition() const {
  return std::any_of(laws.begin(), laws.end(), [](const LawResult& l) { return l.skipped.empty() && l.law.find("= definition") != std::string::npos; });
}

const LawResult* Cell::worst() const {
  const LawResult* w = nullptr;
  for (const LawResult& l : laws)
    if (l.skipped.empty() && (!w || !(l.ratio <= w->ratio))) w = &l;
  return w;
}

int Results::checked() const {
  int n = 0;
  for (const SceneResult& s : scenes)
    for (const Cell& c : s.cells) n += c.checked();
  return n;
}

int Results::left_out() const {
  int n = 0;
  for (const SceneResult& s : scenes)
    for (const Cell& c : s.cells) n += c.left_out();
  return n;
}

int Results::failed() const {
  int n = 0;
  for (const SceneResult& s : scenes)
    for (const Cell& c : s.cells) n += c.failed();
  return n;
}

namespace {

json to_json(const Timing& t) {
  if (!t.measured()) return nullptr;
  return {{"median", t.median}, {"lowest", t.lowest}, {"batches", t.batches}};
}

json count(std::int64_t n) { return n < 0 ? json(nullptr) : json(n); }

json to_json(const LawResult& l) {
  if (!l.skipped.empty()) return {{"law", l.law}, {"skipped", l.skipped}, {"left_out", l.left_out}};
  json j = {{"law", l.law}, {"ratio", std::isfinite(l.ratio) ? json(l.ratio) : json("infinity")}, {"passed", l.passed}};
  if (!l.note.empty()) j["note"] = l.note;
  return j;
}

json to_json(const OperatorInfo& o) {
  return {{"name", o.name}, {"summary", o.summary}, {"formula", o.formula}, {"source", o.source}, {"cost", o.cost},
          {"applies", o.applies}, {"solves", o.solves}, {"zero_damping", o.zero_damping},
          {"apply_error", o.apply_error}, {"solve_error", o.solve_error}};
}

}  // namespace

void to_json(json& j, const Cell& c) {
  j = {{"operator", c.op}};
  if (!c.skipped.empty()) {
    j["skipped"] = c.skipped;
    return;
  }
  j["microseconds"] = {{"analyze", to_json(c.time.analyze)}, {"update", to_json(c.time.update)},
                       {"new_damping", to_json(c.time.new_damping)}, {"apply", to_json(c.time.apply)},
                       {"solve", to_json(c.time.solve)}};
  if (c.time.unrefined.measured()) j["microseconds"]["unrefined_solve"] = to_json(c.time.unrefined);
  j["operations"] = {{"update", count(c.operations.update)}, {"new_damping", count(c.operations.new_damping)},
                     {"apply", count(c.operations.apply)}, {"solve", count(c.operations.solve)}};
  j["bytes"] = count(c.bytes);
  j["workspace_bytes"] = count(c.workspace_bytes);
  j["update_status"] = c.update_status;
  j["solve_status"] = c.solve_status;
  if (c.laws.empty()) return;
  j["laws"] = json::array();
  for (const LawResult& l : c.laws) j["laws"].push_back(to_json(l));
}

void to_json(json& j, const SceneResult& s) {
  j = {{"scene", s.name}, {"summary", s.summary}, {"bodies", s.bodies}, {"dof", s.dofs}, {"rows", s.rows},
       {"trees", s.trees}, {"loops", s.has_loops}, {"loop_residual", s.loop_residual},
       {"provisional_pose", s.provisional_pose},
       {"damping", {{"smallest", s.smallest_damping}, {"largest", s.largest_damping}}},
       {"kinematics_microseconds", to_json(s.kinematics)}, {"notes", s.notes}, {"operators", s.cells}};
}

void to_json(json& j, const Rung& r) {
  j = {{"links", r.links}, {"dof", r.dofs}, {"rows", r.rows}, {"kinematics_microseconds", to_json(r.kinematics)},
       {"operators", r.cells}};
}

void to_json(json& j, const Results& r) {
  const Machine& m = r.machine;
  j = {{"machine", {{"processor", m.processor}, {"cores", m.cores}, {"system", m.system}, {"compiler", m.compiler},
                    {"flags", m.flags}, {"revision", m.revision}, {"date", m.date}}},
       {"quick", r.quick}, {"seconds", r.seconds},
       {"units", {{"time", "µs per call"}, {"memory", "bytes"}, {"damping", "1/kg"}, {"ratio", "error/(eps*bound), holds below 30"}}},
       {"checked", r.checked()}, {"failed", r.failed()}, {"left_out", r.left_out()}, {"interrupted", r.interrupted}, {"scenes", r.scenes}, {"swimmers", r.ladder}};
  j["digits_kept"] = r.accuracy.digits;
  j["operators"] = json::array();
  for (const OperatorInfo& o : r.operators) j["operators"].push_back(to_json(o));
  j["laws"] = json::array();
  for (const RowInfo& l : r.laws) j["laws"].push_back({{"name", l.name}, {"identity", l.text}, {"bound", l.detail}});
  j["references"] = json::array();
  for (const RowInfo& l : r.references)
    j["references"].push_back({{"name", l.name}, {"summary", l.text}, {"trusted", l.detail}});
}

}  // namespace delassus::bench
