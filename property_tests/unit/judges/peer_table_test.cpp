// Peers: who solves another problem is not timed; those compiled in solve ours; ratios, and the file the page is printed from.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "algorithms/delassus.h"
#include "bench/peers/peer_table.h"
#include "bench/table1/uses.h"
#include "reference/definition.h"

namespace delassus::bench::peer_table_test {
namespace {

/// What is wrong with a peer.
enum class Defect : std::uint8_t { none, mass, product, sign, not_a_number, damping_kept, damping_for_once, digits };

/// Answers by operators of ours, but for its defect.
class Pretender : public Peer {
 public:
  Pretender(const Scene& scene, const Damping<double>& damping, const VectorX<double>& x, Defect defect)
      : defect_(defect), noise_(std::fmod(1e15 * scene.q.sum(), 1)), problem_(problem_of(scene)), damping_(damping), other_(other_damping(damping)), x_(x), y_(x), op_(find_operator("dense_cholesky").make<double>()) {
    op_->analyze(problem_.structure);
    workspace_ = std::make_unique<Workspace<double>>(op_->workspace());
    EXPECT_TRUE(op_->update(problem_, damping_).ok());
  }
  void take(Step step) override {
    ++taken;
    if (step == Step::first_product || step == Step::first_solve || (step == Step::solve && defect_ == Defect::damping_for_once)) must(op_->update(problem_, damping_));
    if (step == Step::new_damping && defect_ != Defect::damping_kept) must(op_->update_damping((odd_ = !odd_) ? other_ : damping_));
    if (step == Step::first_product || step == Step::product) must(op_->apply(x_, y_, *workspace_));
    else if (step != Step::kinematics) must(op_->solve(x_, y_, *workspace_));
    if (step == Step::product && defect_ == Defect::product) y_(0, 0) *= 1 + 1e-3;
    if (step == Step::solve && defect_ == Defect::digits) y_(0, 0) += 1e-3 * (0.5 + noise_) * y_.cwiseAbs().maxCoeff();
    if (step == Step::solve && defect_ == Defect::sign) y_(1, 0) *= -1;
    if (step == Step::solve && defect_ == Defect::not_a_number) y_(2, 0) = NAN;
  }
  [[nodiscard]] VectorX<double> answer() const override { return y_.col(0); }
  [[nodiscard]] MatrixX<double> M() override {
    MatrixX<double> M = reference::mass_matrix(problem_);
    if (defect_ == Defect::mass) M(3, 3) *= 1 + 1e-7;
    return M;
  }
  static inline int taken = 0;

 private:
  static void must(const Report& report) { EXPECT_TRUE(report.ok()); }

