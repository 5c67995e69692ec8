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

std::string link_name(std::size_t e) { return "link constraint " + std::to_string(e); }

/// A body that stands twice among those of a constraint, or ground.
template <class Links, class BodyOf> Index twice(const Links& links, const BodyOf& body_of) {
  if (links.size() <= 8) {
    for (std::size_t a = 1; a < links.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        if (body_of(links[a]) == body_of(links[b])) return body_of(links[a]);
    return ground;
  }
  std::vector<Index> bodies;
  for (const auto& link : links) bodies.push_back(body_of(link));
  std::sort(bodies.begin(), bodies.end());
  const auto at = std::adjacent_find(bodies.begin(), bodies.end());
  return at == bodies.end() ? ground : *at;
}

/// Rows and bodies of one link constraint: at least one row, at least one body, every body once.
template <class Links, class BodyOf> void check_links(Index rows, const Links& links, const BodyOf& body_of, Index body_count, std::size_t e) {
  if (rows < 1) throw ModelError("", link_name(e), std::to_string(rows) + " rows", "1 or more; leave a constraint without rows out");
  if (links.empty()) throw ModelError("", link_name(e), "acts on no body", "1 or more bodies, the ground left out; leave a constraint between the ground and itself out");
  for (const auto& link : links)
    if (const Index body = body_of(link); body < 0 || body >= body_count)
      throw ModelError("", link_name(e), body_name(body) + " does not exist",
                       "0 to " + std::to_string(body_count - 1) + "; add the body first, and leave the ground out");
  if (const Index body = twice(links, body_of); body != ground)
    throw ModelError("", link_name(e), body_name(body) + " appears twice", "distinct bodies; add the two blocks of K up");
}

void check_joint_rows(Index rows, Index body, Index body_count, std::size_t e) {
  const auto element = [e] { return "joint constraint " + std::to_string(e); };
  if (rows < 1) throw ModelError("", element(), std::to_string(rows) + " rows", "1 or more; leave a constraint without rows out");
  if (body < 0 || body >= body_count)
    throw ModelError("", element(), body_name(body) + " does not exist", "0 to " + std::to_string(body_count - 1) + "; add the body first");
}

/// Ranges [first, first + size) that must follow each other without gap or overlap from 0 on. Those that come in order are only
/// added up, the others sorted.
class Tiling {
 public:
  void add(Index first, Index size) {
    if (first == next_) next_ += size;
    else others_.emplace_back(first, size);
  }
  void check(Index total, const char* of) {
    std::sort(others_.begin(), others_.end());
    for (const auto& [first, size] : others_) {
      if (first != next_)
        throw ModelError("", of, "gap or overlap at " + std::to_string(std::min(first, next_)),
                         "every entry in exactly one constraint; let add_link_constraint and add_joint_constraint number them");
      next_ += size;
    }
    if (next_ != total)
      throw ModelError("", of, std::to_string(next_) + " entries used of " + std::to_string(total), "all of them; let add_link_constraint and add_joint_constraint count them");
  }

 private:
  Index next_ = 0;
  std::vector<std::pair<Index, Index>> others_;
};

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
  check_links(m, on, [](Index body) { return body; }, bodies(), link_constraints.size());
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
  check_joint_rows(m, body, bodies(), joint_constraints.size());
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

  Tiling in_J, in_K, in_joint_K;
  std::size_t e = 0, j = 0;
  while (e < link_constraints.size() || j < joint_constraints.size())  // in the order of their rows
    if (j == joint_constraints.size() || (e < link_constraints.size() && link_constraints[e].row < joint_constraints[j].row)) {
      const LinkConstraint& c = link_constraints[e];
      check_links(c.rows, c.links, [](const Attachment& l) { return l.body; }, bodies(), e++);
      for (const Attachment& l : c.links) in_K.add(l.first, c.rows);
      in_J.add(c.row, c.rows);
    } else {
      const JointConstraint& c = joint_constraints[j];
      check_joint_rows(c.rows, c.body, bodies(), j++);
      in_J.add(c.row, c.rows);
      in_joint_K.add(c.first, c.rows * dofs(c.body));
    }
  in_J.check(rows, "rows of J");
  in_K.check(K_rows, "rows of K");
  in_joint_K.check(joint_K_size, "entries of joint_K");
}

}  // namespace delassus
