// One operator on one problem: time, counted operations, memory.
#pragma once

#include "algorithms/delassus.h"
#include "algorithms/mechanism/model.h"
#include "bench/results.h"
#include "bench/table1/uses.h"

namespace delassus::bench {

/// How long a phase may be watched.
struct Limits {
  double budget = 0.02;          ///< seconds per phase
  double longest_counted = 0.1;  ///< operations are counted only where update, apply and solve together are faster [s]
};

/// Times every phase the row has and counts its operations. Numerical outcomes end up in the cell's statuses.
[[nodiscard]] Cell measure(const OperatorRow& row, const Problem<double>& problem, const Damping<double>& damping,
                           const Limits& limits);

/// Operations of each phase, counted with the scalar Counted; −1 for a phase the row does not have, and for rows that
/// cannot be counted.
[[nodiscard]] Operations count_operations(const OperatorRow& row, const Problem<double>& problem,
                                          const Damping<double>& damping);

/// Time of kinematics(model, q) into given storage.
[[nodiscard]] Timing time_kinematics(const Model& model, const VectorX<double>& q, double budget);

}  // namespace delassus::bench
