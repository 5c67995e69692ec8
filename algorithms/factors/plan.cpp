#include "algorithms/factors/plan.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "algorithms/factors/elimination.h"

namespace delassus {
namespace {

int narrow(Index i) { return static_cast<int>(i); }
std::size_t size(int n) { return static_cast<std::size_t>(n); }

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
  Writer(const Structure& s, Matrix matrix, std::span<const int> order, const Elimination* elimination) : s_(s), elimination_(elimination), n_(narrow(s.bodies())) {
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
  [[nodiscard]] bool coupled() const { return elimination_ != nullptr; }
  [[nodiscard]] int members_of(int i, int body) const { return coupled() ? elimination_->first[i + 1] - elimination_->first[i] : s_.parent[body] != ground; }

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
      for (int k = 0; k < q; ++k) members[k].step = step_[elimination_->members[first + k]];
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
  const Elimination* elimination_;  // nullptr: no couplings
  int n_;
  Plan plan_;
  Blocks blocks_;
  std::span<int> body_, step_, parent_, first_column_, first_member_, first_w_, first_pair_, pairs_, first_constraint_pair_, constraint_pairs_;
  std::span<Plan::Member> members_;
  std::span<Plan::Run> runs_;
};

}  // namespace

Plan make_plan(const Structure& s, Matrix matrix, Branches branches) {
  const Elimination e = eliminate(s, matrix, branches);
  return Writer(s, matrix, e.body, e.coupled ? &e : nullptr).written(e.actives);
}

Plan mass_plan(const Structure& s, const Plan& of_M_R) {
  return Writer(s, Matrix::M, of_M_R.body, nullptr).written(of_M_R.active());
}

}  // namespace delassus
