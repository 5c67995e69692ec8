#include "algorithms/factors/elimination.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "algorithms/factors/dissection.h"

namespace delassus {
namespace {

int narrow(Index i) { return static_cast<int>(i); }
std::size_t size(int n) { return static_cast<std::size_t>(n); }

// Of every body: its children not yet eliminated, whether its subtree carries a row, and its rank by depth (deepest first),
// degrees of freedom and number.
struct Tree {
  const Structure& s;
  int n;
  std::span<int> children, active, rank, by_rank;
  int actives = 0, roots = 0;
  bool coupled = false;  // some constraint has rows on several bodies
  Lists lists;

  Tree(const Structure& structure, Branches branches) : s(structure), n(narrow(s.bodies())) {
    std::span<int> depth;
    lists.divide(Lists::Part{children, size(n)}, Lists::Part{active, size(n)}, Lists::Part{rank, size(n)}, Lists::Part{by_rank, size(n)}, Lists::Part{depth, size(n)});
    if (branches == Branches::all) std::fill(active.begin(), active.end(), 1);
    for (const auto& e : s.link_constraints) {
      coupled = coupled || e.links.size() > 1;
      for (const auto& link : e.links) active[link.body] = 1;
    }
    for (const auto& j : s.joint_constraints) active[j.body] = 1;
    int deepest = 0;
    for (int i = 0; i < n; ++i)
      if (const int p = parent(i); p >= 0) {
        deepest = std::max(deepest, depth[i] = depth[p] + 1);
        ++children[p];
      } else {
        ++roots;
      }
    for (int i = n; i-- > 0;) {
      actives += active[i];
      if (const int p = parent(i); p >= 0) active[p] |= active[i];
    }
    sort(depth, deepest);
  }
  [[nodiscard]] int parent(int i) const { return narrow(s.parent[i]); }  // −1: ground
  [[nodiscard]] int dofs(int i) const { return narrow(s.dofs(i)); }

 private:
  // By counting.
  void sort(std::span<const int> depth, int deepest) {
    const auto key = [&](int i) { return 7 * (deepest - depth[i]) + dofs(i); };
    std::vector<int> at(size(7 * deepest + 8), 0);
    for (int i = 0; i < n; ++i) ++at[key(i) + 1];
    for (std::size_t k = 1; k < at.size(); ++k) at[k] += at[k - 1];
    for (int i = 0; i < n; ++i) by_rank[rank[i] = at[key(i)]++] = i;
  }
};

// Where nothing couples bodies a joint has degree one, a root none: the ranks, but a root as soon as its children are gone.
Elimination in_order_of_rank(const Tree& tree) {
  Elimination out;
  out.body.reserve(size(tree.n));
  std::vector<int> children(tree.children.begin(), tree.children.end());
  for (const int phase : {0, 1}) {
    const auto ready = [&](int i) { return tree.active[i] == phase && children[i] == 0; };
    for (const int i : tree.by_rank)
      if (tree.parent(i) < 0 && ready(i)) out.body.push_back(i);
    for (const int i : tree.by_rank) {
      if (tree.active[i] != phase || tree.parent(i) < 0) continue;
      out.body.push_back(i);
      if (const int p = tree.parent(i); --children[p] == 0 && tree.parent(p) < 0 && ready(p)) out.body.push_back(p);
    }
  }
  return out;
}

// Neighbour sets N_i, sorted, in one piece of memory: one that has no room left moves to the end.
class Neighbours {
 public:
  explicit Neighbours(const Tree& tree) : sets_(size(tree.n)) {
    std::size_t links = 0;
    for (const auto& e : tree.s.link_constraints) links += e.links.size();
    entries_.reserve(std::min(2 * least * links, 2 * least * sets_.size()));
    for (const auto& e : tree.s.link_constraints)
      for (const auto& a : e.links)
        for (const auto& b : e.links)
          if (a.body != b.body) insert(narrow(a.body), narrow(b.body));
  }
  [[nodiscard]] std::span<const int> operator[](int i) const { return {entries_.data() + sets_[i].begin, size(sets_[i].count)}; }
  void insert(int i, int j) {
    const int at = place(i, j);
    Set& set = sets_[i];
    if (at < set.count && entries_[set.begin + at] == j) return;
    if (set.count == set.room) grow(set);
    int* const begin = entries_.data() + set.begin;
    std::copy_backward(begin + at, begin + set.count, begin + set.count + 1);
    begin[at] = j;
    ++set.count;
  }
  void erase(int i, int j) {
    const int at = place(i, j);
    Set& set = sets_[i];
    int* const begin = entries_.data() + set.begin;
    std::copy(begin + at + 1, begin + set.count, begin + at);
    --set.count;
  }

