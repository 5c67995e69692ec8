#include "bench/simulation/solver_problems.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "algorithms/errors/message.h"
#include "bench/text.h"
#include "generators/contact_families.h"
#include "simulation/problem_file.h"

namespace delassus::bench {

namespace {

using simulation::Cone;
using simulation::ContactProblem;
using simulation::FrictionLaw;

struct PileKind {
  const char* name;
  Index bodies;
  bool joints;
  Index repeats;  ///< one contact in so many is its own; 1: all are
};
constexpr PileKind pile_kinds[] = {{"free", 5, false, 1}, {"free_repeated", 5, false, 2}, {"chain", 25, true, 1}, {"chain_repeated", 25, true, 4}};
constexpr Index freedoms = 30;  // of every kind

ContactProblem<double> problem_of(const PileKind& kind, double density, double damping, FrictionLaw law, int seed) {
  const Index contacts = std::llround(density * freedoms / 3);
  return pile({.bodies = kind.bodies, .contacts = contacts, .distinct = (contacts + kind.repeats - 1) / kind.repeats, .damping = damping,
               .joints = kind.joints, .law = law, .seed = static_cast<std::uint64_t>(seed)});
}

void make_equalities(ContactProblem<double>& p) {
  for (auto& c : p.groups) c.cone = Cone::free;
  std::fill(p.friction.begin(), p.friction.end(), 0);
}

}  // namespace

std::vector<SolverProblem> generated_problems(int seeds) {
  std::vector<SolverProblem> out;
  for (const char* const set : {"equality", "relaxed", "exact"})
    for (const double density : densities)
      for (const PileKind& kind : pile_kinds)
        for (int seed = 0; seed < seeds; ++seed)
          for (const double damping : {0.0, 1e-4}) {
            const bool equality = set == std::string("equality");
            if (equality && damping > 0) continue;
            auto p = problem_of(kind, density, damping, set == std::string("exact") ? FrictionLaw::exact : FrictionLaw::relaxed, seed);
            if (equality) make_equalities(p);
            out.push_back({set, format("%s %g %s %d", kind.name, density, damping > 0 ? "damped" : "hard", seed), std::move(p), density});
          }
  return out;
}

std::vector<SolverProblem> problems_of(const std::string& folder) {
  namespace fs = std::filesystem;
  const std::string accepted = "a folder of contact problems, *.dat (docs/solvers.md); name one behind --problems";
  std::error_code none;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder, none))
    if (entry.path().extension() == ".dat") files.push_back(entry.path());
  if (none) throw ModelError(folder, "folder", "cannot be read", accepted);
  if (files.empty()) throw ModelError(folder, "folder", "holds no file *.dat", accepted);
  std::sort(files.begin(), files.end());
  std::vector<SolverProblem> out;
  for (const fs::path& file : files) out.push_back({"elsewhere", file.stem().string(), simulation::load_contact_problem(file.string()).problem, NAN});
  return out;
}

}  // namespace delassus::bench
