// direct: equality rows by one solve.
//
// What     every row free (u = 0): λ of (G + R⁻¹) λ = target − g. No iteration.
// How      mechanism: ladder; of dependent hard rows that agree it picks one λ, which is not the only one (the motion is).
//          given matrix: L D Lᵀ with diagonal pivoting; rows whose pivot falls below 30 m eps of the largest get λ = 0.
// Cost     that of the ladder's rungs, O(n + m) with local loops; matrix: m³/3.
// Source   paper, equations 2–5.
#pragma once

#include "simulation/solver.h"

namespace delassus::simulation {

template <class T> class Direct : public ContactSolver<T> {
 public:
  [[nodiscard]] std::string refusal(const ContactProblem<T>& p) const override;

 protected:
  void do_analyze(const ContactProblem<T>& p) override;
  SolverReport do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) override;

 private:
  void by_matrix(const ContactProblem<T>& p, VectorX<T>& lambda);
  std::unique_ptr<Operator<T>> ladder_;
  std::unique_ptr<Workspace<T>> work_;
  Damping<T> damping_;
  VectorX<T> right_;
  MatrixX<T> A_;
  std::vector<Index> order_;
};

}  // namespace delassus::simulation
