// Steps per second beside other programs: the residual of a step in closed form; who moves otherwise is not timed; the file is the page.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "bench/simulation/own_simulator.h"
#include "bench/simulation/simulation_speed.h"

namespace delassus::bench::simulation_speed_test {
namespace {

using Vector = VectorX<double>;
constexpr double h = 1e-3;

/// A free body of 2 kg with a contact at its centre of mass: J M⁻¹Jᵀ = 1/2, normal z, coefficient 1/2.
Model body() {
  Model m;
  Body b;
  b.name = "body", b.mass = 2;
  b.inertia.setIdentity();
  b.joint.type = JointType::floating;
  m.add(b);
  return m;
}
/// After a step with that velocity and impulse (normal, two tangents), its momentum whole.
Stepped step(const Vector3<double>& velocity, const Vector3<double>& impulse, double gap = 0) {
  Stepped s;
  s.q = neutral(body());
  s.after = Vector::Zero(6), s.after.tail<3>() = velocity;
  s.pushed = s.added = Vector::Zero(6);
  s.before = s.after;
  s.before.tail<3>() -= Vector3<double>(impulse[1], impulse[2], impulse[0]) / 2;
  Poses<double> at;
  poses(body(), s.q, at);
  s.rows.push_back({contact_in_world(at, 0, ground, {0, 0, 0}, Matrix3<double>::Identity(), 0.5), impulse, {}, gap});
  return s;
}
StepResidual of(const Stepped& s) { return residual_of(body(), s, h); }

TEST(StepResidual, InClosedForm) {
  // Sticks: nothing is wrong. Slides against its friction, Γ accepted: nothing, too.
  for (const Stepped& s : {step({0, 0, 0}, {1, 0.3, 0}), step({0.2, 0, 0}, {1, -0.5, 0})}) {
    EXPECT_LT(of(s).natural, 1e-15);
    EXPECT_LT(of(s).momentum, 1e-15);
    EXPECT_LT(of(s).cone, 1e-15);
  }
  // Creeps within the cone: ‖ũ‖ with ũ = (0.1, 0.2, 0).
  EXPECT_NEAR(of(step({0.2, 0, 0}, {1, 0.3, 0})).natural, std::sqrt(0.05), 1e-14);
  // Approaches with 0.1 m/s: that.
  EXPECT_NEAR(of(step({0, 0, -0.1}, {1, 0, 0})).approach, 0.1, 1e-14);
  EXPECT_NEAR(of(step({0, 0, -0.1}, {1, 0, 0})).natural, 0.1, 1e-14);
  // Pushes from a gap of 1 mm that it does not close in the step: γ λ_n, since 1 m/s is left.
  EXPECT_NEAR(of(step({0, 0, 0}, {1, 0, 0}, 1e-3)).natural, 0.5, 1e-14);
  EXPECT_LT(of(step({0, 0, -1}, {1, 0, 0}, 1e-3)).natural, 1e-14) << "closes it";
  // Separates while it pushes: a penetration is taken back, but not with 2 m/s: γ λ_n.
  EXPECT_LT(of(step({0, 0, 0.5}, {1, 0, 0}, -1e-3)).natural, 1e-14);
  EXPECT_NEAR(of(step({0, 0, 2}, {1, 0, 0}, -1e-3)).natural, 0.5, 1e-14);
  EXPECT_NEAR(of(step({0, 0, 0.5}, {1, 0, 0}, -1e-3)).depth, 1e-3, 1e-18);
  // Pulls; more friction than there is.
  EXPECT_NEAR(of(step({0, 0, 0}, {-1, 0, 0})).cone, 1, 1e-14);
  EXPECT_NEAR(of(step({0, 0, 0}, {1, 0.9, 0})).cone, 0.4, 1e-14);
  // Momentum out of nowhere, and that which something holds.
  Stepped lost = step({0, 0, 0}, {1, 0, 0});
  lost.before[3] += 0.25;
  EXPECT_NEAR(of(lost).momentum, 0.5, 1e-14);
  lost.held = {3};
  EXPECT_LT(of(lost).momentum, 1e-15);
  // What is implicit counts; so does the scene's compliance.
  Stepped damped = step({0, 0, 0}, {1, 0, 0});
  damped.added[5] = 3;
  EXPECT_NEAR(of(damped).momentum, 1.5, 1e-14);
  Stepped soft = step({0, 0, -0.1}, {1, 0, 0});
  soft.rows[0].R_inverse = Vector::Constant(3, 0.1);
  EXPECT_LT(of(soft).natural, 1e-14);
}

TEST(StepResidual, NoNumberIsTheLargestError) {
  Stepped s = step({0, 0, 0}, {1, 0, 0});
  s.after[3] = NAN;
  EXPECT_FALSE(of(s).natural <= 1e300);
}

/// What is wrong with a program.
enum class Defect : std::uint8_t { none, mass, gravity, not_a_number, impulse, ends };

/// Ours, but for its defect.
class Pretender final : public Simulator {
 public:
  Pretender(const Scene& scene, double step, Defect defect) : defect_(defect), ours_(own_simulator(scene, step, 1e-9)) {}
  void reset() override { ours_->reset(), at_ = 0; }
  bool step() override {
    ++taken;
    if (defect_ == Defect::ends && ++at_ == 11) return false;
    return ours_->step();
  }
  [[nodiscard]] std::string why_not() const override { return "tired"; }
  [[nodiscard]] Stepped last() const override {
    Stepped s = ours_->last();
    if (defect_ == Defect::impulse)
      for (HeldRows& r : s.rows) r.impulse *= 1.001;
    return s;
  }
  [[nodiscard]] Index contacts() const override { return ours_->contacts(); }
  [[nodiscard]] Index row_count() const override { return ours_->row_count(); }
  [[nodiscard]] int iterations() const override { return 7; }
  [[nodiscard]] MatrixX<double> M(const Vector& q) override {
    MatrixX<double> M = ours_->M(q);
    if (defect_ == Defect::mass) M(3, 3) *= 1 + 1e-7;
    return M;
  }
  [[nodiscard]] Vector free_acceleration(const Vector& q, const Vector& nu) override {
    Vector a = ours_->free_acceleration(q, nu);
    if (defect_ == Defect::gravity) a[5] += 1e-3;
    if (defect_ == Defect::not_a_number) a[2] = NAN;
    return a;
  }
  static inline int taken = 0;

