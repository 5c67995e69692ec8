// Contact problems as text: what is written is read back bit for bit, others' files are read, bad ones are refused where they are bad.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "generators/contact_families.h"
#include "simulation/problem_file.h"
#include "simulation/solvers.h"

namespace delassus::problem_file_test {
namespace {

using namespace simulation;

bool same(const std::vector<double>& a, const std::vector<double>& b) { return a == b; }

void expect_same(const ContactProblem<double>& a, const ContactProblem<double>& b) {
  EXPECT_EQ(a.G, b.G);
  EXPECT_EQ(a.free_velocity, b.free_velocity);
  EXPECT_EQ(a.target, b.target);
  EXPECT_EQ(a.law, b.law);
  EXPECT_TRUE(same(a.R_inverse, b.R_inverse) && same(a.friction, b.friction) && same(a.low, b.low) && same(a.high, b.high));
  ASSERT_EQ(a.warm_start.size(), b.warm_start.size());
  EXPECT_EQ(a.warm_start, b.warm_start);
  ASSERT_EQ(a.groups.size(), b.groups.size());
  for (std::size_t k = 0; k < a.groups.size(); ++k)
    EXPECT_TRUE(a.groups[k].cone == b.groups[k].cone && a.groups[k].row == b.groups[k].row && a.groups[k].rows == b.groups[k].rows);
}

ContactProblem<double> every_cone() {
  ContactProblem<double> p;
  p.resize(8);
  append(p, Cone::free, 1);
  append(p, Cone::half_line, 2);
  append(p, Cone::box, 2);
  append_contact(p, 0.3);
  p.friction[7] = 0.7;
  p.G = MatrixX<double>::Identity(8, 8) / 3;
  p.free_velocity = VectorX<double>::LinSpaced(8, -0.1, 1e-300);
  p.target[3] = -1.0 / 7;
  p.R_inverse = {0.1, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), 0, 1e-12, 0, 0, 0};
  p.low[3] = -std::numeric_limits<double>::infinity();
  p.high[3] = 2;
  p.high[4] = std::numeric_limits<double>::infinity();
  p.warm_start = VectorX<double>::Constant(8, 0.1);
  p.law = FrictionLaw::relaxed;
  return p;
}

TEST(ProblemFile, RoundTripKeepsEveryBit) {
  expect_same(every_cone(), read_contact_problem(contact_problem_text(every_cone()), "text").problem);
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const auto p = pile({.bodies = 3, .contacts = 5, .damping = seed % 2 == 0 ? 0 : 1e-3, .seed = seed});
    const auto file = read_contact_problem(contact_problem_text(p), "text");
    EXPECT_TRUE(file.own);
    expect_same(as_given_matrix(p), file.problem);
    EXPECT_LT((file.problem.G - as_matrix(p).G).norm(), 1e-13 * file.problem.G.norm());
  }
}

// What others read: the text before our section.
TEST(ProblemFile, OthersReadTheSameProblem) {
  auto p = pile({.bodies = 3, .contacts = 4, .damping = 1e-3, .seed = 3});
  const std::string text = contact_problem_text(p);
  const auto others = read_contact_problem(text.substr(0, text.find("delassus")), "text");
  EXPECT_FALSE(others.own);
  const auto given = as_given_matrix(p);
  MatrixX<double> A = given.G;
  for (Index r = 0; r < A.rows(); ++r) A(r, r) += p.R_inverse[static_cast<std::size_t>(r)];
  EXPECT_EQ(others.problem.G, A);
  EXPECT_EQ(others.problem.free_velocity, p.free_velocity - p.target);
  EXPECT_EQ(others.problem.friction, p.friction);
}

