// The algorithms by the names people know: RNEA, CRBA, ABA, and forward dynamics under constraints.
//
//   rnea              τ = M ν̇ + c(q, ν)
//   crba              M, dense
//   aba               ν̇ = M⁻¹ (τ − c)
//   constrained_aba   M ν̇ + c = τ + Jᵀλ,   J ν̇ + J̇ν + R⁻¹λ = a         (paper, equations 2 and 5, damped as in 4)
//
// Every row is an equation: a contact held by these may pull, a limit too. Cones and inequalities are a solver's business.
// a is the acceleration wanted of the rows, zero where constraints just hold; the paper's a_des is a − J̇ν. R⁻¹ = 0 is a hard
// row; the more damping, the more a row gives way: its acceleration is off by R⁻¹λ.
// How      c and J̇ν by motion.h; M⁻¹ by the articulated-body factor (factor.h); ν̇ and λ by an operator of the table,
//          its solve_kkt with r₁ = τ − c and r₂ = a − J̇ν, ladder unless another one is named: its report comes with the answer.
// Sizes    n degrees of freedom, m rows; forces [N m or N], accelerations [rad/s² or m/s²], in the order of model.h.
// Cost     O(N + m) but for crba, which is O(n d + n²) at depth d and allocates; nothing else does after the
//          first call, or what the operator does for the first time.
// Threads  one each.
// Source   J. Luh, M. Walker, R. Paul 1980; M. Walker, D. Orin 1982 (CRBA); R. Featherstone 1983 (paper's [6]); paper's [12], [17].
#pragma once

#include <memory>
#include <string_view>

#include "algorithms/mechanism/motion.h"
#include "algorithms/operators/operator.h"

namespace delassus {

/// M of a problem's numbers, n × n, by composite inertias: H_π += H_i inwards, M_jk = S_jᵀ H_i S_k for the joints j on the path
/// of body i. Serves every scalar.
template <class T> void crba(const Problem<T>& problem, MatrixX<T>& M);

/// Forward dynamics on plain numbers: everything that c and J̇ν do not enter but as vectors. Serves every scalar that its operator
/// serves.
template <class T> class ForwardDynamics {
 public:
  /// λ by this operator of the table. @throws ModelError for a bad structure or an unknown name.
  explicit ForwardDynamics(std::shared_ptr<const Structure> structure, std::string_view op = "ladder");
  ForwardDynamics(ForwardDynamics&&) noexcept;
  ~ForwardDynamics();

  /// Numbers at a configuration. Report: lost_pivot where M is singular, otherwise what the operator says of its damping.
  [[nodiscard]] Report update(const Problem<T>& problem, const Damping<T>& damping);
  /// The same numbers at another R⁻¹.
  [[nodiscard]] Report update_damping(const Damping<T>& damping);

  /// ν̇ = M⁻¹ f for f = τ − c. Shapes n. Report: lost_pivot; ν̇ is NaN then.
  [[nodiscard]] Report aba(const VectorX<T>& f, VectorX<T>& acceleration);
  /// M ν̇ − Jᵀλ = f,  J ν̇ + R⁻¹λ = a. Shapes n and m. The report is that of Operator::solve_kkt and holds for the pair;
  /// see there for what it holds when it is not ok.
  [[nodiscard]] Report constrained_aba(const VectorX<T>& f, const VectorX<T>& a, Accuracy wanted, VectorX<T>& acceleration,
                                       VectorX<T>& lambda);

 private:
  struct Numbers;  // the factor of M, the operator, scratch
  std::unique_ptr<Numbers> own_;
};

/// The same from a model, a configuration and velocities.
template <class T> class Dynamics {
 public:
  /// g: acceleration of gravity [m/s², world axes]. @throws ModelError as structure_of, or for an unknown operator.
  explicit Dynamics(const Model& model, const Vector3<T>& g = Vector3<T>::Constant(T(0)), std::string_view op = "ladder");
  Dynamics(const Dynamics&) = delete;  // its parts point at each other
  Dynamics& operator=(const Dynamics&) = delete;

  /// q (q_size) and ν (n); constraints damped as given. Report: as ForwardDynamics. @throws std::logic_error when sizes do not fit.
  [[nodiscard]] Report update(const VectorX<T>& q, const VectorX<T>& nu, const Damping<T>& damping);

  // Everything below is at the last q and ν.
  [[nodiscard]] const VectorX<T>& bias_forces() const { return c_; }  ///< c(q, ν), gravity included. Shape n
  [[nodiscard]] const VectorX<T>& bias_rows() const { return rows_; }  ///< J̇ν. Shape m
  [[nodiscard]] const Problem<T>& problem() const { return problem_; }
  /// τ = M ν̇ + c. Shapes n.
  void rnea(const VectorX<T>& acceleration, VectorX<T>& tau) { motion_.rnea(acceleration, g_, tau); }
  /// M, n × n.
  void crba(MatrixX<T>& M) const { delassus::crba(problem_, M); }
  /// ν̇ = M⁻¹ (τ − c), no constraint forces. Shapes n.
  [[nodiscard]] Report aba(const VectorX<T>& tau, VectorX<T>& acceleration);
  /// ν̇ (n) and λ (m) under torques τ (n), the rows accelerating by a (m) less R⁻¹λ.
  [[nodiscard]] Report constrained_aba(const VectorX<T>& tau, const VectorX<T>& a, VectorX<T>& acceleration, VectorX<T>& lambda,
                                       Accuracy wanted = Accuracy::full());

 private:
  Vector3<T> g_;
  Mechanism<T> mechanism_;
  Motion<T> motion_;
  Problem<T> problem_;
  ForwardDynamics<T> forward_;
  VectorX<T> c_, rows_, force_, target_;
};

}  // namespace delassus
