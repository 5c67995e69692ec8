// Judges of the accuracy of whole simulations: runs with errors that are known, and the orders of the integrators.
#include <gtest/gtest.h>

#include "bench/accuracy/accuracy_simulation.h"
#include "property_tests/unit/simulation/stepping_scenes.h"

namespace delassus::accuracy::accuracy_simulation_test {
namespace {

using namespace stepping;
using simulation::FrictionLaw;

constexpr double eps = 0x1p-53;

Matrix3<double> turn_about_z(double angle) {
  Matrix3<double> R;
  R << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
  return R;
}

/// Two bodies on straight lines that turn about z; off along y by 3 and 4 times `metres`, in angle by `radians`, growing with time.
Trajectory off_by(double metres, double radians, int instants) {
  Trajectory t;
  for (int k = 1; k <= instants; ++k) {
    const double share = double(k) / instants;
    std::vector<Placement> bodies;
    for (const int i : {0, 1})
      bodies.push_back({{100, 0, 0}, {share, (3 + i) * metres * share, double(i)}, turn_about_z(2 * share + radians * share)});
    t.at.push_back(bodies);
  }
  t.seconds = 1;
  return t;
}

const double rms_of_3_and_4 = std::sqrt(12.5);

/// Of every cell of a line.
template <class F> void each(const SimulatedLine& line, F&& f) {
  for (const SimulatedCell& c : line.cells) f(c);
}

SimulationOptions quick(Runner runner = simulate) {
  SimulationOptions o;
  o.duration = 1, o.step = 1.0 / 8, o.halvings = 3;
  o.budget = 0;
  o.runner = std::move(runner);
  return o;
}

TEST(Trajectories, DistanceIsTheRootMeanSquareOverBodiesAndTheLargestOfInstants) {
  const Distance d = distance(off_by(1e-3, 1e-4, 4), off_by(0, 0, 4));
  EXPECT_LT(std::abs(d.metres - 1e-3 * rms_of_3_and_4) / (eps * 4), 30);
  EXPECT_LT(std::abs(d.radians - 1e-4) / (eps * 4), 30);
  EXPECT_NEAR(distance(off_by(0, 3, 1), off_by(0, 0, 1)).radians, 3, 1e-14) << "beyond a right angle";
  Trajectory broken = off_by(0, 0, 3);
  EXPECT_TRUE(std::isnan(distance(broken, off_by(0, 0, 4)).metres)) << "another number of instants";
  broken = off_by(0, 0, 4);
  broken.at[2][0].centre[1] = std::nan("");
  EXPECT_TRUE(std::isnan(distance(broken, off_by(0, 0, 4)).size()));
  broken = off_by(0, 0, 4);
  broken.why_not = "ended";
  EXPECT_TRUE(std::isnan(distance(broken, off_by(0, 0, 4)).size()));
}

/// x_h = x + c hᵖ gives x; with a term h^(p+1) beside it the estimate is not below the error.
TEST(Trajectories, ReferencesAreLimits) {
  for (const int order : {1, 2, 4, 5}) {
    const auto pure = [&](double h) { return off_by(std::pow(h, order), 0.1 * std::pow(h, order), 3); };
    const Reference r = reference_of(pure(0.125), pure(0.25), pure(0.5), order);
    ASSERT_TRUE(r.extrapolates);
    EXPECT_NEAR(r.order, order, 1e-9);
    EXPECT_LT(distance(r.limit, off_by(0, 0, 3)).size() / (eps * 4), 30);
    EXPECT_LT(r.error.size() / (eps * 4), 30);
    const auto mixed = [&](double h) { return off_by(std::pow(h, order) + 0.2 * std::pow(h, order + 1), 0, 3); };
    const Reference m = reference_of(mixed(0.125), mixed(0.25), mixed(0.5), order);
    ASSERT_TRUE(m.extrapolates);
    EXPECT_GE(m.error.metres, distance(m.limit, off_by(0, 0, 3)).metres);
    EXPECT_LT(distance(m.limit, off_by(0, 0, 3)).metres, distance(mixed(0.125), off_by(0, 0, 3)).metres);
  }
  // of lower order than declared: nothing is extrapolated, and the estimate holds
  const auto root = [](double h) { return off_by(std::sqrt(h), 0, 3); };
  const Reference r = reference_of(root(0.125), root(0.25), root(0.5), 2);
  EXPECT_FALSE(r.extrapolates);
  EXPECT_NEAR(r.order, 0.5, 1e-9);
  EXPECT_NEAR(r.error.metres, distance(r.limit, off_by(0, 0, 3)).metres, 1e-9);
  Trajectory ended = off_by(0, 0, 3);
  ended.why_not = "at 0.1 s: not converged";
  const Reference none = reference_of(off_by(0, 0, 3), off_by(0, 0, 3), ended, 1);
  EXPECT_EQ(none.why_not, ended.why_not);
  EXPECT_TRUE(std::isnan(none.error.size()) && std::isnan(distance(off_by(0, 0, 3), none.limit).size()));
}

/// Every integrator with 3·hᵖ of its own order, but one of a lower one than it declares.
TEST(SimulationAccuracy, KnownErrorsAreReportedAsSuch) {
  const auto order_of = [](const std::string& integrator) { return integrator == "euler" ? 1 : integrator == "runge_kutta" || integrator == "implicit_midpoint" ? 2 : integrator == "sdirk4" ? 4 : 5; };
  const auto error_of = [&](const Settings& s) { return s.error > 0 ? 7 * s.error : 3 * std::pow(s.step, order_of(s.integrator)); };
  const SimulatedScene s = measure_simulation(double_pendulum(), quick([&](const Scene&, const accuracy::Run& run) {
    EXPECT_NEAR(run.instants * double(run.steps_each) * run.settings.step, 1, 1e-12);
    Trajectory t = off_by(error_of(run.settings), 0.5 * error_of(run.settings), run.instants);
    t.seconds = run.settings.step;
    t.iterations = 4;
    return t;
  }));
  ASSERT_TRUE(s.reference.why_not.empty());
  EXPECT_EQ(s.lines.size(), 7u);  // dormand_prince and sdirk4 also under control
  EXPECT_FALSE(s.has_relaxed);
  for (const SimulatedLine& line : s.lines) {
    ASSERT_EQ(line.cells.size(), line.controlled ? 5u : 4u);
    for (std::size_t k = 0; k < line.cells.size(); ++k) {
      const SimulatedCell& c = line.cells[k];
      Settings settings = line.settings;
      settings.step = c.step, settings.error = c.tolerance;
      EXPECT_EQ(c.step, line.controlled ? 0.125 : std::ldexp(0.125, -int(k)));
      EXPECT_LT(std::abs(c.error.metres - rms_of_3_and_4 * error_of(settings)) / (eps * 4), 30) << line.name << k;
      EXPECT_LT(std::abs(c.error.radians - 0.5 * error_of(settings)) / (eps * 4), 30) << line.name << k;
      EXPECT_EQ(c.iterations, 4);
      EXPECT_TRUE(std::isnan(c.seconds)) << "no budget, no times";
      if (k > 0 && !line.controlled) {
        EXPECT_NEAR(c.order, order_of(line.settings.integrator), 1e-6) << line.name;
      }
    }
  }
}

/// Each part of the error of a relaxed run stands where it belongs.
TEST(SimulationAccuracy, ModellingErrorApart) {
  SimulationOptions o = quick([](const Scene&, const accuracy::Run& run) {
    const double h = run.settings.step, law = run.settings.friction == FrictionLaw::relaxed ? 0.25 * h + 1 : 0;
    return off_by(1e-3 * (h + law), 0, run.instants);
  });
  o.solvers = {"proximal"};
  o.tolerances = {1e-8};
  const SimulatedScene s = measure_simulation(thrown_box(), o);
  ASSERT_EQ(s.lines.size(), 6u);  // exact, relaxed, and four integrators that the fake takes all the same
  EXPECT_NEAR(s.between_laws.metres, 1e-3 * rms_of_3_and_4, 1e-12);
  for (const SimulatedLine& line : s.lines)
    each(line, [&](const SimulatedCell& c) {
      const double unit = 1e-3 * rms_of_3_and_4;
      EXPECT_NEAR(c.error.metres, unit * (line.relaxed ? 1.25 * c.step + 1 : c.step), 1e-12);
      EXPECT_NEAR(c.numerical.metres, unit * (line.relaxed ? 1.25 : 1) * c.step, 1e-12);
      if (line.relaxed) {
        EXPECT_NEAR(c.modelling.metres, unit * (0.25 * c.step + 1), 1e-12);
      } else {
        EXPECT_TRUE(std::isnan(c.modelling.metres));
      }
    });
}

/// What fails has no error and no time; smaller steps of what took too long are not tried; what is refused is said once.
TEST(SimulationAccuracy, FailuresSayWhyAndNeverLookFast) {
  SimulationOptions o = quick([](const Scene&, const accuracy::Run& run) {
    Trajectory t = off_by(1e-3 * run.settings.step, 0, run.instants);
    const std::string& by = run.settings.integrator;
    if (by == "euler" && run.settings.step == 0.0625) t.why_not = "at 0.5 s: not converged", t.at.resize(3), t.seconds = 1e-9;
    if (by == "runge_kutta") t.why_not = "not within 1 s", t.too_long = true;
    if (by == "dormand_prince" && run.settings.error > 0) t.why_not = "refused here", t.refused = true;
    return t;
  });
  o.budget = 1e-6;
  const SimulatedScene s = measure_simulation(double_pendulum(), o);
  const SimulatedLine &euler = s.lines.at(0), &classical = s.lines.at(1), &controlled = s.lines.at(3);
  EXPECT_EQ(euler.cells[1].why_not, "at 0.5 s: not converged");
  EXPECT_TRUE(std::isnan(euler.cells[1].error.size()) && std::isnan(euler.cells[1].seconds) && std::isnan(euler.cells[1].order));
  EXPECT_TRUE(std::isnan(euler.cells[2].order)) << "no order from a run that failed";
  EXPECT_EQ(euler.cells[0].seconds, 1);
  EXPECT_EQ(classical.cells[0].why_not, "not within 1 s");
  for (std::size_t k = 1; k < 4; ++k) EXPECT_NE(classical.cells[k].why_not.find("not tried"), std::string::npos);
  EXPECT_EQ(controlled.why_not, "refused here");
  EXPECT_TRUE(controlled.cells.empty());
}

/// The table's own integrators on a smooth motion: the order seen is the declared one, off by what the next order adds.
TEST(SimulationAccuracy, OrdersSeenAreThoseDeclared) {
  SimulationOptions o = quick();
  o.step = 1.0 / 32, o.halvings = 4;
  const SimulatedScene s = measure_simulation(double_pendulum(), o);
  EXPECT_TRUE(s.reference.why_not.empty()) << s.reference.why_not;
  EXPECT_LT(s.reference.error.size(), 1e-10);
  int seen = 0;
  for (const SimulatedLine& line : s.lines) {
    EXPECT_TRUE(line.why_not.empty());
    if (line.controlled) {
      for (const SimulatedCell& c : line.cells) EXPECT_LT(c.error.size(), 10 * c.tolerance + 3 * s.reference.error.size()) << "the motion stretches errors no more in a second";
      for (std::size_t k = 1; k < line.cells.size(); ++k) EXPECT_LT(line.cells[k - 1].steps, line.cells[k].steps);
      continue;
    }
    for (const SimulatedCell& c : line.cells)
      if (c.step < 0.01 && !std::isnan(c.order)) {
        EXPECT_NEAR(c.order, line.order, 0.25) << line.name << " " << c.step;
        ++seen;
      }
  }
  EXPECT_GE(seen, 10);
}

/// A cube that slides: the relaxation puts (3, 0) m/s into the cone u_n ≥ ½ |u_t|, which is (2.4, 1.2) m/s, and throws it up by 0.07 m,
/// whatever the step. The three errors are distances between four trajectories: triangles hold.
TEST(SimulationAccuracy, TheRelaxationOfASlidingCube) {
  Scene scene = thrown_box();
  scene.motion.restitution = 0;
  scene.motion.nu << 0, 0, 0, 3, 0, 0;
  SimulationOptions o = quick();
  o.duration = 0.25, o.step = 1.0 / 64, o.halvings = 2;
  o.solvers = {"proximal"};
  o.tolerances = {1e-10};
  o.integrators = {"euler"};
  const SimulatedScene s = measure_simulation(scene, o);
  ASSERT_EQ(s.lines.size(), 2u);
  const auto &exact = s.lines[0], &relaxed = s.lines[1];
  ASSERT_TRUE(relaxed.relaxed && !exact.relaxed);
  EXPECT_GT(s.between_laws.metres, 0.05);
  for (std::size_t k = 0; k < 3; ++k) {
    const SimulatedCell &e = exact.cells[k], &r = relaxed.cells[k];
    ASSERT_TRUE(r.why_not.empty() && e.why_not.empty()) << r.why_not << e.why_not;
    EXPECT_GT(r.modelling.metres, 0.05);
    EXPECT_LE(std::abs(r.modelling.metres - s.between_laws.metres), r.numerical.metres + e.error.metres + 1e-12);
    EXPECT_LE(r.error.metres, r.modelling.metres + e.error.metres + 1e-9) << "1e-9: two runs by solvers to 1e-10 m/s";
    EXPECT_LE(r.error.metres, r.numerical.metres + s.between_laws.metres + 1e-12);
  }
}

TEST(SimulationAccuracy, OptionsThatNothingDependsOnAreRefused) {
  const auto refused = [](const Scene& scene, auto&& change, const std::string& words) {
    SimulationOptions o = quick();
    change(o);
    try {
      (void)measure_simulation(scene, o);
      ADD_FAILURE() << "accepted: " << words;
    } catch (const ModelError& e) {
      EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
    }
  };
  refused(double_pendulum(), [](auto& o) { o.solvers = {"pgs"}; }, "--solver");
  refused(thrown_box(), [](auto& o) { o.solvers = {"pgss"}; }, "pgss");
  refused(thrown_box(), [](auto& o) { o.ops = {"ladder"}; }, "--op");
  refused(double_pendulum(), [](auto& o) { o.ops = {"ladder"}; }, "--op");
  refused(double_pendulum(), [](auto& o) { o.integrators = {"euler"}, o.tolerances = {1e-3}; }, "--tolerance");
  refused(double_pendulum(), [](auto& o) { o.duration = 0.3; }, "--duration");
  refused(double_pendulum(), [](auto& o) { o.integrators = {"rk4"}; }, "rk4");
}

/// Each option is seen in the lines or in their runs.
TEST(SimulationAccuracy, OptionsChangeWhatIsRun) {
  const Scene loop = slider_crank(0.3, 0.8, 0.4, 5);
  SimulationOptions o = quick();
  o.integrators = {"euler"};
  EXPECT_EQ(simulated_lines(loop, o).size(), 2u);
  o.ops = {"lcaba_qr", "ladder"}, o.tolerances = {1e-4, 1e-5, 1e-6};
  const auto lines = simulated_lines(loop, o);
  ASSERT_EQ(lines.size(), 6u);
  EXPECT_EQ(lines[1].settings.op, "lcaba_qr");
  EXPECT_EQ(lines[1].settings.accuracy, 1e-5);
  SimulationOptions cube = quick();
  cube.integrators = {"euler"}, cube.solvers = {"pgs", "ccp"}, cube.tolerances = {1e-4};
  const auto by = simulated_lines(thrown_box(), cube);  // pgs solves both laws, ccp the relaxation
  ASSERT_EQ(by.size(), 3u);
  EXPECT_EQ(by[0].settings.solver, "pgs");
  EXPECT_EQ(by[0].settings.residual, 1e-4);
  EXPECT_FALSE(by[0].relaxed);
  EXPECT_TRUE(by[2].relaxed);
  SimulationOptions none = quick();
  int runs = 0;
  none.stop = [&] { return ++runs > 3; };
  EXPECT_LT(measure_simulation(double_pendulum(), none).lines[0].cells.size(), 4u);
}

}  // namespace
}  // namespace delassus::accuracy::accuracy_simulation_test
