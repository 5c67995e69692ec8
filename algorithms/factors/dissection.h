// Nested dissection of a graph: which nodes are eliminated after which, so that elimination leaves little fill.
//
// What     A part of the graph is cut at a level of distance from one of its far ends; the nodes of that level which touch the next
//          one separate what is nearer from what is farther, and come after both. Both are cut in the same way, down to
//          `undivided` nodes, and nodes of one stage are left to a rule for small graphs: minimum degree (elimination.h).
// Level    the one with the fewest nodes for what it divides: |level| / (|nearer| |farther|) is least.
// Cost     O((nodes + edges) log nodes) where cuts divide evenly.
// Source   A. George, J. W. H. Liu, An automatic nested dissection algorithm for irregular finite element problems, 1978; minimum degree
//          between the separators: C. Ashcraft, J. W. H. Liu, Robust ordering of sparse matrices using multisection, 1998.
#pragma once

#include <span>
#include <vector>

namespace delassus {

/// Neighbours of node v: edges[first[v]] up to edges[first[v + 1]], those of an edge at both of its ends.
struct Graph {
  std::vector<int> first{0}, edges;
  [[nodiscard]] int size() const { return static_cast<int>(first.size()) - 1; }
  [[nodiscard]] std::span<const int> of(int v) const { return std::span(edges).subspan(static_cast<std::size_t>(first[v]), static_cast<std::size_t>(first[v + 1] - first[v])); }
};

/// More nodes are divided: below, minimum degree was as good on every lattice, wall and pyramid tried.
inline constexpr int undivided = 50;

/// Of every node: 0 in parts that are not divided; a separator's is above those of all that it separates.
[[nodiscard]] std::vector<int> dissection(const Graph& graph);

}  // namespace delassus
