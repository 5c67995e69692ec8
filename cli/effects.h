// Which physical effects a scene calls for, which it does not, and why: read off the scene, for people. And how scenes are stepped.
#pragma once

#include "cli/common.h"

namespace delassus::cli {

/// [{name, summary}]: the table of effects.
[[nodiscard]] json effects_list();
/// [{name, called_for, why}] in the order of the table.
[[nodiscard]] json effects_json(const Scene& scene);

/// [{name, summary, order, takes, controlled, source}]: the table of integrators.
[[nodiscard]] json integrators_list();
void print_integrators_markdown(const json& integrators);

}  // namespace delassus::cli
