#include "property_tests/unit/operators/plan_model.h"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>

namespace delassus {
namespace {

void expect(bool holds, const char* what, Index where) {
  if (!holds) throw std::runtime_error(std::string(what) + " at " + std::to_string(where));
}

template <class E> const E& at(std::span<const E> list, std::size_t k) {
  expect(k < list.size(), "a list that ends too early", static_cast<Index>(k));
  return list[k];
}

class Model {
 public:
  Model(const Plan& plan, const Structure& s, Matrix matrix, Branches branches, const Plan* order_of, const std::vector<int>& stages)
      : plan_(plan), s_(s), matrix_(matrix), order_of_(order_of), stages_(stages), left_(s.bodies(), 1), near_(s.bodies()) {
    for (Index i = 0; i < s.bodies(); ++i) depth_.push_back(s.parent[i] == ground ? 0 : depth_[s.parent[i]] + 1);
    std::set<Index> holds_rows;
    for (const auto& e : s.link_constraints)
      for (const auto& a : e.links) {
        holds_rows.insert(a.body);
        for (const auto& b : e.links)
          if (matrix == Matrix::M_R && a.body != b.body) near_[a.body].insert(b.body);
      }
    for (const auto& j : s.joint_constraints) holds_rows.insert(j.body);
    for (Index body : holds_rows)
      for (; body != ground; body = s.parent[body]) active_.insert(body);
    if (branches == Branches::all)
      for (Index i = 0; i < s.bodies(); ++i) active_.insert(i);
  }

  void check() {
    const auto n = static_cast<std::size_t>(s_.bodies());
    expect(plan_.steps == static_cast<int>(n) && plan_.body.size() == n && plan_.step.size() == n && plan_.parent.size() == n, "sizes", 0);
    for (const auto* firsts : {&plan_.first_column, &plan_.first_member, &plan_.first_w, &plan_.first_pair})
      expect(firsts->size() == n + 1 && firsts->front() == 0, "first entries", 0);
    for (int i = 0; i < plan_.steps; ++i) expect(plan_.body[i] >= 0 && plan_.body[i] < plan_.steps && plan_.step[plan_.body[i]] == i, "step of body", i);
    check_constraints();
    expect(plan_.matrix == matrix_, "matrix", 0);
    expect(plan_.first_active == plan_.steps - static_cast<int>(active_.size()), "first active step", plan_.first_active);
    for (int i = 0; i < plan_.steps; ++i) check_step(i);
    expect(plan_.blocks == static_cast<int>(block_.size()), "number of blocks", plan_.blocks);
    expect(plan_.members.size() == static_cast<std::size_t>(plan_.first_member.back()) && plan_.pairs.size() == static_cast<std::size_t>(plan_.first_pair.back()), "lengths", 0);
    check_runs();
  }

 private:
  // Q_i = N_i ∪ {π(i)}
  std::set<Index> clique(Index body) const {
    std::set<Index> q = near_[body];
    if (s_.parent[body] != ground) q.insert(s_.parent[body]);
    return q;
  }
  bool ready(Index body) const {
    if (!left_[body]) return false;
    for (Index c = 0; c < s_.bodies(); ++c)
      if (left_[c] && s_.parent[c] == body) return false;
    return true;
  }
  auto key(Index body) const { return std::tuple(active_.contains(body), active_.contains(body) && !stages_.empty() ? stages_[static_cast<std::size_t>(body)] : 0, clique(body).size(), -depth_[body], s_.dofs(body), body); }

  // One number per pair, none twice.
  void expect_block(Index a, Index b, int number, int step) {
    const auto [at, added] = block_.try_emplace(std::minmax(a, b), number);
    expect(at->second == number, "two numbers of one block", step);
    if (added) expect(number >= 0 && number < plan_.blocks && numbers_.insert(number).second, "two blocks of one number", step);
  }

  void check_constraints() {
    std::size_t pair = 0, e = 0;
    expect(plan_.first_constraint_pair.size() == s_.link_constraints.size() + 1, "number of constraints", 0);
    for (const auto& c : s_.link_constraints) {
      expect(plan_.first_constraint_pair[e] == static_cast<int>(pair), "first pair of constraint", static_cast<Index>(e));
      ++e;
      for (std::size_t a = 0; matrix_ == Matrix::M_R && a < c.links.size(); ++a)
        for (std::size_t b = a + 1; b < c.links.size(); ++b) expect_block(c.links[a].body, c.links[b].body, at(plan_.constraint_pairs, pair++), 0);
    }
    expect(plan_.first_constraint_pair[e] == static_cast<int>(pair) && plan_.constraint_pairs.size() == pair, "pairs of constraints", 0);
  }

