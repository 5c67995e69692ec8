// Which physical effects a scene calls for, which it does not, and why: read off the scene, for people.
#pragma once

#include "cli/common.h"

namespace delassus::cli {

/// [{name, called_for, why}] in a fixed order.
[[nodiscard]] json effects_json(const Scene& scene);

}  // namespace delassus::cli
