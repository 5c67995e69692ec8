// Scaling ladders: how the counted operations of every operator and phase grow, against what is declared.
//
// What     mechanisms of one kind in sizes s that double (generators/ladders.h); operations counted by the scalar Counted, so that no
//          clock and no machine has a part in it; the terms that are declared (declared_orders.h) summed at the same sizes.
// Order    what is counted on a ladder is f(s) = Σ c_pj sᵖ (log s)ʲ, exactly. Then f(2s) − 2ᵖ f(s) holds no sᵖ, and of sᵖ log s no
//          logarithm: with all terms below the declared one taken out like this, what is left doubles with
//            p = log₂ (g(2s)/g(s)).
//          The declared terms, which go through the same, say where to stop: at the last one before nothing is left of them. A term of
//          higher order stays in, a smaller one leaves nothing: either is not p.
// Where the order of elimination follows no rule (walls, pyramids, lattices) there are no such terms. There f is fitted by least squares of
//          the relative errors with the declared terms, at all sizes but the last, and has to arrive there as the fit says: p is
//          log f over log s in the last doubling, against that of the fit.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "algorithms/operators/declared_orders.h"
#include "algorithms/operators/operators.h"
#include "bench/results.h"
#include "generators/ladders.h"

namespace delassus::bench {

/// One operator at one size; −1: has no such phase.
struct ScalingCell {
  std::string op, skipped;                    ///< skipped: why it was left out from here on; empty: it was not
  std::array<std::int64_t, asks_count> operations{-1, -1, -1, -1, -1};
  std::int64_t whole = -1, bytes = -1;        ///< a solve of as many steps as it needs
  int steps = 0;                              ///< that it took
  std::string status;                         ///< that it ended with
};
struct ScalingSize {
  std::int64_t s = 0, bodies = 0, dofs = 0, rows = 0;
  std::vector<double> terms;                  ///< of declared_orders.h
  std::vector<ScalingCell> cells;
};
struct ScalingLadder {
  std::string name;
  std::vector<ScalingSize> sizes;
};
struct Scaling {
  Machine machine;
  double budget = 0, most_bytes = 0;          ///< counted operations of one phase, bytes of an operator
  std::vector<ScalingLadder> ladders;
};

struct Order {
  double measured = NAN, declared = NAN;      ///< NaN: sizes are too few, or there is nothing left to measure
  int logarithms = 0;                         ///< that the declared one has beside
  [[nodiscard]] bool agree() const { return std::abs(measured - declared) <= 0.02; }
};
/// Of counts and of the sums of declared terms at sizes s, 2s, 4s, …; the sums may go on to larger sizes.
[[nodiscard]] Order order_of(const std::vector<int>& powers, const std::vector<double>& counts, const std::vector<double>& declared);
/// Of counts at any sizes, and of every declared term at them, one vector per size.
[[nodiscard]] Order order_by_fit(const std::vector<double>& sizes, const std::vector<double>& counts, const std::vector<std::vector<double>>& terms);
/// Of one operator and phase on a measured ladder; solves with refinement up to where they take as many steps as at first. @throws as find_ladder, declared_orders.
[[nodiscard]] Order order_of(const ScalingLadder& ladder, std::string_view op, Asks what);

struct ScalingOptions {
  double budget = 5e8, most_bytes = 1e9;      ///< an operator is left out where one of its phases would go beyond
  bool gate = false;                          ///< sizes up to LadderRow::gate
  std::function<void(const std::string&)> progress;   ///< a line per size
  std::function<bool()> stop;                 ///< asked before each
};
[[nodiscard]] Scaling measure_scaling(const std::vector<const generators::LadderRow*>& ladders, const std::vector<const OperatorRow*>& rows, const ScalingOptions& options);

/// Ladders, orders, crossovers in Markdown.
[[nodiscard]] std::string scaling_text(const Scaling& s);
/// Counted operations of a phase over the size: an SVG; empty without gnuplot, or without that ladder.
[[nodiscard]] std::string scaling_picture(const Scaling& s, const std::string& ladder, Asks what);

void to_json(nlohmann::json& j, const Scaling& s);
/// @throws nlohmann::json::exception for anything else than to_json wrote.
void from_json(const nlohmann::json& j, Scaling& s);

}  // namespace delassus::bench
