// What a measurement was made with.
#pragma once

#include "bench/results.h"

namespace delassus::bench {

/// Processor and system as the operating system names them, compiler and flags as built, revision at build time, now.
[[nodiscard]] Machine this_machine();

void to_json(nlohmann::json& j, const Machine& m);
/// @throws nlohmann::json::exception for anything else than to_json wrote.
void from_json(const nlohmann::json& j, Machine& m);

/// Largest resident memory of this process so far [bytes].
[[nodiscard]] std::int64_t peak_memory();

}  // namespace delassus::bench
