#include "bench/json.h"
#include "bench/simulation/simulation_speed.h"

namespace delassus::bench {

using nlohmann::json;

namespace {

/// null: not judged; not finite is the largest error, and written so.
json written(double x) { return std::isinf(x) ? json("infinite") : number(x); }
double at(const json& j, const char* key) { return j.at(key).is_string() ? INFINITY : number_of(j.at(key)); }
json written(const StepResidual& r) { return {{"natural", written(r.natural)}, {"approach", written(r.approach)}, {"cone", written(r.cone)}, {"momentum", written(r.momentum)}, {"depth", written(r.depth)}}; }
StepResidual residual_read(const json& j) { return {at(j, "natural"), at(j, "approach"), at(j, "cone"), at(j, "momentum"), at(j, "depth")}; }

json written(const SpeedScene& s, const SpeedEntry& e) {
  return {{"example", s.example.name}, {"scene", s.example.scene}, {"without", s.example.without}, {"robot", s.example.robot}, {"residual", s.example.residual}, {"asked_steps", s.example.steps}, {"dof", s.dofs},
          {"name", e.name}, {"program", e.program}, {"what", e.what}, {"cannot", e.cannot}, {"disagrees", e.disagrees}, {"ended", e.ended}, {"M_error", number(e.M_error)},
          {"free_error", number(e.free_error)}, {"asked", number(e.asked)}, {"median", written(e.median)}, {"worst", written(e.worst)}, {"steps", e.steps}, {"contacts", e.contacts},
          {"rows", e.rows}, {"iterations", number(e.iterations)}, {"microseconds_a_step", written(e.time)}};
}

SpeedEntry speed_entry_read(const json& j) {
  SpeedEntry e;
  e.name = j.at("name"), e.program = j.at("program"), e.what = j.at("what");
  e.cannot = j.at("cannot"), e.disagrees = j.at("disagrees"), e.ended = j.at("ended");
  e.M_error = number_of(j.at("M_error")), e.free_error = number_of(j.at("free_error")), e.asked = number_of(j.at("asked"));
  e.median = residual_read(j.at("median")), e.worst = residual_read(j.at("worst"));
  e.steps = j.at("steps"), e.contacts = j.at("contacts"), e.rows = j.at("rows");
  e.iterations = number_of(j.at("iterations"));
  e.time = spread_read(j.at("microseconds_a_step"));
  return e;
}

}  // namespace

void to_json(json& j, const SimulationSpeed& t) {
  j = {{"units", {{"time", "µs"}, {"natural, approach", "m/s"}, {"cone, momentum", "N s"}, {"depth", "m"}}}, {"step_seconds", speed_step}, {"speeds", json::array()}};
  write(j, t);
  for (const SpeedScene& s : t.scenes)
    for (const SpeedEntry& e : s.entries) j["speeds"].push_back(written(s, e));
}

void from_json(const json& j, SimulationSpeed& t) {
  read(j, t);
  t.scenes.clear();
  for (const json& s : j.at("speeds")) {
    if (t.scenes.empty() || t.scenes.back().example.name != s.at("example").get<std::string>()) {
      SpeedScene& scene = t.scenes.emplace_back();
      scene.example = {s.at("example"), s.at("scene"), s.at("residual"), s.at("asked_steps"), s.at("robot"), s.at("without").get<std::vector<std::string>>()};
      scene.dofs = s.at("dof");
    }
    t.scenes.back().entries.push_back(speed_entry_read(s));
  }
}

}  // namespace delassus::bench
