// The table of integrators: how a state goes on from accelerations or velocities.
#pragma once

#include <string_view>
#include <vector>

namespace delassus::simulation {

struct IntegratorRow {
  std::string_view name, summary, source;
  int order;   ///< global error h^order on smooth scenes
  bool rows;   ///< takes scenes with rows: equations and cones
};

[[nodiscard]] const std::vector<IntegratorRow>& integrators();
/// @throws ModelError listing the accepted names.
[[nodiscard]] const IntegratorRow& find_integrator(std::string_view name);

}  // namespace delassus::simulation
