// What kills mutants (mutate.py): every law on small pinned problems, smallest first, until one fails. It also holds what
// no law looks at: the fill of a plan, and that a lost pivot is named in every phase until there are better numbers.
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
    {"no_bodies", 0, 1},   {"generic", 8, 1},      {"contacts", 1, 1},      {"star", 4, 2},        {"redundant", 2, 1},
    {"comb", 6, 1},        {"mass_ratio", 4, 1},   {"near_singular", 3, 1}, {"mixed_damping", 10, 1}};

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

bool unexpected(std::string_view op, const char* when, const Report& r, Status expected, Index where) {
  if (r.status == expected && (expected == Status::ok || r.where == where)) return false;
  std::cout << op << ", " << when << ": " << name(r.status) << " at " << r.where << '\n';
  return true;
}

/// What apply or solve says for one vector.
Report answered(const OperatorRow& row, const Operator<double>& op) {
  const MatrixX<double> x = MatrixX<double>::Ones(op.size(), 1);
  MatrixX<double> y = x;
  Workspace<double> w(op.workspace(1));
  return row.solves ? op.solve(x, y, w) : op.apply(x, y, w);
}

/// A massless tip makes M singular: every phase names the degree of freedom of its joint, until there are better numbers.
/// `held`: whether the tip carries the constraint, so that its step is active. A zero damping is forgotten the same way.
bool lost_pivot_forgotten(bool held) {
  generators::Spec spec = generators::find_family("chain").make(3, 1);
  spec.links.resize(1);
  spec.links[0].bodies = {held ? 2 : 0};
  const auto [good, damping] = generators::build(spec);
  const Index tip = good.structure->dofs() - 1;
  Problem<double> bad = good;
  bad.H.back().setZero();
  std::fill(bad.armature.begin(), bad.armature.end(), 0.0);
  const auto hard = Damping<double>::uniform(good.structure->rows, 0);
  for (const char* op_name : {"aba_sweep", "lcaba", "lcaba_refined"}) {
    if (held && std::string_view(op_name) == "lcaba") continue;  // M + JᵀRJ is regular
    const OperatorRow& row = find_operator(op_name);
    const auto op = row.make<double>();
    op->analyze(good.structure);
    if (unexpected(op_name, "singular M", op->update(bad, damping), Status::lost_pivot, tip) ||
        unexpected(op_name, "its answer", answered(row, *op), Status::lost_pivot, tip) ||
        unexpected(op_name, "its new damping", op->update_damping(damping), Status::lost_pivot, tip) ||
        unexpected(op_name, "its answer then", answered(row, *op), Status::lost_pivot, tip) ||
        unexpected(op_name, "regular M", op->update(good, damping), Status::ok, 0) ||
        unexpected(op_name, "hard rows", op->update_damping(hard), row.solves ? Status::zero_damping : Status::ok, 0) ||
        unexpected(op_name, "damped again", op->update_damping(damping), Status::ok, 0) ||
        unexpected(op_name, "its last answer", answered(row, *op), Status::ok, 0))
      return true;
  }
  return false;
}

bool law_broken() {
  for (const Pinned& pinned : problems) {
    const laws::Case c = laws::make_case(pinned.family, pinned.n, pinned.seed);
    for (const char* op_name : {"aba_sweep", "lcaba", "lcaba_refined", "cg", "dense_cholesky"}) {
      for (const laws::LawRow& law : laws::laws()) {
        const laws::Outcome o = laws::check(law, find_operator(op_name), c);
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
  return dearer_order() || lost_pivot_forgotten(true) || lost_pivot_forgotten(false) || law_broken() ? EXIT_FAILURE : EXIT_SUCCESS;
}
