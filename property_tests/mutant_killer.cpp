// What kills mutants (mutate.py): every law on small pinned problems, smallest first, until one fails. It also holds what
// no law looks at: the fill of a plan, the degree of freedom a lost pivot names.
//
// Exit code 0: everything holds; 1: something does not, and it is printed.
#include <cstdlib>
#include <iostream>

#include "algorithms/elimination.h"
#include "generators/build.h"
#include "property_tests/allocations.h"
#include "property_tests/laws.h"
#include "property_tests/summary.h"

namespace {

using namespace delassus;

struct Pinned {
  const char* family;
  Index n;
  std::uint64_t seed;
};
constexpr Pinned problems[] = {
    {"chain", 2, 1},       {"generic", 2, 1},      {"generic", 5, 1},       {"generic", 5, 2},     {"random_tree", 5, 1},
    {"lattice", 4, 1},     {"massless", 5, 1},     {"block_damping", 3, 1}, {"four_bar", 4, 1},    {"several_trees", 4, 1},
    {"joint_friction", 4, 1}, {"hard", 3, 1},      {"partly_hard", 3, 1},   {"hard_redundant", 2, 1}, {"no_rows", 4, 1},
    {"no_bodies", 0, 1},   {"generic", 8, 1},      {"contacts", 3, 1},      {"star", 4, 2},        {"redundant", 5, 1},
    {"comb", 6, 1},        {"mass_ratio", 4, 1},   {"near_singular", 3, 1}, {"mixed_damping", 10, 1}, {"humanoid", 10, 1},
    {"random_tree", 12, 3}, {"generic", 13, 1}};

/// Prints and returns whether a number is larger than what was measured when this was written.
bool exceeds(const char* what, Index got, Index most) {
  if (got > most) std::cout << what << ": " << got << " instead of " << most << '\n';
  return got > most;
}

/// What the elimination order costs: blocks of the plan, pairs of its steps, runs, active steps.
bool dearer_order() {
  constexpr struct {
    const char* family;
    Index n, blocks, pairs, runs, active;
  } expected[] = {{"lattice", 16, 42, 44, 1, 16}, {"comb", 20, 10, 0, 20, 20}, {"random_tree", 24, 0, 0, 7, 10}, {"ring", 12, 17, 20, 2, 12},
                  {"humanoid", 26, 12, 11, 3, 26},   {"generic", 13, 33, 43, 9, 13}};
  for (const auto& e : expected) {
    const auto s = generators::build(generators::find_family(e.family).make(e.n, 1)).problem.structure;
    const Plan plan = make_plan(*s, Matrix::M_R);
    const bool dearer[] = {exceeds("blocks", plan.blocks, e.blocks), exceeds("pairs", static_cast<Index>(plan.pairs.size()), e.pairs),
                           exceeds("runs", static_cast<Index>(plan.runs.size()), e.runs), exceeds("active steps", plan.active(), e.active)};
    if (dearer[0] || dearer[1] || dearer[2] || dearer[3]) {
      std::cout << e.family << '\n';
      return true;
    }
  }
  return false;
}

/// A massless tip makes M singular: the first degree of freedom of its joint is named.
bool lost_pivot_elsewhere() {
  const laws::Case c = laws::make_case("chain", 3, 1);
  Problem<double> p = c.problem;
  p.H.back().setZero();
  std::fill(p.armature.begin(), p.armature.end(), 0.0);
  for (const char* op_name : {"aba_sweep", "lcaba_refined"}) {
    const auto op = find_operator(op_name).make<double>();
    op->analyze(p.structure);
    const Report r = op->update(p, c.damping);
    if (r.status == Status::lost_pivot && r.where == p.structure->dofs() - 1) continue;
    std::cout << op_name << ": " << name(r.status) << " at " << r.where << '\n';
    return true;
  }
  return false;
}

bool law_broken() {
  for (const Pinned& pinned : problems) {
    const laws::Case c = laws::make_case(pinned.family, pinned.n, pinned.seed);
    for (const OperatorRow& op : operators()) {
      if (op.name == "dense_cholesky") continue;
      for (const laws::LawRow& law : laws::laws()) {
        const laws::Outcome o = laws::check(law, op, c);
        if (!o.failed()) continue;
        laws::print(std::cout, o);
        return true;
      }
    }
  }
  return false;
}

}  // namespace

int main() {
  laws::count_allocations();
  return dearer_order() || lost_pivot_elsewhere() || law_broken() ? EXIT_FAILURE : EXIT_SUCCESS;
}
