#include "cli/effects.h"

#include <cstdio>

#include "simulation/effects.h"
#include "simulation/integrators.h"

namespace delassus::cli {

json effects_list() {
  json out = json::array();
  for (const auto& e : simulation::effects())
    out.push_back({{"name", e.name}, {"summary", e.summary}, {"called_by", e.called_by}, {"energy", simulation::name(e.energy)}});
  return out;
}

json effects_json(const Scene& scene) {
  json out = json::array();
  for (const auto& e : simulation::effects()) {
    const simulation::Call call = e.call(scene);
    out.push_back({{"name", e.name}, {"called_for", call.called}, {"why", call.why}});
  }
  return out;
}

json integrators_list() {
  json out = json::array();
  for (const auto& i : simulation::integrators())
    out.push_back({{"name", i.name}, {"summary", i.summary}, {"order", i.order}, {"takes", i.takes == simulation::Takes::cones ? "all" : "equations, hard"}, {"controlled", i.controlled}, {"source", i.source}});
  return out;
}

void print_integrators_markdown(const json& integrators) {
  std::printf("| integrator | what it is | order | rows | `--accuracy` | source |\n|---|---|---|---|---|---|\n");
  for (const json& i : integrators)
    std::printf("| `%s` | %s | %d | %s | %s | %s |\n", i["name"].get<std::string>().c_str(), i["summary"].get<std::string>().c_str(), i["order"].get<int>(),
                i["takes"].get<std::string>().c_str(), i["controlled"].get<bool>() ? "yes" : "no", i["source"].get<std::string>().c_str());
}

}  // namespace delassus::cli
