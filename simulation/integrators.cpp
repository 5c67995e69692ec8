#include "simulation/integrators.h"

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "algorithms/errors/status.h"

namespace delassus::simulation {

const std::vector<IntegratorRow>& integrators() {
  static const std::vector<IntegratorRow> table{
      {"euler", "semi-implicit Euler at velocity level, springs and dampers implicit", "Stewart, Trinkle 1996", 1, true},
      {"runge_kutta", "the classical method on the manifold, explicit", "Munthe-Kaas 1998", 4, false}};
  return table;
}

const IntegratorRow& find_integrator(std::string_view wanted) {
  for (const IntegratorRow& row : integrators())
    if (row.name == wanted) return row;
  throw ModelError("", "integrator", "there is no integrator " + in_quotes(wanted), accepted_names(wanted, integrators()));
}

}  // namespace delassus::simulation
