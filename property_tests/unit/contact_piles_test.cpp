// Every solver on generated piles: what it calls solved is solved, and solvers agree on the motion.
#include <gtest/gtest.h>

#include "property_tests/contact_families.h"
#include "reference/definition.h"
#include "simulation/solvers.h"

namespace delassus {
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
        if (std::getenv("SHOW")) std::printf("%-14s contacts %2d seed %d iterations %5d residual %.1e gap %.1e\n", row.name.data(), int(contacts), int(seed), report.iterations, report.residuals.natural, report.gap);
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
        if (std::getenv("SHOW")) std::printf("%-14s contacts %2d seed %d iterations %5d residual %.1e %s\n", row.name.data(), int(contacts), int(seed), report.iterations, report.residuals.natural, name(report.status).data());
        EXPECT_TRUE(report.ok() || report.status == Status::not_converged);
        EXPECT_EQ(report.ok(), report.residuals.natural <= 1e-9);
      }
    }
}

}  // namespace
}  // namespace delassus