 private:
  Defect defect_;
  std::unique_ptr<Simulator> ours_;
  int at_ = 0;
};

template <Defect defect> std::unique_ptr<Simulator> pretend(const Scene& s, double step) { return std::make_unique<Pretender>(s, step, defect); }
std::unique_ptr<Simulator> refuse(const Scene&, double) { throw ModelError("", "pretender", "has no hands", "a scene without them"); }

const SpeedExample standing{"go2", "docs/moving/go2.yaml", 1e-10, 60, true, {"wrenches"}};
SpeedScene measured(std::unique_ptr<Simulator> (*make)(const Scene&, double)) { return measure_speed(standing, {{"pretender", "a test", "ours, but for its defect", make}}, 1e-4); }

TEST(SimulationSpeed, AnHonestOneIsJudgedAndTimedBesideOurs) {
  const SpeedScene s = measured(pretend<Defect::none>);
  const SpeedEntry &ours = *s.find(own_name), &theirs = *s.find("pretender");
  for (const SpeedEntry* e : {&ours, &theirs}) {
    EXPECT_EQ(e->disagrees + e->ended + e->cannot, "");
    EXPECT_EQ(e->steps, 60);
    EXPECT_EQ(e->contacts, 4);
    EXPECT_GT(e->time.median, 0);
    EXPECT_LT(e->M_error, 1e-12);
    EXPECT_LT(e->worst.momentum, 1e-14);
    EXPECT_LT(e->worst.natural, e == &ours ? 1.1e-10 : 1.1e-9);
    EXPECT_GE(e->worst.natural, e->median.natural);
  }
  EXPECT_EQ(theirs.iterations, 7);
  EXPECT_NE(s.as_accurate_as("pretender"), nullptr);
}

TEST(SimulationSpeed, WhoMovesOtherwiseIsNotTimed) {
  struct Case {
    std::unique_ptr<Simulator> (*make)(const Scene&, double);
    const char* says;
  };
  for (const Case& c : {Case{pretend<Defect::mass>, "M: relative"}, Case{pretend<Defect::gravity>, "without rows"}, Case{pretend<Defect::not_a_number>, "inf"}}) {
    Pretender::taken = 0;
    const SpeedScene s = measured(c.make);
    const SpeedEntry& e = *s.find("pretender");
    EXPECT_NE(e.disagrees.find(c.says), std::string::npos) << e.disagrees;
    EXPECT_EQ(Pretender::taken, 0) << c.says;
    EXPECT_FALSE(e.time.measured());
    SimulationSpeed t;
    t.scenes.push_back(s);
    EXPECT_EQ(t.disagreements(), 1);
    EXPECT_NE(speed_text(t).find("was not timed**"), std::string::npos);
  }
  EXPECT_GT(measured(pretend<Defect::impulse>).find("pretender")->worst.momentum, 1e-6) << "impulses that are not those of the motion";
}

TEST(SimulationSpeed, WhatEndsEarlyOrCannotSaysSo) {
  const SpeedScene s = measured(pretend<Defect::ends>);
  EXPECT_EQ(s.find("pretender")->ended, "step 11: tired");
  EXPECT_EQ(s.find("pretender")->steps, 10);
  const SpeedScene none = measured(refuse);
  EXPECT_NE(none.find("pretender")->cannot.find("no hands"), std::string::npos);
  EXPECT_FALSE(none.find("pretender")->time.measured());
  EXPECT_THROW((void)measure_speed({}, {}, 1, {}, {}), ModelError);
}

TEST(SimulationSpeed, ThoseCompiledInMoveAsOursAndNotOtherwise) {
  for (const char* name : {"docs/moving/go2.yaml", "docs/moving/four_bar.yaml", "docs/moving/cassie.yaml", "docs/moving/hand.yaml"})
    for (SimulatorRow r : simulators()) {
      SpeedExample example{name, name, 1e-10, 10};
      const SpeedScene right = measure_speed(example, {r}, 1e-4);
      const SpeedEntry& e = *right.find(r.name);
      EXPECT_EQ(e.disagrees + e.cannot, "") << name;
      EXPECT_LT(e.worst.momentum, 1e-9) << name << " " << r.name;
      EXPECT_LT(e.worst.cone, 1e-12) << name << " " << r.name;
      // A maker has no state: it is given another scene than the comparison is told.
      static SimulatorRow told;
      static void (*spoil)(Scene&);
      told = r;
      r.make = [](const Scene& s, double step) {
        Scene other = s;
        spoil(other);
        return told.make(other, step);
      };
      for (void (*const by)(Scene&) : {+[](Scene& s) { s.has_gravity = true, s.gravity[1] += 1e-4; }, +[](Scene& s) { s.model.bodies.back().com[0] += 1e-5; }, +[](Scene& s) {
             if (s.motion.motors.empty()) s.model.bodies[0].mass *= 1.001;
             else s.motion.motors.back().stiffness *= 1.01;
           }}) {
        spoil = by;
        EXPECT_NE(measure_speed(example, {r}, 1e-4).find(r.name)->disagrees, "") << name << " " << r.name;
      }
    }
}

TEST(SimulationSpeed, EveryExampleOfThePageIsMeasured) {
  std::ifstream page("docs/examples.md");
  ASSERT_TRUE(page);
  const std::regex line("^delassus simulate (\\S+).*--duration.*");
  int lines = 0;
  for (std::string s; std::getline(page, s);) {
    std::smatch of;
    if (!std::regex_match(s, of, line)) continue;
    ++lines;
    const auto& all = speed_examples();
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const SpeedExample& e) { return e.scene == of[1]; })) << s;
  }
  EXPECT_EQ(lines, static_cast<int>(speed_examples().size()));
}

