// `delassus simulate --explain`: what of a scene is in the plan and why, and what each effect costs a step.
#pragma once

#include "cli/common.h"
#include "simulation/step.h"

namespace delassus::cli {

/// {path, step, bytes, operations, islands, effects: [{name, in, why, terms, bytes, operations}]}: operations of a step, of an effect those that a
/// step has less without it; null where a step fails, contact solvers not counted. Cost: some steps for each effect.
[[nodiscard]] json explain_json(const Scene& scene, const simulation::Settings& settings);
void print_explain(const json& j);
void print_prices(const json& j);  ///< a table in Markdown of the effects that are in

}  // namespace delassus::cli
