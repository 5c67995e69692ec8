// The profile of solvers: solvers that lie, that count, that give up; profiles in closed form; what the generated problems say they are.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/simulation/solver_profile.h"
#include "bench/text.h"

namespace delassus::bench::solver_profile_test {
namespace {

using namespace simulation;

/// A block of 2 kg that falls on a plane with 3 m/s and slides with 1 m/s: it sticks, λ = (6, −1.2, −1.6).
SolverProblem block() {
  SolverProblem q{"exact", "block", {}, NAN};
  ContactProblem<double>& p = q.problem;
  p.resize(3);
  append_contact(p, 0.5);
  p.G = MatrixX<double>::Identity(3, 3) / 2;
  p.free_velocity << -3, 0.6, 0.8;
  return q;
}

class Fake : public ContactSolver<double> {
  [[nodiscard]] std::string refusal(const ContactProblem<double>&) const override { return ""; }
  void do_analyze(const ContactProblem<double>&) override {}
};
/// Judged by numbers of another problem, in which nothing falls.
class Liar final : public Fake {
  ContactProblem<double> other_;
  SolverReport do_solve(const ContactProblem<double>& p, const Wanted&, VectorX<double>&) override {
    other_ = p;
    other_.free_velocity.setZero();
    static_cast<void>(op_.update(other_));
    return {};
  }
};
/// There after 7 iterations where 1e-8 is asked for, after 4 where less is, never beyond.
class Counter final : public Fake {
  SolverReport do_solve(const ContactProblem<double>&, const Wanted& wanted, VectorX<double>& lambda) override {
    SolverReport r;
    const double relative = wanted.velocity / 3;
    r.iterations = relative > 1e-6 ? 4 : relative > 1e-10 ? 7 : wanted.iterations;
    lambda << 6, -1.2, -1.6;
    if (relative < 1e-10) lambda[0] += 2e-9, r.status = Status::not_converged;
    return r;
  }
};
class Singular final : public Fake {
  SolverReport do_solve(const ContactProblem<double>&, const Wanted&, VectorX<double>&) override {
    SolverReport r;
    r.status = Status::lost_pivot;
    return r;
  }
};
class Refuser final : public ContactSolver<double> {
  [[nodiscard]] std::string refusal(const ContactProblem<double>&) const override { return "not today"; }
  void do_analyze(const ContactProblem<double>&) override {}
  SolverReport do_solve(const ContactProblem<double>&, const Wanted&, VectorX<double>&) override { return {}; }
};
template <class S> SolverRow row(std::string_view name) {
  SolverRow r = find_solver("pgs");
  r.name = name;
  r.make = [] { return std::unique_ptr<ContactSolver<double>>(new S); };
  return r;
}

TEST(SolverProfile, SuccessIsWhatTheResidualSaysAndCountsAreKept) {
  const auto q = profile_problem(block(), {row<Liar>("liar"), row<Counter>("counter"), row<Singular>("singular"), row<Refuser>("refuser")}, 50);
  EXPECT_EQ(q.rows, 3);
  EXPECT_EQ(q.rank, 3);
  for (const SolverRun& r : q.runs[0]) EXPECT_EQ(r.outcome, "says_ok");
  EXPECT_NEAR(q.runs[0][0].residual, 1, 0.5) << "nothing was done about the fall";
  const Runs& counter = q.runs[1];
  EXPECT_EQ(counter[0].outcome, "solved");
  EXPECT_EQ(counter[0].iterations, 4);
  EXPECT_EQ(counter[1].outcome, "solved");
  EXPECT_EQ(counter[1].iterations, 7);
  EXPECT_EQ(counter[2].outcome, "not_converged");
  EXPECT_EQ(counter[2].iterations, 50);
  EXPECT_NEAR(counter[2].residual, 1e-9 / 3, 1e-10) << "2e-9 N s too much on 2 kg";
  for (const SolverRun& r : q.runs[2]) EXPECT_EQ(r.outcome, "lost_pivot");
  for (const SolverRun& r : q.runs[3]) EXPECT_TRUE(r.refused());
}

SolverProfile by_hand() {
  SolverProfile p;
  p.solvers = {"a", "b"};
  const auto at = [](const char* outcome, int iterations, double time) {
    Runs r;
    r.fill({outcome, iterations, time, 1e-13});
    return r;
  };
  p.problems = {{"exact", "1", 1, 3, 3, {at("solved", 10, 1), at("solved", 1, 4)}},
                {"exact", "2", 1, 6, 3, {at("solved", 10, 2), at("solved", 20, 1)}},
                {"exact", "3", 2, 9, 3, {at("not_converged", 99, 1), at("solved", 5, 50)}},
                {"exact", "4", 2, 9, 2, {at("says_ok", 2, 0.1), at("refused", 0, NAN)}},
                {"relaxed", "5", 2, 9, 9, {at("solved", 2, 0.1), at("solved", 2, 0.2)}}};
  return p;
}

TEST(SolverProfile, ProfilesInClosedForm) {
  const SolverProfile p = by_hand();
  const auto share = [&](std::size_t solver, Measure by, double tau) { return profile_at(p, "exact", solver, 1, by, tau); };
  EXPECT_EQ(share(0, Measure::time, 1), 0.25);
  EXPECT_EQ(share(0, Measure::time, 2), 0.5);
  EXPECT_EQ(share(0, Measure::time, 1e9), 0.5) << "failures never count";
  EXPECT_EQ(share(1, Measure::time, 1), 0.5);
  EXPECT_EQ(share(1, Measure::time, 4), 0.75);
  EXPECT_EQ(share(0, Measure::iterations, 1), 0.25);
  EXPECT_EQ(share(0, Measure::iterations, 10), 0.5);
  EXPECT_EQ(share(1, Measure::iterations, 1), 0.5);
  EXPECT_TRUE(std::isnan(profile_at(p, "equality", 0, 1, Measure::time, 1)));
}

TEST(SolverProfile, TablesCountFailuresAndTheFileHoldsThem) {
  const SolverProfile p = by_hand();
  const std::string text = solver_text(p);
  for (const char* const words : {"1 not_converged, 1 says_ok", "0 · 0 · 0 of 2", "all 2", "½ to 1", "Coulomb, relaxed"}) EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
  const auto again = nlohmann::json::parse(solver_json(p)).get<SolverProfile>();
  EXPECT_EQ(solver_text(again), text);
  EXPECT_EQ(solver_json(again), solver_json(p));
}

TEST(SolverProfile, GeneratedProblemsAreWhatTheySay) {
  int repeated = 0, exact = 0;
  for (const SolverProblem& q : generated_problems(1)) {
    if (q.density > 2) continue;
    const ContactProblem<double>& p = q.problem;
    p.validate();
    const auto n = p.mechanism->structure->dofs();
    EXPECT_DOUBLE_EQ(static_cast<double>(p.rows()), q.density * static_cast<double>(n)) << q.name;
    const auto profiled = profile_problem(q, {}, 1);
    EXPECT_LE(profiled.rank, std::min(p.rows(), n));
    if (q.name.find("repeated") != std::string::npos && q.density <= 1) {
      EXPECT_LT(profiled.rank, p.rows()) << q.name;
      ++repeated;
    }
    exact += q.set == "exact";
  }
  EXPECT_EQ(repeated, 5 * 2 * 3);
  EXPECT_EQ(exact, 4 * 4 * 2);
}

}  // namespace
}  // namespace delassus::bench::solver_profile_test
