// Counts heap allocations of this program by wrapping malloc (glibc; left out under the address sanitizer).
#pragma once

#include <cstdint>

namespace delassus::laws {

/// Sets laws::allocation_count where counting is possible.
void count_allocations();

}  // namespace delassus::laws
