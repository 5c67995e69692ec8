#include "algorithms/factors/plan.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <queue>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace delassus {
namespace {

int narrow(Index i) { return static_cast<int>(i); }

// Depth of every body and whether its subtree carries a row.
struct Tree {
  std::vector<int> depth, children;
  std::vector<char> active;
};

Tree describe(const Structure& s, Branches branches) {
  const Index n = s.bodies();
  Tree t{std::vector<int>(n, 0), std::vector<int>(n, 0), std::vector<char>(n, branches == Branches::all)};
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links) t.active[link.body] = 1;
  for (const auto& j : s.joint_constraints) t.active[j.body] = 1;
  for (Index i = 0; i < n; ++i)
    if (s.parent[i] != ground) {
      t.depth[i] = t.depth[s.parent[i]] + 1;
      ++t.children[s.parent[i]];
    }
  for (Index i = n; i-- > 0;)
    if (s.parent[i] != ground && t.active[i]) t.active[s.parent[i]] = 1;
  return t;
}

// Neighbour sets N_i as sorted vectors.
class Neighbours {
 public:
  Neighbours(const Structure& s, Matrix matrix) : sets_(static_cast<std::size_t>(s.bodies())) {
    if (matrix == Matrix::M) return;
    for (const auto& e : s.link_constraints)
      for (const auto& a : e.links)
        for (const auto& b : e.links)
          if (a.body != b.body) insert(narrow(a.body), narrow(b.body));
  }
  [[nodiscard]] const std::vector<int>& operator[](int i) const { return sets_[i]; }
  void insert(int i, int j) {
    auto& set = sets_[i];
    const auto at = std::lower_bound(set.begin(), set.end(), j);
    if (at == set.end() || *at != j) set.insert(at, j);
  }
  void erase(int i, int j) {
    auto& set = sets_[i];
    const auto at = std::lower_bound(set.begin(), set.end(), j);
    if (at != set.end() && *at == j) set.erase(at);
  }

 private:
  std::vector<std::vector<int>> sets_;
};

// Q_i = N_i ∪ {π(i)} of every body at its elimination, in elimination order; one list after the other.
struct Cliques {
  std::vector<int> body, first{0}, members;
};

// Alg. 4, lines 12 and 16–20: eliminate, joining all members of Q_i to each other.
Cliques minimum_degree(const Structure& s, Matrix matrix, Tree tree) {
  const int n = narrow(s.bodies());
  Neighbours neighbours(s, matrix);
  using Key = std::tuple<bool, int, int, int, int>;  // active, degree, −depth, dofs, body
  const auto parent = [&](int i) { return narrow(s.parent[i]); };
  const auto degree = [&](int i) {
    const auto& set = neighbours[i];
    const bool extra = parent(i) >= 0 && !std::binary_search(set.begin(), set.end(), parent(i));
    return narrow(static_cast<Index>(set.size())) + (extra ? 1 : 0);
  };
  const Key none{false, 0, 0, 0, -1};
  std::vector<Key> key(n, none), entries;
  entries.reserve(static_cast<std::size_t>(n));
  std::priority_queue<Key, std::vector<Key>, std::greater<>> ready(std::greater<>{}, std::move(entries));
  const auto enter = [&](int i) {
    const Key now{tree.active[i] != 0, degree(i), -tree.depth[i], narrow(s.dofs(i)), i};
    if (std::exchange(key[i], now) != now) ready.push(now);
  };
  for (int i = 0; i < n; ++i)
    if (tree.children[i] == 0) enter(i);

  Cliques cliques;
  cliques.body.reserve(static_cast<std::size_t>(n));
  cliques.first.reserve(static_cast<std::size_t>(n) + 1);
  cliques.members.reserve(static_cast<std::size_t>(n));
  std::vector<int> q;
  while (!ready.empty()) {
    const Key next = ready.top();
    ready.pop();
    const int i = std::get<4>(next);
    if (key[i] != next) continue;  // of an old degree, or gone
    key[i] = none;
    const int p = parent(i);
    q = neighbours[i];
    for (const int j : q) neighbours.erase(j, i);
    if (p >= 0 && !std::binary_search(q.begin(), q.end(), p)) q.insert(std::lower_bound(q.begin(), q.end(), p), p);
    if (q.size() > 1)
      for (const int j : q)
        for (const int k : q)
          if (j != k) neighbours.insert(j, k);
    for (const int j : q)
      if (tree.children[j] == 0) enter(j);
    if (p >= 0 && --tree.children[p] == 0) enter(p);
    cliques.body.push_back(i);
    cliques.members.insert(cliques.members.end(), q.begin(), q.end());
    cliques.first.push_back(narrow(static_cast<Index>(cliques.members.size())));
  }
  return cliques;
}

