#include "cli/effects.h"

#include "simulation/effects.h"

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

}  // namespace delassus::cli
