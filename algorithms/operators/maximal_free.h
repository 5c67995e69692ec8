// maximal_free: matrix-free iterations in maximal coordinates: joints and rows alike are constraints between free bodies.
//
// What     f = (J M⁻¹Jᵀ + R⁻¹)⁻¹ a for any R⁻¹ ≥ 0; no matrix but H_i⁻¹ of single bodies, and a block for every joint.
// Formula  with B the rows of all joints and constraints on the motions of single bodies, C their compliance:
//            N x = b,   N = B H⁻¹Bᵀ + C,   x = (joint forces, λ)
//          joint i: the six rows (A S⁺; what is orthogonal to S) on a_i − a_π, C = (A; 0), S⁺ = (SᵀH_iS)⁻¹SᵀH_i; a row 𝒦 of a joint is
//          (𝒦S⁺, −𝒦S⁺) on i and π(i); constraints C = R⁻¹. Torques and rates: S⁺ᵀτ on i and −S⁺ᵀτ on π(i); ν = S⁺(a_i − a_π).
// How      conjugate gradients on N, preconditioned by its 6×6 blocks of joints and its diagonal in rows, until the residual is 2⁻⁴⁰ of
//          what it was, 4000 times at most; refined in the coordinates of the joints (refinement.h), with their certificate.
// Singular a body whose inertia H is singular: lost_pivot at its first degree of freedom, though M may be regular (aba_sweep and all
//          others take it). Not converged: not_converged, with the best pair; so where κ(N) is large, as of light bodies between heavy
//          ones, whatever κ(A) is.
// Cost     update 700 per body; one iteration about 300 per body and 24 per row and body; √κ(N) iterations, of a chain of n joints as
//          many as n² and more.
// Memory   O(n + m): 120 numbers per body, 6 per row and body.
// Workspace  refinement's + 24 per body and 5 (6 N + m), or m where that is more than 12 per body.
// Error    refined.
// Source   A. Tasora, M. Anitescu, A matrix-free cone complementarity approach for solving large-scale, nonsmooth, rigid body
//          dynamics, 2011: its fixed-point iteration without cones; accelerated as T. Heyn, M. Anitescu, A. Tasora, D. Negrut, Using
//          Krylov subspace and spectral methods for solving complementarity problems in many-body contact dynamics, 2013.
#pragma once

#include "algorithms/operators/refined.h"

namespace delassus {

template <class T> class MaximalFree : public Refined<T> {
 public:
  static constexpr int max_steps = 12;
  static constexpr Index max_iterations = 4000;  // of one correction

 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_rows(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report solve_pair(const typename Refinement<T>::Asked& asked, T* f, T* nu, Accuracy wanted, T* work) const override;
  [[nodiscard]] Index do_workspace(Index columns) const override;
  [[nodiscard]] Index do_bytes() const override;

 private:
  struct Part {  // of a row: k_[first] on `body`, and its negative on `parent` (ground: none)
    Index row, body, parent, first;
  };
  bool take_body(Index body, const Problem<T>& problem);
  void take_rows(const Problem<T>& problem);
  void take_joint_block(Index body);
  [[nodiscard]] Index unknowns() const { return 6 * this->structure()->bodies() + this->size(); }
  // Vectors of six per body
  void add_forces(const T* x, T* f) const;                             // f += Bᵀ x
  void add_torques(const T* tau, T* f) const;                          // f += S⁺ᵀτ on i, −S⁺ᵀτ on π(i)
  void accelerations(const T* f, T* a) const;                          // a = H⁻¹ f
  void rates(const T* a, T* y) const;                                  // y = B a
  void multiply(const T* x, T* y, T* bodies) const;                    // y = N x
  void precondition(const T* r, T* z) const;
  void iterate(T* r, T* x, T* work) const;                             // x = N⁻¹ r, r destroyed
  void correct(const T* r1, const T* r2, T* d_nu, T* d_lambda, T* work) const;

  Refinement<T> refinement_;
  BlockDiagonal<T> damping_;                // R⁻¹
  std::vector<Part> parts_;
  std::vector<Vector6<T>> k_;               // K, then 𝒦S⁺
  std::vector<Vector6<T>> pseudo_inverse_;  // rows of S⁺, per degree of freedom
  std::vector<Matrix6<T>> H_inverse_;
  std::vector<T> compliance_;               // per degree of freedom: of its row among those of the joint
  std::vector<Matrix6<T>> joint_;           // per body: its six rows, as columns, those of degrees of freedom first
  std::vector<Matrix6<T>> joint_block_;     // factor of its part of N
  std::vector<T> of_rows_, diagonal_;       // per row of J: its part of N without and with R⁻¹, the latter inverted
  Report regular_, factored_;
};

}  // namespace delassus
