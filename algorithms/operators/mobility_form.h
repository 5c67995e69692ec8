// What kjr, efp and efpa share: the mobility form of A₀ = J M⁻¹Jᵀ.
//
// What     A₀,rs = Σ_{i∈r} Σ_{j∈s} K_r^i Ω_ij (K_s^j)ᵀ,   Ω_ij = P_{i→l}ᵀ Ω_l P_{j→l},   l the lowest common ancestor of i and j; 0 in
//          different trees. P_{i→l} carries a force from i in to l, Ω_l is the mobility (inverse inertia) of body l (mobility.h).
//          A constraint of several bodies is the sum over its bodies: loops are no special case.
// Joints   a row 𝒦 on joint i is the force κ = −𝒦 D⁻¹U_iᵀ on π(i), and 𝒦 D⁻¹S_iᵀ as a motion of everything
//          beyond the joint, while π(i) stands still; with another row of the joint 𝒦 D⁻¹𝒦'ᵀ.
// Sites    bodies on which rows act, κ of each of them: `link rows` and those of joints outwards.
// Here     rows of one site, and of one joint. The three operators differ in how they come by Ω_ij.
// Error    eps of the mobilities of single bodies, not of what is left of them in A₀ (apply_mobile, reference/sensitivity.h).
// Cost     300 per active joint, 11 per pair of rows of a site; m² to finish.
#pragma once

#include "algorithms/factors/mobility.h"
#include "algorithms/factors/pair_sums.h"
#include "algorithms/operators/explicit.h"

namespace delassus {

template <class T> class MobilityForm : public ExplicitBySweeps<T> {
 protected:
  struct Site {
    int step, first_slot, first_run;  // up to those of the next one
  };
  struct Slot {
    int row, joint;  // joint: step of the joint the row is on, −1: a link constraint
  };

  /// After sites and trees are known.
  virtual void analyze_pairs() = 0;
  /// A₀ of all pairs of rows on different sites, and of joint rows with the sites beyond the joint.
  virtual void add_pairs() = 0;
  [[nodiscard]] virtual Index pair_bytes() const = 0;

  void analyze_form() final;
  void form(const Problem<T>& problem, MatrixX<T>& A0) final;
  [[nodiscard]] Index form_bytes() const final;

  [[nodiscard]] int sites() const { return static_cast<int>(sites_.size()) - 1; }
  [[nodiscard]] int active(int step) const { return step - this->plan_.first_active; }
  [[nodiscard]] bool same_tree(int i, int j) const { return tree_[active(i)] == tree_[active(j)]; }
  [[nodiscard]] bool has_joint_rows(int step) const { return with_rows_[active(step)] != 0; }
  /// Pairs of all rows of `site` with `row`, which moves it by `motion`.
  void add_motion(int site, const Six<T>& motion, int row) {
    T z[6];
    for (int c = 0; c < 6; ++c) z[c] = motion[c];
    sums_.add(side(site, x_.data()), z, 6, row);
  }
  /// Pairs of all rows of `site` with all of `other`, whose forces move it by Ω κ.
  void add_motions(int site, const SixBySix<T>& omega, int other) {
    move(omega, other);
    sums_.add_pairs(side(site, x_.data()), side(other, y_.data()), nullptr, 6);
  }
  /// S D⁻¹𝒦ᵀ of a row on joint j
  [[nodiscard]] static Six<T> motion_of(const typename Factor<T>::Joint& j, const T* k) {
    Six<T> motion = Six<T>::zero();
    for (int c = 0; c < j.dofs; ++c) add_scaled(motion, j.s[c], T(k[c] * j.d_inverse[c]));
    return motion;
  }

  std::vector<Site> sites_;           // ascending by step, and one past the end
  std::vector<Slot> slots_;
  std::vector<Six<T>> kappa_;         // per slot
  std::vector<SixBySix<T>> omega_;    // per active step
  std::vector<int> tree_;             // per active step: its root
  std::vector<int> slot_of_joint_;    // per row, −1: not on a joint with a parent

 private:
  [[nodiscard]] RowRuns runs(int site) const {
    return RowRuns(runs_).subspan(static_cast<std::size_t>(sites_[site].first_run), static_cast<std::size_t>(sites_[site + 1].first_run - sites_[site].first_run));
  }
  [[nodiscard]] Index stride() const { return static_cast<Index>(slots_.size()); }
  [[nodiscard]] typename PairSums<T>::Side side(int site, const T* numbers) const {
    const int first = sites_[site].first_slot;
    return {numbers, stride(), runs(site), first, sites_[site + 1].first_slot - first};
  }
  /// y_ of a site: Ω κ.
  void move(const SixBySix<T>& omega, int site) {
    for (int s = sites_[site].first_slot; s < sites_[site + 1].first_slot; ++s) {
      const Six<T> motion = multiply(omega, kappa_[s]);
      for (int c = 0; c < 6; ++c) y_[c * stride() + s] = motion[c];
    }
  }
  void take_rows(const Problem<T>& problem);
  void add_sites();
  void add_joints();

  std::vector<RowRun> runs_;
  std::vector<int> slot_of_k_;        // per row of Problem::K
  std::vector<char> with_rows_;       // per active step: rows on its joint
  std::vector<T> x_, y_;              // κ, and scratch: motions, by entries: six columns
  PairSums<T> sums_;
};

}  // namespace delassus
