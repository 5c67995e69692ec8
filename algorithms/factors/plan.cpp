#include "algorithms/factors/plan.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <queue>
#include <utility>

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
  int actives = 0;
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

// Q_i = N_i ∪ {π(i)} of every body at its elimination, in elimination order; one list after the other. Without lists: {π(i)}.
struct Cliques {
  std::vector<int> body, first, members;
};

// Where nothing couples bodies a joint has degree one, a root none: the ranks, but a root as soon as its children are gone.
Cliques in_order_of_rank(Tree& tree) {
  Cliques cliques;
  cliques.body.reserve(size(tree.n));
  for (const int phase : {0, 1}) {
    const auto ready = [&](int i) { return tree.active[i] == phase && tree.children[i] == 0; };
    for (const int i : tree.by_rank)
      if (tree.parent(i) < 0 && ready(i)) cliques.body.push_back(i);
    for (const int i : tree.by_rank) {
      if (tree.active[i] != phase || tree.parent(i) < 0) continue;
      cliques.body.push_back(i);
      if (const int p = tree.parent(i); --tree.children[p] == 0 && tree.parent(p) < 0 && ready(p)) cliques.body.push_back(p);
    }
  }
  return cliques;
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

// Alg. 4, lines 12 and 16–20: eliminate, joining all members of Q_i to each other.
Cliques minimum_degree(Tree& tree) {
  const int n = tree.n;
  Neighbours neighbours(tree);
  using Key = std::uint64_t;  // active, degree, rank: below 2 N²
  const auto of = [](const auto x) { return static_cast<Key>(x); };
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
    const Key now = (of(tree.active[i]) * of(n) + degree(i)) * of(n) + of(tree.rank[i]);
    if (std::exchange(key[i], now) != now) ready.push(now);
  };
  for (int i = 0; i < n; ++i)
    if (tree.children[i] == 0) enter(i);

  Cliques cliques;
  cliques.body.reserve(size(n));
  cliques.first.reserve(size(n) + 1);
  cliques.first.push_back(0);
  cliques.members.reserve(2 * size(n));
  std::vector<int> q;
  while (!ready.empty()) {
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
      if (tree.children[j] == 0) enter(j);
    if (p >= 0 && --tree.children[p] == 0) enter(p);
    cliques.body.push_back(i);
    cliques.members.insert(cliques.members.end(), q.begin(), q.end());
    cliques.first.push_back(narrow(static_cast<Index>(cliques.members.size())));
  }
  return cliques;
}

// Numbers of the coupling blocks, by unordered pair of steps: open addressing.
class Blocks {
 public:
  int find_or_add(int x, int y) {
    if (2 * static_cast<std::size_t>(count_ + 1) > slots_.size()) grow();
    Slot& slot = slots_[place(key(x, y))];
    if (slot.number < 0) slot = {key(x, y), count_++};
    return slot.number;
  }
  [[nodiscard]] int find(int x, int y) const { return slots_.empty() ? -1 : slots_[place(key(x, y))].number; }
  [[nodiscard]] int count() const { return count_; }

 private:
  using Key = std::uint64_t;
  struct Slot {
    Key key = 0;
    int number = -1;
  };
  static Key key(int x, int y) { return (static_cast<Key>(std::min(x, y)) << 32) | static_cast<Key>(std::max(x, y)); }
  // Of the key, or where it would be entered.
  [[nodiscard]] std::size_t place(Key key) const {
    std::size_t at = static_cast<std::size_t>((key * 0x9E3779B97F4A7C15u) >> 32) & (slots_.size() - 1);
    while (slots_[at].number >= 0 && slots_[at].key != key) at = (at + 1) & (slots_.size() - 1);
    return at;
  }
  void grow() {
    std::vector<Slot> before(std::max<std::size_t>(64, 2 * slots_.size()));
    before.swap(slots_);
    for (const Slot& slot : before)
      if (slot.number >= 0) slots_[place(slot.key)] = slot;
  }
  std::vector<Slot> slots_;  // a power of two of them, or none
  int count_ = 0;
};

// Writes a plan of the bodies in a given order.
class Writer {
 public:
  Writer(const Structure& s, Matrix matrix, std::span<const int> order, const Cliques* cliques) : s_(s), cliques_(cliques), n_(narrow(s.bodies())) {
    plan_.matrix = matrix;
    plan_.steps = n_;
    const std::size_t constraints = s.link_constraints.size(), n = size(n_);
    std::size_t members = 0, pairs = 0, of_constraints = 0;
    for (int i = 0; i < n_; ++i) {
      const auto q = static_cast<std::size_t>(members_of(i, order[i]));
      members += q, pairs += q * (q - (q > 0)) / 2;
    }
    for (const auto& e : s.link_constraints) of_constraints += coupled() ? e.links.size() * (e.links.size() - (e.links.size() > 0)) / 2 : 0;
    plan_.lists.divide(Lists::Part{body_, n}, Lists::Part{step_, n}, Lists::Part{parent_, n}, Lists::Part{first_column_, n + 1},
                       Lists::Part{first_member_, n + 1}, Lists::Part{members_, members}, Lists::Part{first_w_, n + 1},
                       Lists::Part{first_pair_, n + 1}, Lists::Part{pairs_, pairs}, Lists::Part{runs_, runs(order)},
                       Lists::Part{first_constraint_pair_, constraints + 1}, Lists::Part{constraint_pairs_, of_constraints});
    std::copy(order.begin(), order.end(), body_.begin());
    for (int i = 0; i < n_; ++i) step_[body_[i]] = i;
  }

