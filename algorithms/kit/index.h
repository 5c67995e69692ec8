// Counts as the standard library has them.
#pragma once

#include <cstddef>

#include "algorithms/kit/spatial.h"

namespace delassus {

[[nodiscard]] constexpr std::size_t z(Index i) { return static_cast<std::size_t>(i); }

}  // namespace delassus
