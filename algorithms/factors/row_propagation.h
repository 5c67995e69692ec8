// F = J M_R⁻¹ Jᵀ (or J M⁻¹Jᵀ) by carrying every row of J inwards through a factor: the propagation form of the Delassus matrix.
//
// What     Each row is a force κ_i on every body it has reached, at first its K blocks. At joint i, for all rows with links below:
//            G_i = κ_i S_i + 𝒦_i,   F += G_i D_i⁻¹ G_iᵀ,   κ_π += κ_i,   κ_j −= G_i D_i⁻¹ W_jᵀ  (j ∈ Q_i)
//          for the factor of M: Q_i = {π(i)}, W_π = U_i. Branches of one row add up where they meet: loops, constraints of any
//          number of bodies and rows on joints are no special case.
// Contracted  Where rows of different branches meet at body l, or act on it, all joints from l up to the next that is coupled or a
//          root have their part at once,
//            F_rs += κ_r Ω_l κ_sᵀ,   Ω_l = S D⁻¹Sᵀ + Pᵀ Ω_π P,  0 beyond that joint,
//          each pair of rows once; between such bodies rows are carried by one 6×6 matrix for all.
// Cost     whole: about 24 n_i per row at joint i, and n_i per pair of rows there: O(m²d). Contracted: O(n + m²) beyond the
//          steps that are coupled, of which each costs as much as in the whole tree.
// How      where the same rows pass several joints, one product G D⁻¹Gᵀ is taken for all of these (pair_sums.h).
// Memory   a slot per row and body it starts at or is coupled to; lists of the rows at each step (whole) or node; G of plain nodes.
// Error    sums of products along the paths of the rows, as the sweeps of factor.h.
// Source   A. S. Sathya, W. Decré, J. Swevers, PV-OSIMr, 2024 (trees, unary rows); loops: docs/paper_notes.md.
#pragma once

#include "algorithms/factors/mobility.h"
#include "algorithms/factors/row_plan.h"

namespace delassus {

template <class T> class RowPropagation {
 public:
  /// Allocates everything. The plan must outlive this, and be that of the factors given to `form`.
  void analyze(const Structure& structure, const Plan& plan, Tree tree);
  /// K of the rows; those of joints stand in the factor.
  void load(const Problem<T>& problem);
  /// The lower triangle of F into zeros, m × m.
  void form(const Factor<T>& factor, MatrixX<T>& F);
  [[nodiscard]] Index bytes() const;

 private:
  using Node = RowPlan::Node;
  void joint(const Factor<T>& factor, const Node& node);
  void meet(const Node& node);
  void leave_joint_with_rows(const Factor<T>& factor, const Node& node);
  void leave(const Factor<T>& factor, const Node& node);
  void find_mobilities(const Factor<T>& factor);
  /// G = κ S of a list, entry e of column c at x[c · stride + e].
  void push_joint(const typename Factor<T>::Joint& j, const RowPlan::List& rows, T* x, Index stride);
  [[nodiscard]] std::span<const RowPlan::Entry> entries(const RowPlan::List& list) const {
    return std::span(rows_.entries).subspan(static_cast<std::size_t>(list.first_entry), static_cast<std::size_t>(list.entries));
  }

  const Plan* plan_ = nullptr;
  RowPlan rows_;
  PairSums<T> sums_;
  std::vector<Six<T>> k_, kappa_;        // per row of Problem::K; per slot
  std::vector<MobilityRoot<T>> omega_;   // per active step, of the contracted tree
  std::vector<T> x_;                     // scratch: κ or G of the entries of a node, six columns
  std::vector<T> g_, d_;                 // of the spans: G, and 1/D of their columns
  Index stride_ = 0;
};

}  // namespace delassus
