// Rows and degrees of freedom in the words of the scene, and what a report says in them.
#pragma once

#include <string>

#include "algorithms/delassus.h"
#include "algorithms/mechanism/model.h"

namespace delassus::cli {

/// "weld r/l6 - world, row 5 of 6"; the constraint's own name where it has one. Rows count from 1 within a constraint.
[[nodiscard]] std::string row_name(const Model& model, Index row);
/// "r/j1"; "r/base, degree of freedom 3 of 6" of a joint with several.
[[nodiscard]] std::string joint_name(const Model& model, Index dof);

/// Units of a row's acceleration and force: m/s² and N; of rows that turn rad/s² and N m; "" of general rows.
struct Units {
  const char *acceleration, *force;
};
[[nodiscard]] Units row_units(const Model& model, Index row);

/// "at joint r/j1 (…)" or "at row 4 (weld r/l6 - world, row 5 of 6)"; empty where the report names nothing. `singular`: M
/// itself has no factor at this pose.
[[nodiscard]] std::string place(const Model& model, const Report& report, bool singular);

}  // namespace delassus::cli
