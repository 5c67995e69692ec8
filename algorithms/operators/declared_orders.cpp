#include "algorithms/operators/declared_orders.h"

#include "algorithms/errors/status.h"
#include <algorithm>

#include "algorithms/factors/coupled_rows.h"
#include "algorithms/factors/front_plan.h"

namespace delassus {
namespace {

using enum Term;
using Terms = std::vector<Term>;

struct Row {
  std::string_view op;
  Declared is;
};

// An explicit row: how its matrix is formed, then products, and the factor of A.
Declared explicit_row(const Terms& form) {
  Terms with_product = form, with_factor = form;
  with_product.push_back(fill);
  with_factor.insert(with_factor.end(), {fill, fill_squares});
  return {with_product, with_factor, {rows, fill}, {rows, fill}, {rows, fill, fill_squares}};
}

const std::vector<Row>& table() {
  const Terms sweep{active_dofs, rows, link_rows}, update{dofs, active_dofs, rows, link_rows};
  const Terms coupled_sweep{active_dofs, rows, link_rows, fronts}, coupled_update{dofs, active_dofs, rows, link_rows, fronts, front_pairs};
  const Terms capped_sweep{dofs, rows, link_rows, fronts};
  const Terms qr_sweep{active_dofs, link_rows, fronts, reflections, reduced}, qr_update{dofs, rows, panels, reflections, reduced};
  const Terms matrix{rows, rows_squared}, factor{rows, rows_squared, rows_cubed};
  const Terms columns{dofs, active_dofs, dofs_rows, rows_squared}, columns_first{dofs, active_dofs, dofs_rows, rows, rows_squared, rows_cubed};
  const Terms propagated{dofs, active_dofs, rows_squared, front_pairs, front_rows, front_row_pairs}, contracted{dofs, active_dofs, rows_squared, tree_pairs, front_pairs, coupled_rows, coupled_row_pairs};
  static const std::vector<Row> all{
      {"dense_cholesky", explicit_row({dofs_cubed, dofs_squared_rows, dofs_rows_squared, rows_squared, depth, row_depth})},
      {"explicit_columns", explicit_row(columns)},
      {"ltl_osim", explicit_row({dofs, depth, depth_squared, row_depth, row_depth_squared, row_pairs})},
      {"ltl_kkt", explicit_row({dofs, depth, depth_squared, row_depth, row_depth_squared, row_pairs})},
      {"pv_osim", explicit_row({dofs, active_dofs, row_depth, row_pairs, rows_squared})},
      {"pv_osimr", explicit_row({dofs, active_dofs, tree_pairs, rows_squared})},
      {"kjr", explicit_row({dofs, active_dofs, path_pairs, tree_pairs, rows_squared})},
      {"efp", explicit_row({dofs, active_dofs, tree_rows, tree_pairs, rows_squared})},
      {"efpa", explicit_row({dofs, active_dofs, row_depth, tree_pairs, rows_squared})},
      {"maximal_direct", explicit_row({dofs, active_dofs, dofs_rows, rows_squared})},
      {"aba_sweep", {update, {}, sweep, {}, {}}},
      {"lcaba", {Terms{}, coupled_update, {}, coupled_sweep, coupled_update}},
      {"caba_osim", {Terms{}, propagated, {}, matrix, propagated}},
      {"caba_osimr", {Terms{}, contracted, {}, matrix, contracted}},
      {"lcaba_refined", {Terms{}, coupled_update, {}, coupled_sweep, coupled_update}},
      {"ladder", {Terms{}, coupled_update, {}, coupled_sweep, coupled_update}},
      {"lcaba_qr", {Terms{}, qr_update, {}, qr_sweep, qr_update}},
      {"lcaba_float", {}},   // not counted: it is for double alone
      {"proximal", {Terms{}, {dofs, rows, link_rows, fronts, front_pairs}, {}, capped_sweep, coupled_update}},
      {"maximal_free", {Terms{}, {}, {}, {}, {rows}}},   // a step takes as many iterations as the values need
      {"kkt_elimination", {columns, columns_first, matrix, {active_dofs, rows, link_rows, rows_squared}, factor}},
      {"dense_refined", {columns, columns_first, matrix, {active_dofs, rows, link_rows, rows_squared}, factor}},
      {"cg", {update, update, sweep, sweep, {}}},
      {"cg_preconditioned", {update, coupled_update, sweep, coupled_sweep, coupled_update}},
  };
  return all;
}

// Terms of the elimination of M + JᵀRJ. The bodies of a constraint are eliminated one after the other on one way to the end, so
// that its rows have reached a step when the first of them has.
template <class Add> void add_fronts(const Structure& s, const Plan& plan, const Add& add) {
  std::vector<double> reached(static_cast<std::size_t>(plan.steps));
  for (const auto& e : s.link_constraints) {
    int first = plan.steps;
    for (const auto& link : e.links) first = std::min(first, plan.step[link.body]);
    if (first < plan.steps) reached[first] += static_cast<double>(e.rows);
  }
  for (const auto& e : s.joint_constraints) reached[plan.step[e.body]] += static_cast<double>(e.rows);
  for (int i = 0; i < plan.steps; ++i) {
    const int begin = plan.first_member[i], end = plan.first_member[i + 1];
    const double q = end - begin, own = plan.first_column[i + 1] - plan.first_column[i], r = reached[i];
    if (begin < end) reached[plan.members[begin].step] += r;
    add(fronts, own * q);
    add(front_pairs, own * (q + 1) * (q + 1));
    add(front_rows, own * (q + 1) * r), add(front_row_pairs, own * r * r);
    const bool coupled = end - begin > 1 || (end > begin && plan.members[begin].block >= 0);
    if (coupled) add(coupled_rows, own * (q + 1) * r), add(coupled_row_pairs, own * r * r);
  }
  const FrontPlan fronts_of = make_front_plan(s, plan);
  for (const FrontPlan::Front& f : fronts_of.fronts) {
    const auto reflect = [&](int k, double blocks) { add(panels, blocks * (f.last(k) + 1)), add(k < f.dofs ? reflections : reduced, f.last(k) + 1); };
    int k = 0;
    while (k < std::min(f.dofs, f.reflections)) reflect(k, f.members + (f.dofs - 1 - k) / 6.0), ++k;
    for (int j = 0; j < f.members; ++j)
      if (const FrontPlan::Handed& handed = fronts_of.handed[f.first_member + j]; handed.reduced)
        for (int c = 0; c < 6; ++c) reflect(k++, handed.blocks - c / 6.0);
  }
}

constexpr std::string_view term_names[] = {"n", "n of loaded bodies", "m", "rows of K", "m²", "m³", "entries of L", "their squares", "n m", "n² m", "n m²", "n³", "n d", "n d²", "m d", "m d²", "m² d",
                                           "joints between pairs of rows", "n m tree by tree", "m² tree by tree", "Σ n|Q|", "Σ n|Q|²", "Σ n|Q|r", "Σ n r²",
                                           "Σ n|Q|r of coupled joints", "Σ n r² of coupled joints", "panels of the QR", "reflections of the QR", "reductions of the QR"};
static_assert(std::size(term_names) == static_cast<std::size_t>(Term::count));
constexpr std::string_view asks_names[] = {"first product", "first solve", "product again", "solve again", "new damping"};
static_assert(std::size(asks_names) == asks_count);

}  // namespace

std::string_view name(Term term) { return term_names[static_cast<std::size_t>(term)]; }
std::string_view name(Asks what) { return asks_names[static_cast<std::size_t>(what)]; }

const Declared& declared_orders(std::string_view op) {
  for (const Row& row : table())
    if (row.op == op) return row.is;
  throw std::logic_error("declared_orders: " + std::string(op) + " declares no orders (algorithms/operators/declared_orders.cpp)");
}

std::array<double, static_cast<std::size_t>(Term::count)> terms(const Structure& s) {
  std::array<double, static_cast<std::size_t>(Term::count)> all{};
  const auto add = [&](Term term, double x) { all[static_cast<std::size_t>(term)] += x; };
  const Index N = s.bodies();
  // d_i; roots; Σ n_k d_k of the way to the root; rows beyond i, those of a root being the rows of its tree
  std::vector<double> d(static_cast<std::size_t>(N)), way(d), r(d), tree_dofs(d);
  std::vector<Index> root(static_cast<std::size_t>(N));
  for (Index i = 0; i < N; ++i) {
    const Index p = s.parent[i];
    const double own = static_cast<double>(s.dofs(i));
    d[i] = own + (p == ground ? 0 : d[p]);
    way[i] = own * d[i] + (p == ground ? 0 : way[p]);
    root[i] = p == ground ? i : root[p];
    tree_dofs[root[i]] += own;
  }
  const auto row_at = [&](Index body, double rows) { r[body] += rows, add(row_depth_squared, rows * way[body]); };
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links) row_at(link.body, static_cast<double>(e.rows)), add(link_rows, static_cast<double>(e.rows));
  for (const auto& e : s.joint_constraints) row_at(e.body, static_cast<double>(e.rows));
  for (Index i = N; i-- > 0;)
    if (s.parent[i] != ground) r[s.parent[i]] += r[i];
  const double n = static_cast<double>(s.dofs()), m = static_cast<double>(s.rows);
  for (Index i = 0; i < N; ++i) {
    const double own = static_cast<double>(s.dofs(i)), of_tree = r[root[i]];
    if (r[i] > 0) add(active_dofs, own);
    add(depth, own * d[i]), add(depth_squared, own * d[i] * d[i]);
    add(row_depth, own * r[i]);
    add(row_pairs, own * r[i] * r[i]);
    add(path_pairs, own * r[i] * (of_tree - r[i]));
    if (root[i] == i) add(tree_rows, tree_dofs[i] * r[i]), add(tree_pairs, r[i] * r[i]);
  }
  add(Term::dofs, n), add(rows, m), add(rows_squared, m * m), add(rows_cubed, m * m * m);
  add(dofs_rows, n * m), add(dofs_squared_rows, n * n * m), add(dofs_rows_squared, n * m * m), add(dofs_cubed, n * n * n);
  const FillSums sums = fill_sums(s);
  add(fill, sums.entries), add(fill_squares, sums.squares);
  const Plan plan = make_plan(s, Matrix::M_R);
  add_fronts(s, plan, add);
  return all;
}

}  // namespace delassus
