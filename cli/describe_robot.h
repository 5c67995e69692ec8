// What a user of a robot needs to know first: base, joints, masses, what follows what.
#pragma once

#include "cli/common.h"

namespace delassus::cli {

/// [{name, base, dof, links, bodies, mass, joints: [{name, type, dof, lower, upper, armature, follows}], massless}] of a
/// scene's robots; mass in kg, of what moves; limits in rad or m, null: none.
[[nodiscard]] json robots_json(const Scene& scene);

/// A line per robot; with `joints_too` a line per joint as well.
void print_robots(const json& robots, bool joints_too);

}  // namespace delassus::cli
