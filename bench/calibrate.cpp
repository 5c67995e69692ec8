// The table of kernels by least squares: nanoseconds per counted quantity, row by row and phase by phase.
#include <algorithm>
#include <cmath>

#include "bench/machine.h"
#include "bench/phase_times.h"
#include "bench/text.h"

namespace delassus::bench {

namespace {

using Q = Quantities;
using Names = std::vector<Q::Name>;

constexpr const char* quantity_names[] = {"one", "bodies", "dofs", "active_bodies", "active_dofs", "rows", "link_rows", "joint_rows", "couplings", "depth", "row_depth",
                                          "row_pairs", "row_bodies", "row_dofs", "row_links", "row_packets", "row_singles", "rows_squared", "rows_cubed", "tiles", "tile_pairs"};
static_assert(std::size(quantity_names) == Q::count);
constexpr const char* phase_names[] = {"update", "damping", "product", "solve", "product_of_eight", "solve_of_eight"};
static_assert(std::size(phase_names) == phase_count);

/// What a phase of a row may depend on, by its algorithm.
struct Form {
  const char* op;
  std::array<Names, phase_count> of;  // empty: no such phase
};

const Names vector_sweep{Q::one, Q::active_bodies, Q::active_dofs, Q::rows, Q::link_rows, Q::joint_rows};
const Names coupled_sweep{Q::one, Q::active_bodies, Q::active_dofs, Q::rows, Q::link_rows, Q::joint_rows, Q::couplings};
const Names dense_product{Q::one, Q::rows, Q::row_packets, Q::row_singles};
const Names tiled{Q::one, Q::rows, Q::tiles};
const Names tiled_factor{Q::one, Q::rows, Q::tiles, Q::tile_pairs};
const Names dense_factor{Q::one, Q::rows, Q::rows_squared, Q::rows_cubed};
const Names free_update{Q::one, Q::bodies, Q::dofs, Q::rows, Q::link_rows, Q::joint_rows};
const Names coupled_update{Q::one, Q::bodies, Q::dofs, Q::rows, Q::link_rows, Q::joint_rows, Q::couplings};
const Names columns_update{Q::one, Q::bodies, Q::dofs, Q::rows, Q::joint_rows, Q::row_bodies, Q::row_dofs, Q::row_links, Q::rows_squared, Q::rows_cubed};
const Names tiled_columns_update{Q::one, Q::bodies, Q::dofs, Q::rows, Q::joint_rows, Q::row_bodies, Q::row_dofs, Q::row_links, Q::rows_squared, Q::tiles, Q::tile_pairs};
const Names branch_update{Q::one, Q::dofs, Q::depth, Q::rows, Q::joint_rows, Q::row_depth, Q::row_pairs, Q::tiles, Q::tile_pairs};
const Names inverse_update{Q::one, Q::bodies, Q::dofs, Q::rows, Q::link_rows, Q::joint_rows, Q::couplings, Q::row_depth, Q::row_pairs, Q::rows_squared};
const Names mixed_solve{Q::one, Q::active_bodies, Q::active_dofs, Q::rows, Q::link_rows, Q::joint_rows, Q::rows_squared};

const std::vector<Form>& forms() {
  static const std::vector<Form> all{
      {"aba_sweep", {free_update, {Q::one, Q::rows}, vector_sweep, {}, vector_sweep, {}}},
      {"lcaba", {coupled_update, coupled_update, {}, coupled_sweep, {}, coupled_sweep}},
      {"explicit_columns", {tiled_columns_update, tiled_factor, tiled, tiled, tiled, tiled}},
      {"ltl_osim", {branch_update, tiled_factor, tiled, tiled, tiled, tiled}},
      {"caba_osim", {inverse_update, inverse_update, {}, dense_product, {}, dense_product}},
      {"caba_osimr", {inverse_update, inverse_update, {}, dense_product, {}, dense_product}},
      {"ladder", {coupled_update, coupled_update, {}, coupled_sweep, {}, coupled_sweep}},
      {"kkt_elimination", {columns_update, dense_factor, dense_product, mixed_solve, dense_product, mixed_solve}}};
  return all;
}

/// c ≥ 0 that makes Σ w (Σ_j c_j q_j / t − 1)² least: coordinate by coordinate, columns of length one.
std::vector<double> least_squares(const std::vector<std::vector<double>>& q, const std::vector<double>& t, const std::vector<double>& w, std::size_t unknowns) {
  Eigen::MatrixXd G(q.size(), unknowns);
  for (std::size_t i = 0; i < q.size(); ++i)
    for (std::size_t j = 0; j < unknowns; ++j) G(i, j) = std::sqrt(w[i]) * q[i][j] / t[i];
  const Eigen::VectorXd length = G.colwise().norm();
  for (std::size_t j = 0; j < unknowns; ++j)
    if (length[j] > 0) G.col(j) /= length[j];
  Eigen::VectorXd c = Eigen::VectorXd::Zero(unknowns), left(q.size());
  for (std::size_t i = 0; i < q.size(); ++i) left[i] = std::sqrt(w[i]);
  for (int sweep = 0; sweep < 100000; ++sweep) {
    double moved = 0;
    for (std::size_t j = 0; j < unknowns; ++j) {
      if (length[j] == 0) continue;
      const double step = std::max(G.col(j).dot(left), -c[j]);
      c[j] += step;
      left -= step * G.col(j);
      moved = std::max(moved, std::abs(step));
    }
    if (moved < 1e-9) break;
  }
  std::vector<double> out;
  for (std::size_t j = 0; j < unknowns; ++j) out.push_back(length[j] > 0 ? c[j] / length[j] : 0);
  return out;
}

const RowTimes* find(const ChoiceRow& row, std::string_view op) {
  const auto found = std::find_if(row.times.begin(), row.times.end(), [&](const RowTimes& r) { return r.op == op; });
  return found == row.times.end() ? nullptr : &*found;
}

}  // namespace

std::vector<const OperatorRow*> calibrated_rows() {
  std::vector<const OperatorRow*> rows;
  for (const Form& f : forms()) rows.push_back(&find_operator(f.op));
  return rows;
}

std::string calibrated(const std::vector<ChoiceRow>& rows) {
  const Machine machine = this_machine();
  std::string s = "// Nanoseconds of the kernels per counted quantity (choose.h). Printed by `delassus bench --calibrate`, which measures every row on\n"
                  "// scenes, swimmers and families, and takes least squares of the relative errors, a scene as eight others, no term negative; not to be edited by hand.\n// " +
                  machine.processor + "; " + machine.compiler + "; kernels " + std::string(kernels()) + "; " + std::to_string(rows.size()) +
                  " problems.\n#include \"algorithms/operators/kernel_costs.h\"\n\nnamespace delassus {\n\n"
                  "const std::vector<KernelCost>& kernel_costs() {\n  using enum Quantities::Name;\n  static const std::vector<KernelCost> table{\n";
  for (const Form& f : forms())
    for (std::size_t phase = 0; phase < phase_count; ++phase) {
      const Names& names = f.of[phase];
      std::vector<std::vector<double>> q;
      std::vector<double> t, w;
      for (const ChoiceRow& row : rows) {
        const RowTimes* const r = find(row, f.op);
        if (r == nullptr || std::isnan(r->time[phase])) continue;
        t.push_back(1e3 * r->time[phase]), w.push_back(row.weight);
        q.emplace_back();
        for (const Q::Name name : names) q.back().push_back(row.quantities.of[name]);
      }
      if (names.empty() || q.empty()) continue;
      const std::vector<double> c = least_squares(q, t, w, names.size());
      s += std::string("      {\"") + f.op + "\", Phase::" + phase_names[phase] + ", {";
      const char* between = "";
      for (std::size_t j = 0; j < names.size(); ++j)
        if (c[j] > 0) s += between + format("{%s, %.3g}", quantity_names[names[j]], c[j]), between = ", ";
      s += "}},\n";
    }
  return s + "  };\n  return table;\n}\n\n}  // namespace delassus\n";
}

std::string predictions_text(const std::vector<ChoiceRow>& rows) {
  std::vector<std::vector<std::string>> table{{"row", "phase", "problems", "median error", "90 %", "largest", "at"}};
  for (const Form& f : forms())
    for (std::size_t phase = 0; phase < phase_count; ++phase) {
      std::vector<std::pair<double, std::string>> off;
      for (const ChoiceRow& row : rows)
        if (const RowTimes* const r = find(row, f.op); r != nullptr && !std::isnan(r->time[phase]))
          if (const double p = predicted(f.op, row.quantities)[phase]; !std::isnan(p)) off.emplace_back(std::abs(1e-3 * p / r->time[phase] - 1), row.scene);
      if (off.empty()) continue;
      std::sort(off.begin(), off.end());
      table.push_back({f.op, phase_names[phase], std::to_string(off.size()), format("%.0f %%", 100 * off[off.size() / 2].first),
                       format("%.0f %%", 100 * off[off.size() * 9 / 10].first), format("%.0f %%", 100 * off.back().first), off.back().second});
    }
  return markdown_table(table, 2);
}

}  // namespace delassus::bench
