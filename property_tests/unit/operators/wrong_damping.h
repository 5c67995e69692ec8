// Whether an operator says bad_damping of every damping that cannot be right, and of no other; and what it answers after it.
#pragma once

#include <string>

#include "algorithms/delassus.h"

namespace delassus {

/// The first wrong damping that is taken, or the first right one that is refused, in words; empty: none.
[[nodiscard]] std::string wrong_damping_taken(const OperatorRow& row);

}  // namespace delassus
