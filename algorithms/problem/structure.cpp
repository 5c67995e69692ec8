// A structure is built body by body and constraint by constraint, and judged.
#include <algorithm>
#include <string>
#include <utility>

#include "algorithms/problem/problem.h"

namespace delassus {
namespace {

std::string body_name(Index i) { return "body " + std::to_string(i); }

void check_body(Index parent, Index n, Index i) {
  if (parent < ground || parent >= i)
    throw ModelError("", body_name(i), "parent " + std::to_string(parent) + " is not an earlier body",
                     "-1 (ground) to " + std::to_string(i - 1) + "; add parents before their children");
  if (n < 0 || n > 6)
    throw ModelError("", body_name(i), "joint with " + std::to_string(n) + " degrees of freedom", "0 to 6; a body between makes room for more");
}

/// Rows and bodies of one link constraint: at least one row, at least one body, every body once.
void check_links(Index rows, std::vector<Index> bodies, Index body_count, const std::string& element) {
  if (rows < 1) throw ModelError("", element, std::to_string(rows) + " rows", "1 or more; leave a constraint without rows out");
  if (bodies.empty()) throw ModelError("", element, "acts on no body", "1 or more bodies, the ground left out; leave a constraint between the ground and itself out");
  std::sort(bodies.begin(), bodies.end());
  if (bodies.front() < 0 || bodies.back() >= body_count)
    throw ModelError("", element,
                     body_name(bodies.front() < 0 ? bodies.front() : bodies.back()) + " does not exist",
                     "0 to " + std::to_string(body_count - 1) + "; add the body first, and leave the ground out");
  const auto twice = std::adjacent_find(bodies.begin(), bodies.end());
  if (twice != bodies.end())
    throw ModelError("", element, body_name(*twice) + " appears twice", "distinct bodies; add the two blocks of K up");
}

void check_joint_rows(Index rows, Index body, Index body_count, const std::string& element) {
  if (rows < 1) throw ModelError("", element, std::to_string(rows) + " rows", "1 or more; leave a constraint without rows out");
  if (body < 0 || body >= body_count)
    throw ModelError("", element, body_name(body) + " does not exist", "0 to " + std::to_string(body_count - 1) + "; add the body first");
}

/// The ranges [first, first + size) must follow each other without gap or overlap from 0 to `total`.
void check_tiling(std::vector<std::pair<Index, Index>> ranges, Index total, const char* of) {
  std::sort(ranges.begin(), ranges.end());
  Index next = 0;
  for (const auto& [first, size] : ranges) {
    if (first != next)
      throw ModelError("", of, "gap or overlap at " + std::to_string(std::min(first, next)),
                       "every entry in exactly one constraint; let add_link_constraint and add_joint_constraint number them");
    next += size;
  }
  if (next != total)
    throw ModelError("", of, std::to_string(next) + " entries used of " + std::to_string(total), "all of them; let add_link_constraint and add_joint_constraint count them");
}

}  // namespace

Index Structure::add_body(Index parent_body, Index n) {
  const Index i = bodies();
  check_body(parent_body, n, i);
  parent.push_back(parent_body);
  first_dof.push_back(first_dof.back() + n);
  return i;
}

Index Structure::add_link_constraint(Index m, const std::vector<Index>& on) {
  const Index e = static_cast<Index>(link_constraints.size());
  check_links(m, on, bodies(), "link constraint " + std::to_string(e));
  LinkConstraint c{rows, m, {}};
  c.links.reserve(on.size());
  for (const Index body : on) {
    c.links.push_back({body, K_rows});
    K_rows += m;
  }
  link_constraints.push_back(std::move(c));
  rows += m;
  return e;
}

Index Structure::add_joint_constraint(Index m, Index body) {
  const Index e = static_cast<Index>(joint_constraints.size());
  check_joint_rows(m, body, bodies(), "joint constraint " + std::to_string(e));
  joint_constraints.push_back({rows, m, body, joint_K_size});
  rows += m;
  joint_K_size += m * dofs(body);
  return e;
}

void Structure::validate() const {
  if (first_dof.size() != parent.size() + 1 || first_dof.front() != 0)
    throw ModelError("", "first_dof", std::to_string(first_dof.size()) + " entries, or not starting at 0",
                     "one more entry than bodies, starting at 0; let add_body write it");
  for (Index i = 0; i < bodies(); ++i) check_body(parent[i], dofs(i), i);

  std::vector<std::pair<Index, Index>> row_ranges, K_ranges, joint_ranges;
  std::vector<Index> on;
  for (std::size_t e = 0; e < link_constraints.size(); ++e) {
    const LinkConstraint& c = link_constraints[e];
    on.clear();
    for (const Attachment& l : c.links) {
      on.push_back(l.body);
      K_ranges.emplace_back(l.first, c.rows);
    }
    check_links(c.rows, on, bodies(), "link constraint " + std::to_string(e));
    row_ranges.emplace_back(c.row, c.rows);
  }
  for (std::size_t e = 0; e < joint_constraints.size(); ++e) {
    const JointConstraint& c = joint_constraints[e];
    check_joint_rows(c.rows, c.body, bodies(), "joint constraint " + std::to_string(e));
    row_ranges.emplace_back(c.row, c.rows);
    joint_ranges.emplace_back(c.first, c.rows * dofs(c.body));
  }
  check_tiling(std::move(row_ranges), rows, "rows of J");
  check_tiling(std::move(K_ranges), K_rows, "rows of K");
  check_tiling(std::move(joint_ranges), joint_K_size, "entries of joint_K");
}

}  // namespace delassus
