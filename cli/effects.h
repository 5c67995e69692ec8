// Which physical effects a scene calls for, which it does not, and why: read off the scene, for people.
#pragma once

#include "cli/common.h"

namespace delassus::cli {

/// [{name, summary}]: the table of effects.
[[nodiscard]] json effects_list();
/// [{name, called_for, why}] in the order of the table.
[[nodiscard]] json effects_json(const Scene& scene);

}  // namespace delassus::cli