  void check_step(int i) {
    const Index body = plan_.body[i], p = s_.parent[body];
    expect(ready(body), "a body before its children", i);
    if (order_of_ != nullptr) expect(body == order_of_->body[i], "another order", i);
    for (Index other = 0; order_of_ == nullptr && other < s_.bodies(); ++other) expect(!ready(other) || key(body) <= key(other), "not the smallest degree", i);
    expect(plan_.parent[i] == (p == ground ? -1 : plan_.step[p]), "parent", i);
    expect(plan_.first_column[i + 1] - plan_.first_column[i] == s_.dofs(body), "columns", i);
    const std::set<Index> q = clique(body);
    std::set<int> steps;
    for (const Index b : q) steps.insert(plan_.step[b]);
    int k = plan_.first_member[i], w = 0, pair = plan_.first_pair[i];
    for (const int j : steps) {
      const Plan::Member member = at(plan_.members, static_cast<std::size_t>(k++));
      expect(member.step == j, "members", i);
      if (near_[body].contains(plan_.body[j])) expect_block(body, plan_.body[j], member.block, i);
      else expect(member.block == -1, "a block that nothing couples", i);
      w += static_cast<int>(s_.dofs(body));
    }
    expect(plan_.first_member[i + 1] == k && plan_.first_w[i + 1] - plan_.first_w[i] == w, "number of members", i);
    for (auto x = steps.begin(); x != steps.end(); ++x)
      for (auto y = std::next(x); y != steps.end(); ++y)
        expect_block(plan_.body[*x], plan_.body[*y], at(plan_.pairs, static_cast<std::size_t>(pair++)), i);
    expect(plan_.first_pair[i + 1] == pair, "number of pairs", i);
    left_[body] = 0;
    for (const Index a : q) {
      near_[a].erase(body);
      for (const Index b : q)
        if (a != b) near_[a].insert(b);
    }
  }

  void check_runs() const {
    int next = 0;
    const auto active = plan_.active_runs();
    expect((active.empty() ? plan_.steps : active.front().begin) == plan_.first_active, "the first active run", plan_.first_active_run);
    for (std::size_t k = 0; k < plan_.runs.size(); ++k) {
      const Plan::Run& run = plan_.runs[k];
      expect(run.begin == next && run.end > run.begin && run.end <= plan_.steps, "runs", run.begin);
      bool chain = run.simple && run.dofs == 1;
      for (int i = run.begin; i + 1 < run.end; ++i) chain = chain && plan_.parent[i] == i + 1;
      expect(run.chain == chain, "a chain, or none", run.begin);
      for (int i = run.begin; i < run.end; ++i) {
        const bool simple = plan_.first_member[i + 1] - plan_.first_member[i] == 1 && plan_.members[plan_.first_member[i]].block < 0;
        expect(run.dofs == s_.dofs(plan_.body[i]) && run.simple == simple, "a step unlike its run", i);
      }
      expect(k == 0 || run.begin == plan_.first_active || plan_.runs[k - 1].dofs != run.dofs || plan_.runs[k - 1].simple != run.simple, "two equal runs in a row", run.begin);
      next = run.end;
    }
    expect(next == plan_.steps, "steps without a run", next);
  }

  const Plan& plan_;
  const Structure& s_;
  Matrix matrix_;
  const Plan* order_of_;
  const std::vector<int>& stages_;
  std::vector<char> left_;                // not yet eliminated
  std::vector<std::set<Index>> near_;     // N_i
  std::vector<Index> depth_;
  std::set<Index> active_;
  std::map<std::pair<Index, Index>, int> block_;
  std::set<int> numbers_;
};

}  // namespace

std::string plan_broken(const Plan& plan, const Structure& s, Matrix matrix, Branches branches, const Plan* order_of, const std::vector<int>& stages) {
  try {
    Model(plan, s, matrix, branches, order_of, stages).check();
  } catch (const std::exception& e) {
    return e.what();
  }
  return {};
}

}  // namespace delassus
