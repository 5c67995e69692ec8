#include "simulation/integrators.h"

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "algorithms/errors/status.h"
#include "simulation/tableaus.h"

namespace delassus::simulation {

const std::vector<IntegratorRow>& integrators() {
  static const std::vector<IntegratorRow> table{
      {"euler", "semi-implicit Euler at velocity level, springs and dampers implicit", "Stewart, Trinkle 1996", 1, Takes::cones, nullptr, false},
      {"runge_kutta", "the classical method on the manifold, explicit", "Munthe-Kaas 1998", 4, Takes::equations, &classical(), false},
      {"dormand_prince", "a pair of orders 5 and 4 on the manifold, explicit: its steps may follow their error", "Dormand, Prince 1980", 5, Takes::equations, &dormand_prince(), true},
      {"implicit_midpoint", "Gauss with one stage on the manifold: symmetric, energy does not drift", "Hairer, Lubich, Wanner 2006", 2, Takes::equations, &implicit_midpoint(), false},
      {"sdirk4", "five implicit stages on the manifold, L-stable: stiff springs and dampers at any step; a pair of orders 4 and 3", "Hairer, Wanner 1996", 4, Takes::equations, &sdirk4(), true}};
  return table;
}

const IntegratorRow& find_integrator(std::string_view wanted) {
  for (const IntegratorRow& row : integrators())
    if (row.name == wanted) return row;
  throw ModelError("", "integrator", "there is no integrator " + in_quotes(wanted), accepted_names(wanted, integrators()));
}

}  // namespace delassus::simulation
