#include "algorithms/factors/front_plan.h"
#include "algorithms/kit/columns.h"

#include <algorithm>

namespace delassus {
namespace {

int narrow(Index i) { return static_cast<int>(i); }
using Lists = std::vector<std::vector<int>>;  // per step

// Which constraints enter at which step.
struct Entries {
  Lists on_joint, on_links;
  Entries(const Structure& s, const Plan& plan)
      : on_joint(static_cast<std::size_t>(plan.steps)), on_links(on_joint.size()) {
    for (Index j = 0; j < static_cast<Index>(s.joint_constraints.size()); ++j)
      on_joint[plan.step[s.joint_constraints[j].body]].push_back(narrow(j));
    for (Index e = 0; e < static_cast<Index>(s.link_constraints.size()); ++e) {
      int first = plan.steps;
      for (const auto& link : s.link_constraints[e].links) first = std::min(first, plan.step[link.body]);
      on_links[first].push_back(narrow(e));
    }
  }
};

class Builder {
 public:
  Builder(const Structure& s, const Plan& plan) : s_(s), plan_(plan), entries_(s, plan), given_(entries_.on_joint.size()) {
    out_.handed.resize(plan.members.size());
  }
  FrontPlan build() {
    for (int i = 0; i < plan_.steps; ++i) append_front(i);
    return std::move(out_);
  }

 private:
  // The block of a step in front i.
  [[nodiscard]] int block_of(int i, int step) const {
    if (step == i) return 0;
    for (int k = plan_.first_member[i];; ++k)
      if (plan_.members[k].step == step) return 1 + k - plan_.first_member[i];
  }

  void append_front(int i) {
    FrontPlan::Front f{};
    f.dofs = plan_.first_column[i + 1] - plan_.first_column[i];
    f.first_member = plan_.first_member[i];
    f.members = plan_.first_member[i + 1] - f.first_member;
    f.parent_block = plan_.parent[i] < 0 ? 0 : block_of(i, plan_.parent[i]);
    append_constraints(i, f);
    f.first_given = narrow(static_cast<Index>(out_.given.size()));
    f.given = narrow(static_cast<Index>(given_[i].size()));
    for (const int member : given_[i]) {
      out_.given.push_back(member);
      f.rows += out_.handed[member].rows;
    }
    f.row = out_.rows;
    f.reflection = out_.reflections;
    f.v = out_.v;
    f.c = out_.c;
    f.stride = padded(f.rows + 1);
    f.reflections = f.rows == 0 ? 0 : f.dofs + hand_on(f);
    out_.rows += f.stride;
    out_.reflections += f.reflections;
    out_.v += f.reflections * f.stride;
    out_.c += static_cast<Index>(f.members) * f.dofs;
    out_.largest = std::max(out_.largest, static_cast<Index>(f.rows + 1) * (f.members + 1));
    out_.fronts.push_back(f);
  }

  void append_constraints(int i, FrontPlan::Front& f) {
    f.first_constraint = narrow(static_cast<Index>(out_.constraints.size()));
    for (const int j : entries_.on_joint[i]) {
      const auto& c = s_.joint_constraints[j];
      out_.constraints.push_back({static_cast<Index>(s_.link_constraints.size()) + j, c.row, c.rows, 0, 0, out_.joint_rows});
      f.joint_rows += narrow(c.rows);
      out_.joint_rows += c.rows;
    }
    f.rows = f.joint_rows;
    for (const int e : entries_.on_links[i]) {
      const auto& c = s_.link_constraints[e];
      out_.constraints.push_back({e, c.row, c.rows, narrow(static_cast<Index>(out_.links.size())),
                                  narrow(static_cast<Index>(c.links.size())), 0});
      for (const auto& link : c.links) out_.links.push_back({block_of(i, plan_.step[link.body]), link.first});
      f.rows += narrow(c.rows);
    }
    f.constraints = narrow(static_cast<Index>(out_.constraints.size())) - f.first_constraint;
  }

  // Returns the number of reflections.
  int hand_on(const FrontPlan::Front& f) {
    const int source = narrow(static_cast<Index>(out_.fronts.size()));
    int rest = f.rows, reflections = 0;
    for (int k = 0; k < f.members && rest > 0; ++k) {
      const bool reduced = rest > 6 * (f.members - k) + FrontPlan::surplus;
      const int rows = reduced ? 6 : rest;
      rest -= rows;
      append_handed(k, {source, rest, rows, f.members - k, reduced, 0, 0}, f);
      if (reduced) reflections += 6;
    }
    return reflections;
  }

  void append_handed(int k, FrontPlan::Handed h, const FrontPlan::Front& f) {
    const int member = f.first_member + k, receiver = plan_.members[member].step;
    h.first = out_.handed_size;
    h.first_block = narrow(static_cast<Index>(out_.handed_block.size()));
    for (int l = k; l < f.members; ++l)
      out_.handed_block.push_back(block_of(receiver, plan_.members[f.first_member + l].step));
    out_.handed_size += static_cast<Index>(h.rows) * h.blocks;
    out_.handed[member] = h;
    given_[receiver].push_back(member);
  }

  const Structure& s_;
  const Plan& plan_;
  Entries entries_;
  Lists given_;
  FrontPlan out_;
};

}  // namespace

FrontPlan make_front_plan(const Structure& structure, const Plan& plan) { return Builder(structure, plan).build(); }

Index FrontPlan::bytes() const {
  return static_cast<Index>(fronts.size() * sizeof(Front) + constraints.size() * sizeof(Constraint) +
                            links.size() * sizeof(Link) + handed.size() * sizeof(Handed) +
                            (given.size() + handed_block.size()) * sizeof(int));
}

}  // namespace delassus