// Identifiers of the coupling blocks, by unordered pair of steps.
class Blocks {
 public:
  int find_or_add(int x, int y) {
    const auto key = (static_cast<std::uint64_t>(std::min(x, y)) << 32) | static_cast<std::uint64_t>(std::max(x, y));
    return ids_.try_emplace(key, count()).first->second;
  }
  [[nodiscard]] int find(int x, int y) const {
    const auto key = (static_cast<std::uint64_t>(std::min(x, y)) << 32) | static_cast<std::uint64_t>(std::max(x, y));
    const auto at = ids_.find(key);
    return at == ids_.end() ? -1 : at->second;
  }
  [[nodiscard]] int count() const { return narrow(static_cast<Index>(ids_.size())); }

 private:
  std::unordered_map<std::uint64_t, int> ids_;
};

void append_runs(Plan& plan) {
  for (int i = 0; i < plan.steps; ++i) {
    const int dofs = plan.first_column[i + 1] - plan.first_column[i];
    const bool simple = plan.simple(i);
    if (i == plan.first_active) plan.first_active_run = narrow(static_cast<Index>(plan.runs.size()));
    if (i == plan.first_active || plan.runs.empty() || plan.runs.back().dofs != dofs || plan.runs.back().simple != simple)
      plan.runs.push_back({i, i, dofs, simple, simple && dofs == 1});
    else if (plan.parent[i - 1] != i) plan.runs.back().chain = false;
    plan.runs.back().end = i + 1;
  }
  if (plan.first_active == plan.steps) plan.first_active_run = narrow(static_cast<Index>(plan.runs.size()));
}

}  // namespace

Plan make_plan(const Structure& s, Matrix matrix, Branches branches) {
  const Tree tree = describe(s, branches);
  const Cliques cliques = minimum_degree(s, matrix, tree);
  const int n = narrow(s.bodies());
  Plan plan;
  plan.matrix = matrix;
  plan.steps = n;
  plan.body = cliques.body;
  plan.step.resize(n);
  plan.parent.resize(n);
  for (int i = 0; i < n; ++i) plan.step[plan.body[i]] = i;

  Blocks blocks;
  plan.first_constraint_pair.reserve(s.link_constraints.size() + 1);
  plan.first_constraint_pair.push_back(0);
  for (const auto& e : s.link_constraints) {
    for (std::size_t a = 0; matrix == Matrix::M_R && a < e.links.size(); ++a)
      for (std::size_t b = a + 1; b < e.links.size(); ++b)
        plan.constraint_pairs.push_back(blocks.find_or_add(plan.step[e.links[a].body], plan.step[e.links[b].body]));
    plan.first_constraint_pair.push_back(narrow(static_cast<Index>(plan.constraint_pairs.size())));
  }

  for (auto* const firsts : {&plan.first_column, &plan.first_member, &plan.first_w, &plan.first_pair}) {
    firsts->reserve(static_cast<std::size_t>(n) + 1);
    firsts->push_back(0);
  }
  plan.members.reserve(cliques.members.size());
  std::vector<int> q;
  for (int i = 0; i < n; ++i) {
    const int b = plan.body[i];
    if (!tree.active[b]) plan.first_active = i + 1;
    plan.parent[i] = s.parent[b] == ground ? -1 : plan.step[s.parent[b]];
    q.clear();
    for (int k = cliques.first[i]; k < cliques.first[i + 1]; ++k) q.push_back(plan.step[cliques.members[k]]);
    std::sort(q.begin(), q.end());
    for (const int j : q) plan.members.push_back({j, blocks.find(i, j)});
    for (std::size_t x = 0; x < q.size(); ++x)
      for (std::size_t y = x + 1; y < q.size(); ++y) plan.pairs.push_back(blocks.find_or_add(q[x], q[y]));
    const int dofs = narrow(s.dofs(b));
    plan.first_column.push_back(plan.first_column.back() + dofs);
    plan.first_member.push_back(narrow(static_cast<Index>(plan.members.size())));
    plan.first_w.push_back(plan.first_w.back() + dofs * narrow(static_cast<Index>(q.size())));
    plan.first_pair.push_back(narrow(static_cast<Index>(plan.pairs.size())));
  }
  plan.blocks = blocks.count();
  append_runs(plan);
  return plan;
}

Index Plan::bytes() const {
  const auto ints = body.size() + step.size() + parent.size() + first_column.size() + first_member.size() +
                    first_w.size() + first_pair.size() + pairs.size() + first_constraint_pair.size() +
                    constraint_pairs.size();
  return static_cast<Index>(ints * sizeof(int) + members.size() * sizeof(Member) + runs.size() * sizeof(Run));
}

}  // namespace delassus
