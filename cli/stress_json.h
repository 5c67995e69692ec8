// Files of a randomised search: a failure (read by `replay`) and the report of a shard (read by `stress --merge`).
#pragma once

#include "cli/common.h"
#include "property_tests/laws/search.h"

namespace delassus::cli {

/// A whole file. @throws ModelError when it cannot be read.
[[nodiscard]] std::string read_text(const std::string& file);
/// @throws ModelError when it cannot be written.
void write_text(const std::string& file, const std::string& text);

/// {law, operator, ratio, note, seed, found_bodies, tried, spec}. ratio: a number or "infinity".
[[nodiscard]] json failure_json(const laws::Failure& f);
/// @throws ModelError naming file and element.
[[nodiscard]] laws::Failure read_failure(const json& j, const std::string& file);

/// {seed, shard, shards, problems, checks, skipped, seconds, classes: {name: problems}, failures: [failure]}.
[[nodiscard]] json found_json(const laws::Found& f);
[[nodiscard]] laws::Found read_found(const json& j, const std::string& file);

}  // namespace delassus::cli
