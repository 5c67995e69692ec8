// T with Tᵀ T = M: what turns the motion into rows of a least-squares problem.
//
// Formula  ‖ν‖²_M = Σ_i |μ_i + C_iᵀ a_π|²,   ν_i = P_i μ_i,   a_i = a_π + (S_i P_i) μ_i,
//          with P_iᵀ (A_i + S_iᵀ H_i S_i) P_i = 1, P_i upper triangular, C_i = H_i S_i P_i and H_i the inertia of the
//          subtree seen through its joints: H_π += H_i − C_i C_iᵀ. P_i makes the n_i rows of joint i unit rows, each on
//          one number of its own.
// Singular lost_pivot with the degree of freedom whose pivot is at most 30 ε times its diagonal, or not positive.
// Cost     about 260 operations per body of one degree of freedom, 1600 per body of six.
// Error    that of the factor of M (factor.h).
// Source   R. Featherstone's articulated-body recursion, in the basis in which it is a Cholesky factor.
#pragma once

#include "algorithms/factors/plan.h"
#include "algorithms/kit/six.h"

namespace delassus {

template <class T> class MassRoot {
 public:
  /// Both arguments must outlive this; any plan in which children come before parents.
  void analyze(const Structure& structure, const Plan& plan);
  [[nodiscard]] Report update(const Problem<T>& problem);

  /// n_i columns of step i: S_i P_i, C_i (force on the parent), P_i.
  [[nodiscard]] const Six<T>* motion(int i) const { return motion_.data() + plan_->first_column[i]; }
  [[nodiscard]] const Six<T>* force(int i) const { return force_.data() + plan_->first_column[i]; }
  [[nodiscard]] const Six<T>* basis(int i) const { return basis_.data() + plan_->first_column[i]; }

  /// τᵀ M⁻¹ τ = Σ |w_i|², w_i = P_iᵀ τ_i + (S_i P_i)ᵀ f_i, f_π += f_i − C_i w_i. τ in the problem's order of degrees of
  /// freedom; `work` needs a Six<T> per body. Cost about 24 operations per degree of freedom.
  T energy(const T* tau, T* work) const;

  [[nodiscard]] Index bytes() const;

 private:
  [[nodiscard]] int eliminate(int i, const T* armature);  // −1, or the lost degree of freedom of the joint

  const Structure* structure_ = nullptr;
  const Plan* plan_ = nullptr;
  std::vector<Six<T>> motion_, force_, basis_;
  std::vector<SixBySix<T>> inertia_;  // H_i, complete when its turn comes
};

}  // namespace delassus
