#include "algorithms/factors/row_plan.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace delassus {
namespace {

constexpr int here = std::numeric_limits<int>::max();
constexpr int nobody = -1, several = -2;

template <class N> int narrow(N n) { return static_cast<int>(n); }

// A slot on its way: what it comes from (a node, or `here`), its row.
struct Arrival {
  int from, row, slot;
  bool operator<(const Arrival& o) const { return std::tie(from, row, slot) < std::tie(o.from, o.row, o.slot); }
};

class Builder {
 public:
  Builder(const Structure& s, const Plan& plan, Tree tree)
      : plan_(plan), contracted_(tree == Tree::contracted), active_(static_cast<std::size_t>(plan.active())), arrivals_(active_),
        joint_rows_(active_), node_(active_, 0), from_(active_, nobody), slot_of_(static_cast<std::size_t>(s.rows), -1) {
    out_.slots = narrow(s.K_rows);
    for (const auto& e : s.link_constraints)
      for (const auto& link : e.links)
        for (Index r = 0; r < e.rows; ++r) arrivals_[at(plan.step[link.body])].push_back({here, narrow(e.row + r), narrow(link.first + r)});
    for (const auto& j : s.joint_constraints)
      for (Index r = 0; r < j.rows; ++r) joint_rows_[at(plan.step[j.body])].push_back(narrow(j.row + r));
    for (std::size_t k = 0; k < active_; ++k)
      if (!arrivals_[k].empty() || !joint_rows_[k].empty()) from_[k] = several;
    mark_nodes();
  }

