// The plan of elimination against a model of it made of sets.
#include <gtest/gtest.h>

#include "algorithms/factors/dissection.h"
#include "algorithms/factors/elimination.h"
#include "generators/build.h"
#include "generators/families.h"
#include "property_tests/unit/operators/plan_model.h"

namespace delassus::elimination_test {
namespace {

TEST(Elimination, PlansAreWhatTheModelSays) {
  for (const auto& family : generators::families())
    for (const Index n : {1, 2, 5, 13, 24})
      for (const std::uint64_t seed : {1, 2}) {
        const auto s = generators::build(family.make(n, seed)).problem.structure;
        const Plan of_M_R = make_plan(*s, Matrix::M_R);
        EXPECT_EQ(plan_broken(mass_plan(*s, of_M_R), *s, Matrix::M, Branches::with_rows, &of_M_R), "") << family.name << " n=" << n << " seed=" << seed;
        for (const Matrix matrix : {Matrix::M, Matrix::M_R})
          for (const Branches branches : {Branches::with_rows, Branches::all})
            EXPECT_EQ(plan_broken(make_plan(*s, matrix, branches), *s, matrix, branches), "") << family.name << " n=" << n << " seed=" << seed;
      }
}

TEST(Elimination, TheModelNoticesWrongPlans) {
  const auto s = generators::build(generators::find_family("lattice").make(9, 1)).problem.structure;
  const auto broken = [&](const auto& change) {
    Plan wrong = make_plan(*s, Matrix::M_R);
    change(wrong);
    return plan_broken(wrong, *s, Matrix::M_R, Branches::with_rows);
  };
  const auto entry = []<class E>(std::span<const E> list, int k = 0) -> E& { return const_cast<E&>(list[k]); };  // of memory that may change
  EXPECT_EQ(broken([](Plan&) {}), "");
  EXPECT_NE(broken([&](Plan& p) { std::swap(entry(p.body, 0), entry(p.body, 4)), std::swap(entry(p.step, p.body[0]), entry(p.step, p.body[4])); }), "");
  EXPECT_NE(broken([&](Plan& p) { entry(p.members).step += 1; }), "");
  EXPECT_NE(broken([&](Plan& p) { entry(p.members).block = -1; }), "");
  EXPECT_NE(broken([&](Plan& p) { std::swap(entry(p.pairs, 0), entry(p.pairs, 1)); }), "");
  EXPECT_NE(broken([](Plan& p) { p.blocks += 1; }), "");
  EXPECT_NE(broken([](Plan& p) { p.first_active = 1; }), "");
  EXPECT_NE(broken([](Plan& p) { p.matrix = Matrix::M; }), "");
  EXPECT_NE(broken([&](Plan& p) { entry(p.runs).end -= 1; }), "");
  EXPECT_NE(broken([&](Plan& p) { entry(p.runs).chain = !p.runs.front().chain; }), "");
  EXPECT_NE(broken([](Plan& p) { p.first_active_run += 1; }), "");
  const Plan of_M_R = make_plan(*s, Matrix::M_R);
  EXPECT_NE(plan_broken(make_plan(*s, Matrix::M), *s, Matrix::M, Branches::with_rows, &of_M_R), "") << "its own order";
}

Graph graph(int nodes, const std::vector<std::pair<int, int>>& edges) {
  Graph g;
  for (int v = 0; v < nodes; ++v) {
    for (const auto& [a, b] : edges)
      if (a == v || b == v) g.edges.push_back(a == v ? b : a);
    g.first.push_back(static_cast<int>(g.edges.size()));
  }
  return g;
}
/// Columns × rows of them, neighbours joined, from a node on.
std::vector<std::pair<int, int>> grid(int columns, int rows, int from = 0) {
  std::vector<std::pair<int, int>> edges;
  for (int k = 0; k < columns * rows; ++k) {
    if (k % columns + 1 < columns) edges.emplace_back(from + k, from + k + 1);
    if (k + columns < columns * rows) edges.emplace_back(from + k, from + k + columns);
  }
  return edges;
}
/// Two grids that nothing joins, each node of the second with one that hangs on it alone, and a node by itself.
Graph two_grids(int columns, int rows) {
  const int n = columns * rows;
  auto edges = grid(columns, rows);
  for (const auto& edge : grid(columns, rows, n)) edges.push_back(edge);
  for (int k = 0; k < n; ++k) edges.emplace_back(n + k, 2 * n + k);
  return graph(3 * n + 1, edges);
}

/// Per node the number of what hangs together below a stage; −1: a node of that stage or above.
std::vector<int> hanging_together(const Graph& g, const std::vector<int>& stage, int below, std::vector<int>& sizes) {
  std::vector<int> of(stage.size(), -1);
  sizes.clear();
  for (int v = 0; v < g.size(); ++v) {
    if (of[v] >= 0 || stage[v] >= below) continue;
    std::vector<int> open{v};
    of[v] = static_cast<int>(sizes.size());
    sizes.push_back(0);
    while (!open.empty()) {
      const int u = open.back();
      open.pop_back();
      ++sizes.back();
      for (const int w : g.of(u))
        if (of[w] < 0 && stage[w] < below) of[w] = of[u], open.push_back(w);
    }
  }
  return of;
}

TEST(Elimination, SeparatorsPartWhatTheyComeAfter) {
  for (const auto& [columns, rows] : {std::pair{5, 5}, {26, 1}, {8, 8}, {30, 4}, {17, 23}}) {
    const Graph g = two_grids(columns, rows);
    const std::vector<int> stage = dissection(g);
    const int highest = *std::max_element(stage.begin(), stage.end());
    EXPECT_EQ(highest > 0, 2 * columns * rows > undivided);
    std::vector<int> sizes;
    (void)hanging_together(g, stage, 1, sizes);
    EXPECT_LE(*std::max_element(sizes.begin(), sizes.end()), undivided);
    for (int k = 1; k <= highest; ++k) {
      const std::vector<int> part = hanging_together(g, stage, k, sizes);
      for (int v = 0; v < g.size(); ++v) {
        if (stage[v] != k) continue;
        std::vector<int> touched;
        for (const int w : g.of(v))
          if (part[w] >= 0) touched.push_back(part[w]);
        std::sort(touched.begin(), touched.end());
        EXPECT_GE(std::unique(touched.begin(), touched.end()) - touched.begin(), 2) << "node " << v << " of stage " << k << " parts nothing";
      }
    }
    EXPECT_EQ(stage.back(), 0) << "alone";
  }
}

/// side² trees of a body that floats and a joint on it, trees beside each other joined; rows on every third joint.
Structure grid_of_trees(Index side) {
  Structure s;
  for (Index k = 0; k < side * side; ++k) {
    s.add_body(ground, 6), s.add_body(2 * k, 1);
    if (k % 3 == 0) s.add_link_constraint(2, {2 * k + 1});
  }
  for (Index k = 0; k < side * side; ++k) {
    if (k % side + 1 < side) s.add_link_constraint(3, {2 * k, 2 * k + 2});
    if (k + side < side * side) s.add_link_constraint(3, {2 * k, 2 * (k + side)});
  }
  return s;
}

/// Of every body of such a grid.
std::vector<int> stages(Index side) {
  const Graph g = graph(static_cast<int>(side * side), grid(static_cast<int>(side), static_cast<int>(side)));
  std::vector<int> out;
  for (const int stage : dissection(g)) out.push_back(stage), out.push_back(stage);
  return out;
}

TEST(Elimination, ManyTreesAreDissectedWhereThatIsLessWork) {
  for (const Index side : {7, 8, 10}) {
    const Structure s = grid_of_trees(side);
    const auto work = [&](Ordering ordering) { return eliminate(s, Matrix::M_R, Branches::with_rows, ordering).work; };
    const bool less = work(Ordering::dissected) < work(Ordering::minimum_degree);
    EXPECT_EQ(work(Ordering::cheapest), std::min(work(Ordering::dissected), work(Ordering::minimum_degree)));
    EXPECT_EQ(less, side == 10);
    const std::vector<int> of = stages(side);
    const Plan plan = make_plan(s, Matrix::M_R);
    EXPECT_EQ(plan_broken(plan, s, Matrix::M_R, Branches::with_rows, nullptr, less ? of : std::vector<int>{}), "") << side;
    if (side > 7) {
      EXPECT_NE(plan_broken(plan, s, Matrix::M_R, Branches::with_rows, nullptr, less ? std::vector<int>{} : of), "") << "the other order";
    }
  }
  const Structure large = grid_of_trees(40);
  EXPECT_LT(eliminate(large, Matrix::M_R, Branches::with_rows).work, 0.9 * eliminate(large, Matrix::M_R, Branches::with_rows, Ordering::minimum_degree).work);
}

}  // namespace
}  // namespace delassus::elimination_test
