// The table of laws, and which of them applies to which operator.
#pragma once

#include "cli/common.h"

namespace delassus::cli {

/// [{name, summary, bound, operators: {operator: true, or why the law never applies}}], found out on small pinned problems.
[[nodiscard]] json laws_json();
/// A line per law, a column per operator: ✓, or the letter of a reason.
void print_applies(const json& laws);
/// The same as a table for a page: a line per set of laws that apply to the same operators.
void print_applies_markdown(const json& laws);

}  // namespace delassus::cli
