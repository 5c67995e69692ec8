#include "cli/simulate_explain.h"

#include <cstdio>

#include "algorithms/kit/counted.h"
#include "bench/text.h"

namespace delassus::cli {

namespace {

constexpr int steps_counted = 4;

/// Operations of a step; −1 where one fails.
std::int64_t operations(const Scene& scene, const simulation::Settings& settings) {
  simulation::Simulation<Counted> s(scene, settings);
  if (!s.step().ok()) return -1;
  operation_count = {};
  for (int k = 0; k < steps_counted; ++k)
    if (!s.step().ok()) return -1;
  return operation_count.total() / steps_counted;
}

/// Islands of the first step; −1 where it fails.
Index islands(const Scene& scene, const simulation::Settings& settings) {
  simulation::Simulation<double> s(scene, settings);
  const auto& report = s.step();
  return report.ok() ? report.islands : -1;
}

json known(std::int64_t n) { return n < 0 ? json(nullptr) : json(n); }

}  // namespace

json explain_json(const Scene& scene, const simulation::Settings& settings) {
  const simulation::Plan<double> plan(scene, settings);
  const std::int64_t all = operations(scene, settings);
  json out = {{"path", plan.path->name()}, {"step", settings.step}, {"bytes", plan.bytes()}, {"path_bytes", plan.path->bytes()},
              {"operations", known(all)}, {"islands", known(islands(scene, settings))}, {"effects", json::array()}};
  for (const auto& line : plan.lines) {
    json e = {{"name", line.effect->name}, {"in", line.in}, {"called_for", line.call.called}, {"why", line.call.why}, {"terms", line.terms}, {"bytes", line.bytes}, {"operations", 0}};
    if (line.in) {
      simulation::Settings without = settings;
      without.without.emplace_back(line.effect->name);
      const std::int64_t rest = operations(scene, without);
      e["operations"] = known(all < 0 || rest < 0 ? -1 : std::max<std::int64_t>(0, all - rest));
    }
    out["effects"].push_back(e);
  }
  return out;
}

void print_explain(const json& j) {
  const auto count = [](const json& n) { return n.is_null() ? std::string("–") : bench::short_count(n); };
  std::printf("%-2s%s  %s  %10s  %10s  why\n", "", bench::pad_right("effect", 19).c_str(), bench::pad_right("terms", 16).c_str(), "bytes", "operations");
  for (const json& e : j["effects"]) {
    const bool in = e["in"];
    std::printf("%-2s%s  %s  %10s  %10s  %s\n", in ? "+" : "-", bench::pad_right(e["name"], 19).c_str(), bench::pad_right(e["terms"], 16).c_str(),
                in ? bench::short_bytes(e["bytes"]).c_str() : "", in ? count(e["operations"]).c_str() : "", e["why"].get<std::string>().c_str());
  }
  std::printf("a step: path %s, %s operations%s, %s islands with rows in the first; effects hold %s, the path %s\n", j["path"].get<std::string>().c_str(), count(j["operations"]).c_str(),
              j["path"] == "cones" ? " beside those of the solver" : "", count(j["islands"]).c_str(), bench::short_bytes(j["bytes"]).c_str(), bench::short_bytes(j["path_bytes"]).c_str());
}

void print_prices(const json& j) {
  std::printf("| effect | terms | bytes | operations |\n|---|---|---|---|\n");
  for (const json& e : j["effects"])
    if (e["in"].get<bool>()) std::printf("| %s | %s | %s | %s |\n", e["name"].get<std::string>().c_str(), e["terms"].get<std::string>().c_str(), e["bytes"].dump().c_str(), e["operations"].is_null() ? "–" : e["operations"].dump().c_str());
  std::printf("| **a step** | path %s | %s | %s |\n", j["path"].get<std::string>().c_str(), j["bytes"].dump().c_str(), j["operations"].is_null() ? "–" : j["operations"].dump().c_str());
}

}  // namespace delassus::cli
