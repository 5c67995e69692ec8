// Every solver on generated piles: what it calls solved is solved, and solvers agree on the motion.
#include <gtest/gtest.h>

#include "property_tests/unit/allocations.h"
#include "generators/contact_families.h"
#include "reference/definition.h"
#include "property_tests/laws/laws.h"
#include "simulation/solvers.h"

namespace delassus::laws {
std::int64_t (*allocation_count)() = nullptr;  // set by count_allocations
}

namespace delassus::contact_piles_test {
namespace {

using namespace simulation;

TEST(ContactPiles, SolversOfConvexProblemsAgreeOnTheMotion) {
  for (std::uint64_t seed = 0; seed < 4; ++seed)
    for (const Index contacts : {2, 6, 12}) {
      const auto p = pile({.bodies = 3, .contacts = contacts, .damping = 1e-3, .law = FrictionLaw::relaxed, .seed = seed});
      const auto J = reference::dense(*p.mechanism, Damping<double>::uniform(p.rows(), 0.0)).M_inv_Jt;
      VectorX<double> first;
      for (const SolverRow& row : solvers()) {
        const auto solver = row.make();
        if (!solver->supports(p)) continue;
        SCOPED_TRACE(std::string(row.name) + " contacts " + std::to_string(contacts) + " seed " + std::to_string(seed));
        solver->analyze(p);
        VectorX<double> lambda;
        const auto report = solver->solve(p, {1e-9, 100000}, lambda);
        EXPECT_TRUE(report.ok()) << name(report.status) << " after " << report.iterations << ": " << report.residuals.natural;
        const VectorX<double> motion = J * lambda;
        if (first.size() == 0) first = motion;
        EXPECT_LT((motion - first).norm(), 1e-5 * (1 + first.norm()));
      }
    }
}

TEST(ContactPiles, ExactCoulombWithHardRows) {
  for (std::uint64_t seed = 0; seed < 4; ++seed)
    for (const Index contacts : {2, 6, 12}) {
      const auto p = pile({.bodies = 3, .contacts = contacts, .seed = seed});
      for (const SolverRow& row : solvers()) {
        const auto solver = row.make();
        if (!solver->supports(p)) continue;
        solver->analyze(p);
        VectorX<double> lambda;
        const auto report = solver->solve(p, {1e-9, 20000}, lambda);
        EXPECT_TRUE(report.ok() || report.status == Status::not_converged);
        EXPECT_EQ(report.ok(), report.residuals.natural <= 1e-9);
      }
    }
}

// Hard rows that depend on each other: λ = −R u cancels, and proximal must see where (the seeds of a table at which it stalled).
TEST(ContactPiles, ProximalReachesTheLastDigitsOfDependentRows) {
  for (const Index contacts : {20, 50})
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      auto p = pile({.bodies = 5, .contacts = contacts, .seed = seed});
      for (ConeRows& c : p.groups) c.cone = Cone::free;
      std::fill(p.friction.begin(), p.friction.end(), 0);
      const auto solver = find_solver("proximal").make();
      solver->analyze(p);
      VectorX<double> lambda;
      const auto report = solver->solve(p, {1e-12 * p.free_velocity.lpNorm<Eigen::Infinity>(), 500}, lambda);
      EXPECT_TRUE(report.ok()) << contacts << " contacts, seed " << seed << ": " << name(report.status) << ", " << report.residuals.natural;
    }
}

TEST(ContactPiles, ProximalGoesOnWhereAPivotIsLost) {
  const auto p = pile({.bodies = 5, .contacts = 30, .damping = 1e-4, .seed = 0});
  const auto solver = find_solver("proximal").make();
  solver->analyze(p);
  VectorX<double> lambda;
  const auto report = solver->solve(p, {1e-6 * p.free_velocity.lpNorm<Eigen::Infinity>(), 2000}, lambda);
  EXPECT_TRUE(report.ok()) << name(report.status) << " after " << report.iterations << ": " << report.residuals.natural;
}

// The second problem of a structure is solved without a single allocation.
// Contacts that coincide with unequal coefficients, damped: Γ converges by steps of Newton; alone it did not in 10000.
TEST(ContactPiles, ProximalFindsTheShiftOfContactsThatCoincide) {
  for (const Index repeats : {2, 3})
    for (std::uint64_t seed = 0; seed < 2; ++seed) {
      const Index contacts = 10 * repeats;
      const auto p = pile({.bodies = 25, .contacts = contacts, .distinct = contacts / 4, .damping = 1e-4, .joints = true, .seed = seed});
      const auto solver = find_solver("proximal").make();
      solver->analyze(p);
      VectorX<double> lambda;
      const auto r = solver->solve(p, {.velocity = 1e-10}, lambda);
      EXPECT_TRUE(r.ok()) << r.residuals.natural << " after " << r.iterations;
      EXPECT_LE(r.iterations, 1500);
      std::printf("  %ld contacts, seed %ld: %d iterations\n", static_cast<long>(contacts), static_cast<long>(seed), r.iterations);
    }
}

TEST(ContactPiles, NothingIsAllocatedAfterTheFirstSolve) {
  laws::count_allocations();
  if (laws::allocation_count == nullptr) GTEST_SKIP() << "skipped: allocations are not counted here";
  for (const FrictionLaw law : {FrictionLaw::exact, FrictionLaw::relaxed})
    for (const SolverRow& row : solvers()) {
      const PileSpec spec{.bodies = 3, .contacts = 5, .damping = 1e-3, .law = law, .seed = 7};
      auto p = pile(spec);
      const auto solver = row.make();
      if (!solver->supports(p)) continue;
      solver->analyze(p);
      VectorX<double> lambda;
      static_cast<void>(solver->solve(p, {1e-9, 500}, lambda));
      p.free_velocity *= 0.5;
      const auto before = laws::allocation_count();
      static_cast<void>(solver->solve(p, {1e-9, 500}, lambda));
      EXPECT_EQ(laws::allocation_count() - before, 0) << row.name;
    }
}

// Begun at the answer, a solver is there at once; begun nearby, it is not slower by much.
TEST(ContactPiles, WarmStartIsUsed) {
  for (const FrictionLaw law : {FrictionLaw::exact, FrictionLaw::relaxed})
    for (const SolverRow& row : solvers()) {
      auto p = pile({.bodies = 3, .contacts = 6, .damping = 1e-3, .law = law, .seed = 1});
      const auto solver = row.make();
      if (!solver->supports(p)) continue;
      solver->analyze(p);
      VectorX<double> lambda;
      const auto cold = solver->solve(p, {1e-9, 5000}, lambda);
      ASSERT_TRUE(cold.ok()) << row.name;
      p.warm_start = lambda;
      const auto warm = solver->solve(p, {1e-8, 5000}, lambda);
      EXPECT_TRUE(warm.ok());
      EXPECT_LE(warm.iterations, row.name == "newton_convex" ? 3 : 0) << row.name << " " << cold.iterations;
    }
}

}  // namespace
}  // namespace delassus::contact_piles_test
