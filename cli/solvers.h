// The table of contact solvers, for `delassus list`.
#pragma once

#include "cli/common.h"

namespace delassus::cli {

/// [{name, summary, equations, certificate, source, cost, takes: [what], hard_rows, given_matrix}] in the order of the table.
[[nodiscard]] json solvers_list();
void print_solvers_markdown(const json& solvers);

}  // namespace delassus::cli
