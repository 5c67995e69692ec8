#include "algorithms/factors/coupled_rows.h"

#include <algorithm>
#include <numeric>

namespace delassus {
namespace {

constexpr Index none = -1;

/// Per unit the cliques it is in, one behind the other, and how many there are.
struct Cliques {
  std::vector<Index> first, clique;
  Index count = 0;
  [[nodiscard]] Index units() const { return static_cast<Index>(first.size()) - 1; }
};

/// The first body on the way from the ground that a joint moves, or `ground`: bodies of different ones do not know of each other.
std::vector<Index> moved_trees(const Structure& s) {
  std::vector<Index> tree(static_cast<std::size_t>(s.bodies()), ground);
  for (Index i = 0; i < s.bodies(); ++i) {
    if (s.parent[i] != ground) tree[i] = tree[s.parent[i]];
    if (tree[i] == ground && s.dofs(i) > 0) tree[i] = i;
  }
  return tree;
}

Cliques cliques_of(const Structure& s, const std::vector<Index>& unit) {
  struct Member {
    Index unit, clique;
    auto operator<=>(const Member&) const = default;
  };
  std::vector<Member> members;
  const std::vector<Index> tree = moved_trees(s);
  Index next = s.bodies();  // cliques: trees by their first body, then constraints
  const auto add = [&](Index row, Index rows, Index clique) {
    if (clique == ground) return;
    for (Index r = row; r < row + rows; ++r)
      if (r == row || unit[r] != unit[r - 1]) members.push_back({unit[r], clique});
  };
  for (const auto& e : s.link_constraints) {
    for (const auto& link : e.links) add(e.row, e.rows, tree[link.body]);
    add(e.row, e.rows, next++);
  }
  for (const auto& e : s.joint_constraints) add(e.row, e.rows, tree[e.body]), add(e.row, e.rows, next++);
  std::sort(members.begin(), members.end());
  members.erase(std::unique(members.begin(), members.end()), members.end());
  Cliques c;
  c.count = next;
  c.first.assign(unit.empty() ? 1 : static_cast<std::size_t>(unit.back()) + 2, 0);
  for (const Member& m : members) ++c.first[m.unit + 1], c.clique.push_back(m.clique);
  std::partial_sum(c.first.begin(), c.first.end(), c.first.begin());
  return c;
}

/// visit(column, row) of every entry of L below the diagonal, row by row.
template <class Visit> void eliminate(const Cliques& c, const Visit& visit) {
  const Index n = c.units();
  const std::vector<Index> empty(static_cast<std::size_t>(n), none), of_cliques(static_cast<std::size_t>(c.count), none);
  std::vector<Index> parent = empty, ancestor = empty, seen = empty, last = of_cliques, first = of_cliques;
  for (Index r = 0; r < n; ++r) {
    for (Index k = c.first[r]; k < c.first[r + 1]; ++k) {
      const Index q = c.clique[k];
      for (Index s = last[q]; s != none && s < r;) {  // the tree, its ways cut short
        const Index above = ancestor[s];
        ancestor[s] = r;
        if (above == none) parent[s] = r;
        s = above;
      }
      last[q] = r;
      if (first[q] == none) first[q] = r;
    }
    seen[r] = r;
    for (Index k = c.first[r]; k < c.first[r + 1]; ++k)
      for (Index s = first[c.clique[k]]; seen[s] != r; s = parent[s]) {
        seen[s] = r;
        visit(s, r);
      }
  }
}

std::vector<Index> tiles(const Structure& structure, Index width) {
  std::vector<Index> tile(static_cast<std::size_t>(structure.rows));
  for (Index r = 0; r < structure.rows; ++r) tile[r] = r / width;
  return tile;
}

}  // namespace

Fill full(Index units) {
  Fill f;
  f.row.reserve(static_cast<std::size_t>(units * (units + 1) / 2));
  for (Index s = 0; s < units; ++s) {
    for (Index r = s; r < units; ++r) f.row.push_back(r);
    f.first.push_back(static_cast<Index>(f.row.size()));
  }
  return f;
}

Fill coupled_rows(const Structure& structure, const std::vector<Index>& unit) {
  const Cliques cliques = cliques_of(structure, unit);
  const Index n = cliques.units();
  Fill f;
  f.first.assign(static_cast<std::size_t>(n) + 1, 0);
  for (Index s = 0; s < n; ++s) ++f.first[s + 1];
  eliminate(cliques, [&](Index s, Index) { ++f.first[s + 1]; });
  std::partial_sum(f.first.begin(), f.first.end(), f.first.begin());
  f.row.assign(static_cast<std::size_t>(f.first.back()), 0);
  std::vector<Index> next(f.first.begin(), f.first.end() - 1);
  for (Index s = 0; s < n; ++s) f.row[next[s]++] = s;
  eliminate(cliques, [&](Index s, Index r) { f.row[next[s]++] = r; });
  return f;
}

Fill coupled_rows(const Structure& structure, Index width) { return coupled_rows(structure, tiles(structure, width)); }

FillSums tile_sums(const Structure& structure, Index width) {
  const Cliques cliques = cliques_of(structure, tiles(structure, width));
  std::vector<double> entries(static_cast<std::size_t>(cliques.units()), 1);
  eliminate(cliques, [&](Index s, Index) { entries[s] += 1; });
  FillSums sums;
  for (const double e : entries) sums.entries += e, sums.squares += e * e;
  return sums;
}

FillSums fill_sums(const Structure& structure) {
  std::vector<Index> unit(static_cast<std::size_t>(structure.rows), 0), rows;  // constraints, in the order of their rows
  const auto begin = [&](Index row) { unit[row] = 1; };
  for (const auto& e : structure.link_constraints) if (e.rows > 0) begin(e.row);
  for (const auto& e : structure.joint_constraints) if (e.rows > 0) begin(e.row);
  std::partial_sum(unit.begin(), unit.end(), unit.begin());
  for (Index& u : unit) rows.resize(static_cast<std::size_t>(u), 0), ++rows[--u];
  const Cliques cliques = cliques_of(structure, unit);
  std::vector<double> below(rows.size(), 0);
  eliminate(cliques, [&](Index s, Index r) { below[s] += static_cast<double>(rows[r]); });
  FillSums sums;
  for (std::size_t u = 0; u < rows.size(); ++u)
    for (Index left = rows[u]; left > 0; --left) {
      const double entries = static_cast<double>(left) + below[u];
      sums.entries += entries, sums.squares += entries * entries;
    }
  return sums;
}

}  // namespace delassus