  RowPlan build() {
    for (int i = plan_.first_active; i < plan_.steps; ++i)
      if (node_[at(i)]) add(i);
    begin(plan_.steps);
    lay_out_spans();
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::size_t at(int step) const { return static_cast<std::size_t>(step - plan_.first_active); }
  [[nodiscard]] bool plain(int i) const { return !contracted_ || !plan_.simple(i); }

  void mark_nodes() {
    std::vector<int> children(active_, 0);
    for (int i = plan_.first_active; i < plan_.steps; ++i) {
      const int p = plan_.parent[i];
      if (!arrivals_[at(i)].empty() || !joint_rows_[at(i)].empty() || plain(i)) node_[at(i)] = 1;
      if (p >= 0 && (++children[at(p)] == 2 || !joint_rows_[at(i)].empty())) node_[at(p)] = 1;
      if (plain(i))
        for (int k = plan_.first_member[i]; k < plan_.first_member[i + 1]; ++k) node_[at(plan_.members[k].step)] = 1;
    }
  }

  RowPlan::Node& begin(int i) {
    RowPlan::Node node{};
    node.step = i;
    node.plain = i < plan_.steps && plain(i);
    node.first_group = narrow(out_.groups.size());
    node.first_merge = narrow(out_.merges.size());
    node.first_joint_row = narrow(out_.joint_rows.size());
    node.first_slot = narrow(out_.slots_of_members.size());
    out_.nodes.push_back(node);
    return out_.nodes.back();
  }

  // A list of entries; its runs count from place `first`.
  RowPlan::List append(const std::vector<Arrival>& a, std::size_t begin, std::size_t end, int first) {
    RowPlan::List list{narrow(out_.entries.size()), narrow(end - begin), narrow(out_.runs.size()), 0, false};
    for (std::size_t k = begin; k < end; ++k) out_.entries.push_back({a[k].row, a[k].slot});
    append_runs(out_.runs, first, list.entries, [&](int k) { return a[begin + static_cast<std::size_t>(k)].row; });
    list.runs = narrow(out_.runs.size()) - list.first_run;
    return list;
  }

  void add_groups(const std::vector<Arrival>& arrived) {
    for (std::size_t b = 0, e = 0; b < arrived.size(); b = e) {
      while (e < arrived.size() && arrived[e].from == arrived[b].from) ++e;
      out_.groups.push_back(append(arrived, b, e, narrow(b)));
      out_.groups.back().here = arrived[b].from == here;
    }
  }

  // Slots of one row become one.
  std::vector<Arrival> merged(const std::vector<Arrival>& arrived) {
    std::vector<Arrival> left;
    for (const Arrival& a : arrived) {
      int& first = slot_of_[static_cast<std::size_t>(a.row)];
      if (first >= 0) out_.merges.push_back({a.slot, first});
      else left.push_back({0, a.row, first = a.slot});
    }
    for (const Arrival& a : left) slot_of_[static_cast<std::size_t>(a.row)] = -1;
    std::sort(left.begin(), left.end());
    return left;
  }

  void add(int i) {
    RowPlan::Node node = begin(i);
    std::vector<Arrival> arrived = std::move(arrivals_[at(i)]);
    std::sort(arrived.begin(), arrived.end());
    if (!node.plain) add_groups(arrived);
    out_.most_entries = std::max(out_.most_entries, narrow(arrived.size() + joint_rows_[at(i)].size()));
    std::vector<Arrival> left = merged(arrived);
    if (node.plain) leave_plain(i, left, node);
    else leave_meeting(i, left, node);
    out_.nodes.back() = node;
  }

  void leave_plain(int i, std::vector<Arrival>& left, RowPlan::Node& node) {
    const std::size_t links = left.size();
    for (const int row : joint_rows_[at(i)]) left.push_back({0, row, out_.slots++});
    std::vector<Arrival> of_joint(left.begin() + narrow(links), left.end());
    std::sort(left.begin(), left.end());
    for (const Arrival& a : of_joint)
      out_.joint_rows.push_back({a.slot, narrow(std::lower_bound(left.begin(), left.end(), a) - left.begin())});
    join_span(i, left, node);
    for (int k = plan_.first_member[i]; k < plan_.first_member[i + 1]; ++k) {
      const int j = plan_.members[k].step;
      from_[at(j)] = from_[at(j)] == nobody && j == plan_.parent[i] ? narrow(out_.nodes.size()) - 1 : several;
      if (j != plan_.parent[i]) out_.slots_of_members.push_back(out_.slots);
      for (const Arrival& a : left) arrivals_[at(j)].push_back({here, a.row, j == plan_.parent[i] ? a.slot : out_.slots++});
    }
  }

  // Rows that come from one plain node alone and all go on: its list of entries is theirs.
  void join_span(int i, const std::vector<Arrival>& left, RowPlan::Node& node) {
    const int columns = plan_.first_column[i + 1] - plan_.first_column[i], from = from_[at(i)];
    if (from >= 0) {
      RowPlan::Node& before = out_.nodes[static_cast<std::size_t>(from)];
      before.last = false;
      node.leaving = before.leaving;
      node.span = before.span;
    } else {
      node.leaving = append(left, 0, left.size(), 0);
      node.span = narrow(out_.spans.size());
      out_.spans.push_back({});
      entries_of_.push_back(node.leaving.entries);
    }
    RowPlan::Span& span = out_.spans[static_cast<std::size_t>(node.span)];
    node.column = span.columns;
    span.columns += columns;
  }

  void lay_out_spans() {
    for (std::size_t k = 0; k < out_.spans.size(); ++k) {
      RowPlan::Span& span = out_.spans[k];
      span.first_value = out_.values;
      span.first_column = out_.columns;
      out_.values += span.columns * entries_of_[k];
      out_.columns += span.columns;
      out_.most_columns = std::max(out_.most_columns, span.columns);
    }
  }

  void leave_meeting(int i, const std::vector<Arrival>& left, RowPlan::Node& node) {
    node.leaving = append(left, 0, left.size(), 0);
    int columns = 0;
    for (node.to = i; node.to == i || !node_[at(node.to)]; node.to = plan_.parent[node.to])
      columns += plan_.first_column[node.to + 1] - plan_.first_column[node.to];
    // 23 operations per column and vector against six such vectors, and 66 for each to take them
    const int q = narrow(left.size());
    node.matrix = 23 * columns * q > 6 * 23 * columns + 66 * q && joint_rows_[at(i)].empty();
    from_[at(node.to)] = several;
    for (const Arrival& a : left) arrivals_[at(node.to)].push_back({plain(node.to) ? here : i, a.row, a.slot});
    for (const int row : joint_rows_[at(i)]) {
      out_.joint_rows.push_back({out_.slots, -1});
      arrivals_[at(node.to)].push_back({here, row, out_.slots++});
    }
  }

  const Plan& plan_;
  bool contracted_;
  std::size_t active_;
  std::vector<std::vector<Arrival>> arrivals_;   // per active step
  std::vector<std::vector<int>> joint_rows_;
  std::vector<char> node_;
  std::vector<int> from_;     // per active step: the plain node that all its rows come from
  std::vector<int> entries_of_;  // per span
  std::vector<int> slot_of_;  // scratch, per row
  RowPlan out_;
};

}  // namespace

RowPlan make_row_plan(const Structure& s, const Plan& plan, Tree tree) { return Builder(s, plan, tree).build(); }

Index RowPlan::bytes() const {
  return static_cast<Index>(nodes.size() * sizeof(Node) + groups.size() * sizeof(List) + entries.size() * sizeof(Entry) + runs.size() * sizeof(RowRun) +
                            merges.size() * sizeof(Merge) + joint_rows.size() * sizeof(JointRow) + slots_of_members.size() * sizeof(int) + spans.size() * sizeof(Span));
}

}  // namespace delassus