  Plan written(int actives) {
    plan_.first_active = n_ - actives;
    constraints();
    for (int i = 0; i < n_; ++i) step(i);
    plan_.blocks = blocks_.count();
    plan_.body = body_, plan_.step = step_, plan_.parent = parent_, plan_.first_column = first_column_, plan_.first_member = first_member_;
    plan_.members = members_, plan_.first_w = first_w_, plan_.first_pair = first_pair_, plan_.pairs = pairs_;
    plan_.first_constraint_pair = first_constraint_pair_, plan_.constraint_pairs = constraint_pairs_;
    write_runs();
    return std::move(plan_);
  }

 private:
  [[nodiscard]] bool coupled() const { return cliques_ != nullptr; }
  [[nodiscard]] int members_of(int i, int body) const { return coupled() ? cliques_->first[i + 1] - cliques_->first[i] : s_.parent[body] != ground; }

  void constraints() {
    int next = 0;
    for (std::size_t e = 0; e < s_.link_constraints.size(); ++e) {
      const auto& links = s_.link_constraints[e].links;
      for (std::size_t a = 0; coupled() && a < links.size(); ++a)
        for (std::size_t b = a + 1; b < links.size(); ++b) constraint_pairs_[next++] = blocks_.find_or_add(step_[links[a].body], step_[links[b].body]);
      first_constraint_pair_[e + 1] = next;
    }
  }

  void step(int i) {
    const int b = body_[i], n = narrow(s_.dofs(b)), first = first_member_[i], q = members_of(i, b);
    parent_[i] = s_.parent[b] == ground ? -1 : step_[s_.parent[b]];
    Plan::Member* const members = members_.data() + first;
    if (!coupled() && q == 1) members[0] = {parent_[i], -1};
    if (coupled()) {
      for (int k = 0; k < q; ++k) members[k].step = step_[cliques_->members[first + k]];
      std::sort(members, members + q, [](const Plan::Member& x, const Plan::Member& y) { return x.step < y.step; });
      for (int k = 0; k < q; ++k) members[k].block = blocks_.find(i, members[k].step);
    }
    int pair = first_pair_[i];
    for (int x = 0; x < q; ++x)
      for (int y = x + 1; y < q; ++y) pairs_[pair++] = blocks_.find_or_add(members[x].step, members[y].step);
    first_column_[i + 1] = first_column_[i] + n;
    first_member_[i + 1] = first + q;
    first_w_[i + 1] = first_w_[i] + n * q;
    first_pair_[i + 1] = pair;
  }

  // Upper bound of their number: two neighbours in the order make one run where nothing couples them.
  std::size_t runs(std::span<const int> order) const {
    std::size_t count = n_ > 0 ? 2 : 0;
    for (int i = 1; i < n_; ++i) count += coupled() || s_.dofs(order[i]) != s_.dofs(order[i - 1]) || (s_.parent[order[i]] == ground) != (s_.parent[order[i - 1]] == ground);
    return count;
  }

  void write_runs() {
    int count = 0;
    for (int i = 0; i < n_; ++i) {
      const int dofs = first_column_[i + 1] - first_column_[i];
      const bool simple = plan_.simple(i);
      if (i == plan_.first_active) plan_.first_active_run = count;
      if (i == plan_.first_active || i == 0 || runs_[count - 1].dofs != dofs || runs_[count - 1].simple != simple)
        runs_[count++] = {i, i, dofs, simple, simple && dofs == 1};
      else if (parent_[i - 1] != i) runs_[count - 1].chain = false;
      runs_[count - 1].end = i + 1;
    }
    if (plan_.first_active == n_) plan_.first_active_run = count;
    plan_.runs = runs_.first(size(count));
  }

  const Structure& s_;
  const Cliques* cliques_;  // nullptr: no couplings
  int n_;
  Plan plan_;
  Blocks blocks_;
  std::span<int> body_, step_, parent_, first_column_, first_member_, first_w_, first_pair_, pairs_, first_constraint_pair_, constraint_pairs_;
  std::span<Plan::Member> members_;
  std::span<Plan::Run> runs_;
};

}  // namespace

Plan make_plan(const Structure& s, Matrix matrix, Branches branches) {
  Tree tree(s, branches);
  const bool coupled = matrix == Matrix::M_R && tree.coupled;
  const Cliques cliques = coupled ? minimum_degree(tree) : in_order_of_rank(tree);
  return Writer(s, matrix, cliques.body, coupled ? &cliques : nullptr).written(tree.actives);
}

Plan mass_plan(const Structure& s, const Plan& of_M_R) {
  return Writer(s, Matrix::M, of_M_R.body, nullptr).written(of_M_R.active());
}

}  // namespace delassus