/// Ours 10 µs a step at 1e-10, 2 at 1e-3; theirs 5 at 1e-3.
SimulationSpeed known() {
  SimulationSpeed t;
  const auto entry = [](const std::string& name, const char* program, double time, double residual) {
    SpeedEntry e;
    e.name = name, e.program = program, e.time = {time, time, time, 3}, e.steps = 10;
    e.median.natural = e.worst.natural = residual;
    return e;
  };
  SpeedScene s{{"walker", "walker.yaml", 1e-10, 10, true, {}}, 6, {}};
  s.entries = {entry(own_name, "", 10, 1e-10), entry("theirs", "P 1", 5, 1e-3), entry(own_name_at("theirs"), "", 2, 1e-3)};
  t.scenes.push_back(s);
  return t;
}

TEST(SimulationSpeed, RatiosAreOfEqualResidual) {
  SimulationSpeed t = known();
  EXPECT_EQ(t.scenes[0].as_accurate_as("theirs")->time.median, 2);
  std::string text = speed_text(t);
  EXPECT_NE(text.find("against ours where ours is no coarser, 1 examples: nowhere."), std::string::npos) << text;
  EXPECT_NE(text.find("at the residual of the example, 1 examples: **on robots: walker 2 times**."), std::string::npos) << text;
  EXPECT_NE(text.find("| 100000 |"), std::string::npos) << text;
  t.scenes[0].entries[2].median.natural = 2e-3;  // coarser than theirs: does not count
  EXPECT_EQ(t.scenes[0].as_accurate_as("theirs")->time.median, 10);
  text = speed_text(t);
  EXPECT_NE(text.find("no coarser, 1 examples: **on robots: walker 2 times**."), std::string::npos) << text;
  EXPECT_EQ(t.scenes[0].as_accurate_as("nobody"), nullptr);
}

TEST(SimulationSpeed, ThePageIsThatOfTheFile) {
  SimulationSpeed t = known();
  t.load = 1.5;
  t.scenes[0].entries[1].ended = "step 3: unstable";
  t.scenes[0].entries[1].worst.depth = INFINITY;
  const auto read = nlohmann::json::parse(nlohmann::json(t).dump()).get<SimulationSpeed>();
  EXPECT_EQ(speed_text(read), speed_text(t));
  EXPECT_EQ(nlohmann::json(read), nlohmann::json(t));
  EXPECT_NE(speed_text(t).find("∞"), std::string::npos);
}

}  // namespace
}  // namespace delassus::bench::simulation_speed_test
