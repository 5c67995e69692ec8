#include "algorithms/kit/test_scalars.h"
#include "property_tests/campaigns/ladder_problems.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "generators/random.h"

namespace delassus::laws {

const std::vector<Mechanism>& mechanisms() {
  static const std::vector<Mechanism> table{
      {"chain", 7, "an arm held at its tip and its middle"},
      {"swimmer", 8, "a free chain held at both ends"},
      {"quadruped", 13, "12 independent rows"},
      {"quadruped_feet", 13, "48 rows of rank 18"},
      {"humanoid", 26, "contacts, a loop of the arms and joint friction: 55 rows of rank 31"},
      {"four_bar", 4, "one four-bar linkage, a dependent row"},
      {"four_bar", 16, "five of them"},
      {"near_singular", 3, "an arm stretched to a bend of 1e-4"},
      {"stretched", 5, "an arm stretched to 1e-9"},
      {"folded", 5, "an arm folded to 1e-6"},
      {"mass_ratio", 10, "masses from 1e-3 to 1e4 kg"},
      {"heavy_tip", 5, "1e6 kg carried by 1e-6 kg"},
      {"heavy_base", 5, "the other way round"},
      {"contacts", 2, "two boxes, 24 rows of rank 12"},
      {"contacts", 8, "a tower of eight"},
      {"unequal_stack", 2, "1e9 kg on 1 kg"},
      {"unequal_stack", 6, "1 kg and 1e9 kg in turn"},
      {"long_chain", 200, "200 joints"},
      {"redundant", 5, "closures given twice"},
      {"ring", 12, "a loop through all bodies"},
      {"lattice", 9, "as many loops as bodies"},
      {"rungs", 9, "loops that share bodies"},
      {"truss", 5, "rods along random directions"},
      {"parallel_hinges", 4, "doors on two hinges each"},
      {"world_frame", 4, "described from a point 1 km away"},
  };
  return table;
}

double largest_eigenvalue(const Problem<double>& problem) {
  const Index m = problem.structure->rows;
  const auto op = find_operator("aba_sweep").make<double>();
  op->analyze(problem.structure);
  if (!op->update(problem, Damping<double>::uniform(m, 0)).ok()) throw std::runtime_error("M is singular");
  Workspace<double> work(op->workspace(m));
  MatrixX<double> A0(m, m);
  static_cast<void>(op->apply(MatrixX<double>::Identity(m, m), A0, work));
  return Eigen::SelfAdjointEigenSolver<MatrixX<double>>(A0, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

Damping<double> damping_at(const Level& level, double largest_eigenvalue, Index rows, std::uint64_t seed) {
  generators::Random random(seed);
  Damping<double> d = Damping<double>::uniform(rows, 0);
  for (double& x : d.diagonal) x = largest_eigenvalue * std::pow(10.0, -random.integer(level.low, level.high));
  return d;
}

VectorX<double> constraint_acceleration(const Problem<double>& problem, const VectorX<double>& nu) {
  const Structure& s = *problem.structure;
  const Problem<Quad> p = problem.cast<Quad>();
  std::vector<Vector6<Quad>> motion(s.bodies(), Vector6<Quad>::Constant(Quad(0)));
  for (Index i = 0; i < s.bodies(); ++i) {
    Vector6<Quad>& v = motion[i];
    if (const Index up = s.parent[i]; up != ground) v = motion[up];
    for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) v += p.S[k] * Quad(nu[k]);
  }
  VectorX<Quad> a = VectorX<Quad>::Constant(s.rows, Quad(0));
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (Index r = 0; r < e.rows; ++r)
        for (Index j = 0; j < 6; ++j) a[e.row + r] += p.K[link.first + r][j] * motion[link.body][j];
  for (const auto& e : s.joint_constraints)
    for (Index r = 0; r < e.rows; ++r)
      for (Index k = 0; k < s.dofs(e.body); ++k)
        a[e.row + r] += p.joint_K[e.first + r * s.dofs(e.body) + k] * Quad(nu[s.first_dof[e.body] + k]);
  VectorX<double> rounded(s.rows);
  for (Index r = 0; r < s.rows; ++r) rounded[r] = static_cast<double>(a[r]);
  return rounded;
}

}  // namespace delassus::laws
