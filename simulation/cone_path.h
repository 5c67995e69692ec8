// The path of steps with rows in cones: a contact problem for the solvers of the table.
//
//   v_f = ν + M̂⁻¹ h f,   g = J v_f;   (u, λ) in the cones with u = (J M̂⁻¹Jᵀ + R⁻¹) λ + g − target;   ν⁺ = v_f + M̂⁻¹Jᵀλ
// How      Rows that always hold come first, then those of the step. A plan is made anew only when other bodies or other numbers of
//          rows are concerned than in the last step; impulses are remembered by what a row is and start the next solve.
//          Where a step has no row in a cone, the path is that of its equations, or the free one.
// Never    is an impulse used that a solver is not sure of: the next one of the list is asked, and if none reaches the residual the
//          step ends with its words and the problem stays here to be written to a file (problems()).
// Cost     of the solver; building the problem 60 operations a row. Allocates where the rows change.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "simulation/paths.h"
#include "simulation/solvers.h"

namespace delassus::simulation {

/// Whether an impulse is that of a row that always holds: of[1] is its number.
[[nodiscard]] bool of_equation(const Identity& of);

/// The solvers asked one after another where none is named.
[[nodiscard]] const std::vector<std::string>& usual_solvers();

template <class T> class ConePath final : public Path<T> {
 public:
  /// `equations` of the rows that always hold, for steps without others; null where there are none, or where each step has others.
  /// `rows`: who those that always hold are from step to step; empty: 0, 1, …
  /// @throws ModelError for a solver that does not exist.
  ConePath(std::shared_ptr<const Structure> structure, const Damping<double>& damping, std::shared_ptr<EquationsPath<T>> equations,
           const std::string& solver, double residual, FrictionLaw law, std::vector<Index> rows = {});
  [[nodiscard]] std::string_view name() const override { return "cones"; }
  StepReport velocities(Moment<T>& now, VectorX<T>& change, VectorX<T>& impulses) override;
  void remember(const Moment<T>& now, State<T>& next) override;
  [[nodiscard]] Index bytes() const override;
  void problems(const typename Path<T>::Visit& visit) const override;

 private:
  struct Asked {
    std::string name;
    std::unique_ptr<ContactSolver<double>> solver;
    bool analyzed = false;
  };
  void plan(const std::vector<RowSet<T>>& rows);
  void fill(const Moment<T>& now);
  void start_warm(const Moment<T>& now);
  StepReport solve();

  std::shared_ptr<const Structure> base_;
  Damping<double> damping_;
  std::unique_ptr<FreePath<T>> free_;
  std::shared_ptr<EquationsPath<T>> equations_;
  double residual_;
  FrictionLaw law_;
  std::vector<Index> row_of_;  // identities of rows that always hold
  std::vector<Asked> solvers_;
  std::vector<std::array<Index, 4>> pattern_;  // per set of rows: kind, bodies, number
  std::shared_ptr<Structure> structure_;
  std::shared_ptr<Problem<T>> numbers_;
  std::shared_ptr<Problem<double>> mechanism_;  // the same, in double
  std::unique_ptr<TreeOperators<T>> tree_;
  ContactProblem<double> problem_;
  VectorX<double> lambda_;
  bool asked_ = false, solved_ = false;  // in the last step
  MatrixX<T> push_, motion_, rows_of_, more_;
};

}  // namespace delassus::simulation