 private:
  static constexpr std::size_t least = 4;
  struct Set {
    int begin = 0, count = 0, room = 0;
  };
  [[nodiscard]] int place(int i, int j) const {
    const auto set = (*this)[i];
    return narrow(std::lower_bound(set.begin(), set.end(), j) - set.begin());
  }
  void grow(Set& set) {
    const int begin = narrow(static_cast<Index>(entries_.size()));
    set.room = set.room == 0 ? static_cast<int>(least) : 2 * set.room;
    entries_.resize(entries_.size() + size(set.room));
    std::copy_n(entries_.begin() + set.begin, set.count, entries_.begin() + begin);
    set.begin = begin;
  }
  std::vector<Set> sets_;
  std::vector<int> entries_;
};

// The trees as nodes, joined where a constraint has rows on several; per body its tree's node.
struct Trees {
  Graph graph;
  std::vector<int> node;
  explicit Trees(const Tree& tree) : node(size(tree.n)) {
    int count = 0;
    for (int i = 0; i < tree.n; ++i) node[i] = tree.parent(i) < 0 ? count++ : node[tree.parent(i)];
    std::size_t pairs = 0;
    for (const auto& e : tree.s.link_constraints) pairs += e.links.size() * e.links.size();
    std::vector<std::pair<int, int>> edges;
    edges.reserve(pairs);
    for (const auto& e : tree.s.link_constraints)
      for (const auto& a : e.links)
        for (const auto& b : e.links)
          if (node[a.body] != node[b.body]) edges.emplace_back(node[a.body], node[b.body]);
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    graph.first.assign(size(count) + 1, 0);
    graph.edges.reserve(edges.size());
    for (const auto& [a, b] : edges) ++graph.first[a + 1], graph.edges.push_back(b);
    std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
  }
};

// Stages of all bodies; none: no tree is after another.
std::vector<int> dissected(const Tree& tree) {
  if (tree.roots <= undivided) return {};
  const Trees trees(tree);
  const std::vector<int> of_node = dissection(trees.graph);
  if (std::ranges::all_of(of_node, [](int stage) { return stage == 0; })) return {};
  std::vector<int> stages(size(tree.n));
  for (int i = 0; i < tree.n; ++i) stages[i] = tree.active[i] != 0 ? of_node[trees.node[i]] : 0;
  return stages;
}

// Alg. 4, lines 12 and 16–20: eliminate, joining all members of Q_i to each other; it ends early where it is more than `most` work.
Elimination minimum_degree(const Tree& tree, std::span<const int> stages, double most) {
  const int n = tree.n;
  Neighbours neighbours(tree);
  using Key = std::uint64_t;  // active, stage, degree, rank: below 2 N³, stages below log N where cuts divide evenly
  const auto of = [](const auto x) { return static_cast<Key>(x); };
  const Key later = stages.empty() ? 1 : of(*std::max_element(stages.begin(), stages.end())) + 1;
  const auto has = [&](int i, int j) {
    const auto set = neighbours[i];
    return std::binary_search(set.begin(), set.end(), j);
  };
  const auto degree = [&](int i) {
    const int p = tree.parent(i);
    return of(neighbours[i].size()) + (p >= 0 && !has(i, p) ? 1 : 0);
  };
  constexpr Key none = ~Key{0};
  std::vector<Key> key(size(n), none), entries;
  entries.reserve(2 * size(n));
  std::priority_queue<Key, std::vector<Key>, std::greater<>> ready(std::greater<>{}, std::move(entries));
  const auto enter = [&](int i) {
    const Key stage = of(tree.active[i]) * later + (stages.empty() ? 0 : of(stages[i])), now = (stage * of(n) + degree(i)) * of(n) + of(tree.rank[i]);
    if (std::exchange(key[i], now) != now) ready.push(now);
  };
  std::vector<int> children(tree.children.begin(), tree.children.end());
  for (int i = 0; i < n; ++i)
    if (children[i] == 0) enter(i);

  Elimination out;
  out.body.reserve(size(n));
  out.first.reserve(size(n) + 1);
  out.first.push_back(0);
  out.members.reserve(2 * size(n));
  std::vector<int> q;
  while (!ready.empty() && out.work <= most) {
    const Key next = ready.top();
    ready.pop();
    const int i = tree.by_rank[next % of(n)];
    if (key[i] != next) continue;  // of an old degree, or gone
    key[i] = none;
    const int p = tree.parent(i);
    const bool parent_is_near = p >= 0 && has(i, p);
    q.assign(neighbours[i].begin(), neighbours[i].end());
    for (const int j : q) neighbours.erase(j, i);
    if (p >= 0 && !parent_is_near) q.push_back(p);
    for (const int j : q)
      for (const int k : q)
        if (j != k) neighbours.insert(j, k);
    for (const int j : q)
      if (children[j] == 0) enter(j);
    if (p >= 0 && --children[p] == 0) enter(p);
    out.body.push_back(i);
    out.members.insert(out.members.end(), q.begin(), q.end());
    out.first.push_back(narrow(static_cast<Index>(out.members.size())));
    const double joined = static_cast<double>(q.size()) + 1;
    out.work += tree.dofs(i) * joined * joined;
  }
  return out;
}

constexpr double any = std::numeric_limits<double>::infinity();

Elimination coupled_order(const Tree& tree, Ordering ordering) {
  const std::vector<int> stages = ordering == Ordering::minimum_degree ? std::vector<int>{} : dissected(tree);
  if (stages.empty()) return minimum_degree(tree, {}, any);
  Elimination by_stages = minimum_degree(tree, stages, any);
  if (ordering == Ordering::dissected) return by_stages;
  Elimination plain = minimum_degree(tree, {}, by_stages.work);
  return plain.work <= by_stages.work ? std::move(plain) : std::move(by_stages);
}

}  // namespace

Elimination eliminate(const Structure& s, Matrix matrix, Branches branches, Ordering ordering) {
  const Tree tree(s, branches);
  const bool coupled = matrix == Matrix::M_R && tree.coupled;
  Elimination out = coupled ? coupled_order(tree, ordering) : in_order_of_rank(tree);
  out.actives = tree.actives, out.coupled = coupled;
  return out;
}

}  // namespace delassus
