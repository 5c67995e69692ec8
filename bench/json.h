// Numbers in files of results, written and read back in one way: what is not finite is null.
#pragma once

#include <cmath>

#include <nlohmann/json.hpp>

#include "bench/interleaved.h"

namespace delassus::bench {

[[nodiscard]] inline nlohmann::json number(double x) { return std::isfinite(x) ? nlohmann::json(x) : nlohmann::json(nullptr); }
[[nodiscard]] inline double number_of(const nlohmann::json& j) { return j.is_null() ? NAN : j.get<double>(); }

/// {median, quartiles, rounds}; null: not measured.
[[nodiscard]] inline nlohmann::json written(const Spread& s) {
  if (!s.measured()) return nullptr;
  return {{"median", s.median}, {"quartiles", {s.low, s.high}}, {"rounds", s.rounds}};
}
[[nodiscard]] inline Spread spread_read(const nlohmann::json& j) {
  if (j.is_null()) return {};
  return {j.at("median"), j.at("quartiles").at(0), j.at("quartiles").at(1), j.at("rounds")};
}

}  // namespace delassus::bench
