// Whether an operator refuses what delassus.h calls misuse: phases, shapes, workspaces, sizes of a damping.
#pragma once

#include <string>

#include "algorithms/delassus.h"

namespace delassus {

/// The first misuse that is accepted, or the first proper use that is refused, in words; empty: none.
[[nodiscard]] std::string misuse_accepted(const OperatorRow& row);

}  // namespace delassus
