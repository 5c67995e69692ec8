// Solvers on problems with a closed form, and on problems without a solution.
#include <gtest/gtest.h>

#include "simulation/solvers.h"

namespace delassus::simulation::contact_solvers_test {
namespace {

// A block of mass m on a plane, one contact, G = 1/m: falling with w, sliding with s.
ContactProblem<double> block(double mass, double mu, double w, double s, FrictionLaw law) {
  ContactProblem<double> p;
  p.resize(3);
  append_contact(p, mu);
  p.G = MatrixX<double>::Identity(3, 3) / mass;
  p.free_velocity << -w, 0.6 * s, 0.8 * s;
  p.law = law;
  return p;
}

struct Answer {
  SolverReport report;
  VectorX<double> lambda;
};
Answer solved(const SolverRow& row, const ContactProblem<double>& p, Wanted wanted = {1e-12, 10000}) {
  const auto solver = row.make();
  solver->analyze(p);
  Answer a;
  a.report = solver->solve(p, wanted, a.lambda);
  return a;
}

TEST(ContactSolvers, BlockSticksAndSlides) {
  for (const SolverRow& row : solvers()) {
    if (!row.exact || !row.given_matrix || !row.hard_rows) continue;
    SCOPED_TRACE(row.name);
    const Answer stuck = solved(row, block(2, 0.5, 3, 1, FrictionLaw::exact));
    ASSERT_TRUE(stuck.report.ok());
    EXPECT_NEAR(stuck.lambda[0], 6, 1e-10);
    EXPECT_NEAR(stuck.lambda[1], -1.2, 1e-10);
    const Answer slid = solved(row, block(2, 0.5, 3, 10, FrictionLaw::exact));  // λ_t = μ λ_n against the motion
    ASSERT_TRUE(slid.report.ok());
    EXPECT_NEAR(slid.lambda[0], 6, 1e-10);
    EXPECT_NEAR(slid.lambda[1], -0.6 * 3, 1e-10);
    EXPECT_NEAR(slid.lambda[2], -0.8 * 3, 1e-10);
    const Answer open = solved(row, block(2, 0.5, -3, 10, FrictionLaw::exact));
    ASSERT_TRUE(open.report.ok());
    EXPECT_EQ(open.lambda.norm(), 0);
  }
}

TEST(ContactSolvers, RelaxedBlockSeparatesByTheShift) {
  for (const SolverRow& row : solvers()) {
    if (!row.relaxed || !row.given_matrix || !row.hard_rows) continue;
    SCOPED_TRACE(row.name);
    const auto p = block(2, 0.5, 3, 10, FrictionLaw::relaxed);
    const Answer a = solved(row, p);
    ASSERT_TRUE(a.report.ok());
    const VectorX<double> u = p.G * a.lambda + p.free_velocity;
    EXPECT_NEAR(u[0], 0.5 * u.tail(2).norm(), 1e-10);
  }
}

// Two hard rows that ask for different velocities of one thing; a wall that cannot move is pushed through by a target.
TEST(ContactSolvers, NoSolutionIsNeverCalledConverged) {
  ContactProblem<double> equal;
  equal.resize(2);
  append(equal, Cone::free, 2);
  equal.G = MatrixX<double>::Constant(2, 2, 1.0);
  equal.target << 1, 2;
  ContactProblem<double> wall;
  wall.resize(1);
  append(wall, Cone::half_line, 1);
  wall.G = MatrixX<double>::Zero(1, 1);
  wall.target << 1;
  for (const SolverRow& row : solvers())
    for (const auto* p : {&equal, &wall}) {
      SCOPED_TRACE(row.name);
      const Answer a = solved(row, *p, {1e-9, 200});
      EXPECT_FALSE(a.report.ok());
      EXPECT_FALSE(a.report.residuals.natural <= 1e-9);
    }
}

TEST(ContactSolvers, AGroupThatIsOffHasNoImpulse) {
  for (const SolverRow& row : solvers()) {
    if (!row.exact || !row.given_matrix || !row.hard_rows) continue;
    SCOPED_TRACE(row.name);
    auto p = block(2, 0.5, 3, 10, FrictionLaw::exact);
    p.R_inverse.assign(3, std::numeric_limits<double>::infinity());
    const Answer a = solved(row, p);
    ASSERT_TRUE(a.report.ok());
    EXPECT_EQ(a.lambda.norm(), 0);
  }
}

TEST(ContactSolvers, WrongProblemsAreRefusedByName) {
  auto p = block(2, 0.5, 3, 10, FrictionLaw::exact);
  p.friction[1] = -1;
  try {
    p.validate();
    FAIL();
  } catch (const ModelError& e) {
    EXPECT_NE(std::string(e.what()).find("row 1"), std::string::npos) << e.what();
  }
  p = block(2, 0.5, 3, 10, FrictionLaw::exact);
  p.G(0, 1) = 1e-9;
  EXPECT_THROW(p.validate(), ModelError);
  p = block(2, 0.5, 3, 10, FrictionLaw::exact);
  p.R_inverse[1] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(p.validate(), ModelError);
}

}  // namespace
}  // namespace delassus::simulation::contact_solvers_test