  Defect defect_;
  double noise_;  ///< of the last bits of q
  Problem<double> problem_;
  Damping<double> damping_, other_;
  MatrixX<double> x_, y_;
  std::unique_ptr<Operator<double>> op_;
  std::unique_ptr<Workspace<double>> workspace_;
  bool odd_ = false;
};

template <Defect defect> std::unique_ptr<Peer> pretend(const Scene& s, const Damping<double>& d, const VectorX<double>& x) { return std::make_unique<Pretender>(s, d, x, defect); }
/// Damped by one part in twenty more.
Damping<double> damped_more(Damping<double> d) {
  for (double& r : d.diagonal) r *= 1.05;
  return d;
}
std::unique_ptr<Peer> damped_otherwise(const Scene& s, const Damping<double>& d, const VectorX<double>& x) { return std::make_unique<Pretender>(s, damped_more(d), x, Defect::none); }

PeerRow row(std::unique_ptr<Peer> (*make)(const Scene&, const Damping<double>&, const VectorX<double>&), bool from_q = false) {
  return {"pretender", "a test", "answers by dense_cholesky", "aba_sweep", "lcaba", from_q, make};
}

PeerScene measured(const PeerRow& r) { return measure_peers(open_scene("go2_standing"), {r}, 0.0005); }

TEST(Peers, AnHonestOneIsTimedBesideOurs) {
  const PeerScene s = measured(row(pretend<Defect::none>));
  const PeerEntry& e = *s.find("pretender");
  EXPECT_EQ(e.disagrees, "");
  for (std::size_t k = 0; k < step_count; ++k) EXPECT_GT(e.time[k].median, 0) << name(step(k));
  EXPECT_LT(e.M_error, 1e-14);
  EXPECT_LT(e.force_error, 1e-12);
  for (const char* ours : {"aba_sweep", "lcaba", certified_default}) ASSERT_NE(s.find(ours), nullptr) << ours;
  EXPECT_EQ(s.entries.size(), 4u) << "only what the peers name, and the default";
  EXPECT_TRUE(s.find("aba_sweep")->of(Step::product).measured() && !s.find("aba_sweep")->of(Step::solve).measured());
}

TEST(Peers, WhoSolvesAnotherProblemIsNotTimed) {
  struct Case {
    const char* what;
    PeerRow row;
    const char* says;
    int steps;  ///< until it is found out, and once more at the next q where it might be rounding
  };
  for (const Case& c : {Case{"a twentieth more damping", row(damped_otherwise), "first_product", 4}, Case{"a heavier body", row(pretend<Defect::mass>), "M:", 1},
                        Case{"one row of a product", row(pretend<Defect::product>), "product", 6}, Case{"a sign", row(pretend<Defect::sign>), "solve", 10},
                        Case{"no number", row(pretend<Defect::not_a_number>), "inf", 5}, Case{"the damping kept", row(pretend<Defect::damping_kept>), "new_damping", 12},
                        Case{"the new damping for one solve", row(pretend<Defect::damping_for_once>), "solve", 14}}) {
    Pretender::taken = 0;
    const PeerScene s = measured(c.row);
    const PeerEntry& e = *s.find("pretender");
    EXPECT_NE(e.disagrees.find(c.says), std::string::npos) << c.what << ": " << e.disagrees;
    EXPECT_EQ(Pretender::taken, c.steps) << c.what;
    EXPECT_FALSE(e.loses_digits) << c.what;
    for (const Spread& t : e.time) EXPECT_FALSE(t.measured()) << c.what;
    PeerTable t;
    t.scenes.push_back(s);
    EXPECT_EQ(t.disagreements(), 1);
    EXPECT_NE(peer_text(t).find("was not timed**"), std::string::npos);
  }
}

TEST(Peers, WhoLosesDigitsIsNotTimedAndNoDisagreement) {
  PeerTable t;
  t.scenes.push_back(measured(row(pretend<Defect::digits>)));
  const PeerEntry& e = *t.scenes[0].find("pretender");
  EXPECT_NE(e.disagrees, "");
  EXPECT_TRUE(e.loses_digits);
  for (const Spread& time : e.time) EXPECT_FALSE(time.measured());
  EXPECT_EQ(t.disagreements(), 0);
  EXPECT_NE(peer_text(t).find("loses too many digits here"), std::string::npos);
  EXPECT_TRUE(nlohmann::json(t).get<PeerTable>().scenes[0].find("pretender")->loses_digits);
}

TEST(Peers, ThoseCompiledInSolveOurProblemAndNoOther) {
  for (const char* name : {"go2_standing", "cassie"})
    for (PeerRow r : peers()) {
      const Scene scene = open_scene(name);
      const PeerScene right = measure_peers(scene, {r}, 0.0005);
      EXPECT_EQ(right.find(r.name)->disagrees, "") << name << " " << r.name;
      if (!right.find(r.name)->cannot.empty()) continue;
      EXPECT_LT(right.find(r.name)->M_error, 1e-12) << name << " " << r.name;
      // A maker has no state: the scene is given another damping than the comparison is told.
      static PeerRow told;
      told = r;
      r.make = [](const Scene& s, const Damping<double>& d, const VectorX<double>& x) { return told.make(s, damped_more(d), x); };
      const PeerScene wrong = measure_peers(scene, {r}, 0.0005);
      EXPECT_NE(wrong.find(r.name)->disagrees, "") << name << " " << r.name << " with another damping";
      for (const Spread& t : wrong.find(r.name)->time) EXPECT_FALSE(t.measured());
    }
}

TEST(Peers, WithoutAnyItSaysWhatToInstall) {
  try {
    check_found({});
    FAIL();
  } catch (const ModelError& e) {
    for (const char* word : {"no peer", "Pinocchio 4", "libmujoco-dev", "docs/peers.md", "--from"}) EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << word;
  }
}

/// 30 µs of kinematics, 10 of a first product, 5 of a product for ours; the peer 20 and 4 of its two.
PeerTable known_table(bool from_q) {
  PeerTable t;
  for (const char* scene : {"first", "second"}) {
    PeerScene s{scene, 3, 2, false, 1e-4, 1e-4, 1e-6, 1e-6, {}};
    PeerEntry peer, ours;
    peer.name = "theirs", peer.program = "P", peer.product = "aba_sweep", peer.from_q = from_q;
    ours.name = "aba_sweep";
    const auto set = [](PeerEntry& e, Step step, double median) { e.time[static_cast<std::size_t>(step)] = {median, median, median, 3}; };
    set(ours, Step::kinematics, 30), set(ours, Step::first_product, 10), set(ours, Step::product, 5);
    set(peer, Step::first_product, 20), set(peer, Step::product, std::string(scene) == "first" ? 4 : 16);
    s.entries = {peer, ours};
    t.scenes.push_back(s);
  }
  t.scenes[1].entries[0].M_error = 1e-16;
  return t;
}

TEST(Peers, RatiosCountKinematicsOnceOnBothSides) {
  const PeerTable apart = known_table(false), from_q = known_table(true);
  const PeerEntry &a = apart.scenes[0].entries[0], &b = from_q.scenes[0].entries[0];
  EXPECT_DOUBLE_EQ(apart.scenes[0].ratio(a, Step::first_product, "aba_sweep"), 2);
  EXPECT_DOUBLE_EQ(from_q.scenes[0].ratio(b, Step::first_product, "aba_sweep"), 0.5);
  EXPECT_DOUBLE_EQ(from_q.scenes[0].ratio(b, Step::product, "aba_sweep"), 0.8);
  EXPECT_TRUE(std::isnan(apart.scenes[0].ratio(a, Step::solve, "aba_sweep")));
  EXPECT_TRUE(std::isnan(apart.scenes[0].ratio(a, Step::product, "nobody")));
  const std::string text = peer_text(apart);
  EXPECT_NE(text.find("1.60 (0.800 … 3.20)"), std::string::npos) << text;
  EXPECT_NE(text.find("1 of 4 cells. product: first 0.800."), std::string::npos) << text;
}

TEST(Peers, ThePageIsThatOfTheFile) {
  PeerTable t = known_table(true);
  t.scenes[0].entries[0].cannot = "elbow: no such joint";
  t.load = 1.5;
  const auto read = nlohmann::json::parse(nlohmann::json(t).dump()).get<PeerTable>();
  EXPECT_EQ(peer_text(read), peer_text(t));
  EXPECT_EQ(nlohmann::json(read), nlohmann::json(t));
  EXPECT_NE(peer_text(t).find("- first, `theirs`: no such joint"), std::string::npos) << peer_text(t);
}

}  // namespace
}  // namespace delassus::bench::peer_table_test
