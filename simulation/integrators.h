// The table of integrators: how a state goes on from accelerations or velocities.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace delassus::simulation {

struct Tableau;

/// The rows an integrator takes: none, those that always hold, also those in cones.
enum class Takes : std::uint8_t { none, equations, cones };

struct IntegratorRow {
  std::string_view name, summary, source;
  int order;   ///< global error h^order on smooth scenes
  Takes takes;
  const Tableau* tableau;  ///< of methods with stages; nullptr: semi-implicit
  bool controlled;         ///< a pair: its steps may follow their error
};

[[nodiscard]] const std::vector<IntegratorRow>& integrators();
/// @throws ModelError listing the accepted names.
[[nodiscard]] const IntegratorRow& find_integrator(std::string_view name);

}  // namespace delassus::simulation