TEST(ProblemFile, BlocksAndGlobalProblemsAreRead) {
  const auto blocks = read_contact_problem("3 1  1 3 3  1 1 1  3  3  2 1  0 1  0  0  1 0.5 0  0.5 2 0  0 0 4  -1 0.5 0  0.3", "text").problem;
  EXPECT_EQ(blocks.G(0, 1), 0.5);
  EXPECT_EQ(blocks.G(2, 2), 4);
  EXPECT_EQ(blocks.friction[2], 0.3);
  // M = 2, H = (1 0): G = [0.5 0; 0 0], q = 4, b = (−1, 0.25): g = (1, 0.25)
  const auto global = read_contact_problem("2 1  0 1 1 1 1 2  0 1 2 1 2 1 0  4  -1 0.25  0.5", "text");
  EXPECT_TRUE(global.global);
  EXPECT_EQ(global.problem.G(0, 0), 0.5);
  EXPECT_EQ(global.problem.G(1, 1), 0);
  EXPECT_EQ(global.problem.free_velocity[0], 1);
}

TEST(ProblemFile, BadTextIsRefusedWhereItIsBad) {
  const std::string good = "2\n1\n0\n2 2\n2 2\n1 0\n0 1\n-1 0.5\n0.3\n";
  EXPECT_NO_THROW(static_cast<void>(read_contact_problem(good, "f")));
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& says) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    try {
      static_cast<void>(read_contact_problem(text, "f.dat"));
      ADD_FAILURE() << "taken: " << text;
    } catch (const ModelError& e) {
      EXPECT_NE(std::string(e.what()).find(says), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("f.dat"), std::string::npos) << e.what();
    }
  };
  refused("1 0\n0 1", "1 0\nx 1", "line 7");
  refused("1 0\n0 1", "1 0\n0.5 1", "asymmetric");
  refused("2\n1", "4\n1", "line 1");
  refused("2 2\n2 2", "2 2\n2 3", "line");
  refused("0.3\n", "0.3 7\n", "line");
  refused("0.3\n", "0.3 0 0\n", "line");
  EXPECT_EQ(read_contact_problem(good + "1", "f").mark, 1);
  refused("0.3\n", "-0.3\n", "μ");
  refused("-1 0.5\n0.3\n", "-1", "line");
  refused("1 0\n0 1", "1 nan\nnan 1", "nan");
  for (std::size_t k = 0; k + 1 < good.size(); ++k) {  // cut anywhere: refused, or a whole problem all the same
    try {
      static_cast<void>(read_contact_problem(good.substr(0, k), "f"));
    } catch (const ModelError&) {
    }
  }
}

// Another group's collection: 26 files of Siconos' test data (Apache-2.0), which are not part of this repository.
TEST(ProblemFile, CollectionFromElsewhere) {
  const char* const folder = std::getenv("DELASSUS_FRICTION_CONTACT");
  if (folder == nullptr) GTEST_SKIP() << "skipped: set DELASSUS_FRICTION_CONTACT to a folder of friction-contact files (*.dat)";
  int files = 0;
  std::map<std::string, int> solved;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".dat") continue;
    ++files;
    const auto file = load_contact_problem(entry.path().string());
    expect_same(file.problem, read_contact_problem(contact_problem_text(file.problem), "text").problem);
    std::printf("  %-40s %3d contacts, asymmetry %.1e%s", entry.path().filename().c_str(), static_cast<int>(file.problem.groups.size()), file.asymmetry, file.global ? ", global" : "");
    for (const SolverRow& row : solvers()) {
      const auto solver = row.make();
      if (!solver->supports(file.problem)) continue;
      solver->analyze(file.problem);
      VectorX<double> lambda;
      const double scale = std::max(file.problem.free_velocity.lpNorm<Eigen::Infinity>(), 1e-300);
      const auto report = solver->solve(file.problem, {1e-8 * scale, 20000}, lambda);
      solved[std::string(row.name)] += report.ok();
      std::printf(" %s %s %d %.0e", row.name.data(), report.ok() ? "ok" : "NO", report.iterations, report.residuals.natural / scale);
    }
    std::printf("\n");
  }
  EXPECT_GT(files, 0);
  for (const auto& [name, count] : solved) std::printf("  %s solved %d of %d\n", name.c_str(), count, files);
}

}  // namespace
}  // namespace delassus::problem_file_test
