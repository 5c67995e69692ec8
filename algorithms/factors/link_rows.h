// The rows of the link constraints of a factor: those that act on the same bodies stand together, body by body.
//
// What     H_ii += K_iᵀ R K_i and H_ij += K_jᵀ R K_i, summed over all rows of a pair before the blocks are touched;
//          f_i += K_iᵀ x; y = Σ_i K_i a_i, reduced once for all bodies of a row.
// Order    groups by the steps of their bodies, within a group the bodies by steps, within a body the rows of the group.
// Cost     add_weights 72 operations per row and pair of bodies, (i, i) included, and 6 per row and body; scatter and gather 12 per
//          row and body.
// Source   paper, Algorithm 4, lines 2–11.
#pragma once

#include "algorithms/factors/block_diagonal.h"
#include "algorithms/factors/plan.h"
#include "algorithms/kit/six.h"
#include "algorithms/kit/slab.h"

namespace delassus {

template <class T> class LinkRows {
 public:
  void analyze(const Structure& structure, const Plan& plan);
  void load(const Problem<T>& problem);
  /// inertia = own + K_iᵀ R K_i of the active steps with rows, the others stay as they are; `block` of the plan. For the plan of M_R.
  void add_weights(const BlockDiagonal<T>& weights, const SixBySix<T>* own, SixBySix<T>* inertia, SixBySix<T>* block);

  /// f of the active steps.
  template <class V> void scatter(const V* x, Six<V>* f) const;
  /// a of the active steps; writes the rows of link constraints and no others.
  template <class V> void gather(const Six<V>* a, V* y) const;
  /// d_r = k Σ_i k_rᵀ Ω_i k_r over the k bodies of row r.
  void mobility(const SixBySix<T>* omega, T* d) const;

  [[nodiscard]] Index bytes() const { return lists_.bytes() + sixes_.bytes(); }

 private:
  struct Group {
    int first_body, first_pair, first_constraint;  // up to those of the next one
    int rows, first;                               // body b has k_[first + b rows] …
  };
  struct OfConstraint {
    int constraint, row, rows;
  };
  struct Segment {  // rows of one body that are next to each other in J and in k_
    int step, row, rows;
  };
  struct Span {  // rows of one group that are next to each other in J
    int first_body, bodies, row, rows, first, stride;
  };
  struct Source {  // of rows in Problem::K
    int from, to, rows;
  };
  struct Body {
    int step;    // from the first active
    bool again;  // an earlier group has it too
  };

  void add_inertia(const Group& g, int b, const BlockDiagonal<T>& weights, const SixBySix<T>& from, SixBySix<T>& to);

  std::span<Group> groups_;  // and one past the end
  std::span<Body> bodies_;
  std::span<int> pairs_;     // blocks of (0,1) (0,2) … (1,2) …
  std::span<OfConstraint> constraints_;
  std::span<Segment> segments_;  // in the order of k_
  std::span<Span> spans_;
  std::span<Source> sources_;
  std::span<Six<T>> k_;
  std::span<Six<T>> weighted_;  // scratch: R K of one group
  Lists lists_;
  Slab<Six<T>> sixes_;
};

}  // namespace delassus
