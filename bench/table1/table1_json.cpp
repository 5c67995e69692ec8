#include "bench/json.h"
#include "bench/table1/table1.h"

namespace delassus::bench {

using nlohmann::json;

namespace {

json written(const Entry& e) {
  json j = {{"operator", e.op}, {"explicit", e.is_explicit}, {"bytes", e.bytes}, {"product_error", number(e.product_error)},
            {"force_error", number(e.force_error)}, {"motion_error", number(e.motion_error)}, {"error_bound", e.bound < 0 ? json(nullptr) : number(e.bound)}};
  for (std::size_t u = 0; u < use_count; ++u) {
    json& of = j["uses"][name(use(u))];
    of = e.why_not[u].empty() ? json{{"microseconds", written(e.time[u])}} : json{{"none", e.why_not[u]}};
    if (e.lines[u] >= 0) of["cache_lines"] = e.lines[u];
  }
  return j;
}

Entry entry_read(const json& j) {
  Entry e;
  e.op = j.at("operator");
  e.is_explicit = j.at("explicit");
  e.bytes = j.at("bytes");
  e.product_error = number_of(j.at("product_error"));
  e.force_error = number_of(j.at("force_error"));
  e.motion_error = number_of(j.at("motion_error"));
  e.bound = j.at("error_bound").is_null() ? -1 : j.at("error_bound").get<double>();
  for (std::size_t u = 0; u < use_count; ++u) {
    const json& of = j.at("uses").at(name(use(u)));
    e.why_not[u] = of.value("none", "");
    if (e.why_not[u].empty()) e.time[u] = spread_read(of.at("microseconds"));
    e.lines[u] = of.value("cache_lines", std::int64_t{-1});
  }
  return e;
}

json written(const TableRow& r) {
  json j = {{"scene", r.scene}, {"dof", r.dofs}, {"rows", r.rows}, {"loops", r.loops}, {"provisional_pose", r.provisional_pose},
            {"damping", {{"smallest", r.smallest_damping}, {"largest", r.largest_damping}}}, {"condition", number(r.condition)},
            {"product_reference", r.product_reference}, {"truth_unknown", r.truth_unknown}, {"kinematics_microseconds", written(r.kinematics)}};
  j["operators"] = json::array();
  for (const Entry& e : r.entries) j["operators"].push_back(written(e));
  return j;
}

TableRow row_read(const json& j) {
  TableRow r;
  r.scene = j.at("scene");
  r.dofs = j.at("dof");
  r.rows = j.at("rows");
  r.loops = j.at("loops");
  r.provisional_pose = j.at("provisional_pose");
  r.smallest_damping = j.at("damping").at("smallest");
  r.largest_damping = j.at("damping").at("largest");
  r.condition = number_of(j.at("condition"));
  r.product_reference = j.at("product_reference");
  r.truth_unknown = j.at("truth_unknown");
  r.kinematics = spread_read(j.at("kinematics_microseconds"));
  for (const json& e : j.at("operators")) r.entries.push_back(entry_read(e));
  return r;
}

}  // namespace

void to_json(json& j, const TableOne& t) {
  const Machine& m = t.machine;
  j = {{"machine", {{"processor", m.processor}, {"cores", m.cores}, {"system", m.system}, {"compiler", m.compiler}, {"flags", m.flags},
                    {"revision", m.revision}, {"date", m.date}, {"kernels", t.kernels}, {"load", t.load}}},
       {"units", {{"time", "µs per call"}, {"memory", "bytes"}, {"damping", "1/kg"}}}, {"budget_seconds", t.budget},
       {"cache_lines_with", t.lines_counted_with}, {"interrupted", t.interrupted}, {"table1", json::array()}};
  for (const TableRow& r : t.rows) j["table1"].push_back(written(r));
}

void from_json(const json& j, TableOne& t) {
  const json& m = j.at("machine");
  t.machine = {m.at("processor"), m.at("system"), m.at("compiler"), m.at("flags"), m.at("revision"), m.at("date"), m.at("cores")};
  t.kernels = m.at("kernels");
  t.load = m.at("load");
  t.budget = j.at("budget_seconds");
  t.lines_counted_with = j.at("cache_lines_with");
  t.interrupted = j.at("interrupted");
  t.rows.clear();
  for (const json& r : j.at("table1")) t.rows.push_back(row_read(r));
}

}  // namespace delassus::bench
