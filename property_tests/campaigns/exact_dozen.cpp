// Every operator with a maker for Rational on mechanisms of a dozen bodies: equal to the definition, and the round trip
// equal to where it started. No tolerance.
//
//   exact_dozen [--op NAME | --defect NAME]
//
// Exit code 1 when something is not equal, or an operator was left out everywhere.
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "algorithms/kit/test_scalars.h"
#include "generators/build.h"
#include "generators/draft.h"
#include "property_tests/defects/defects.h"
#include "cli/program/options.h"

namespace {

using namespace delassus;
using namespace delassus::laws;
using generators::Draft;
using generators::JointKind;
using enum generators::ConstraintKind;
using enum generators::DampingKind;

constexpr Index dozen = 12;

/// Twelve bodies with every joint kind in turn; parents by `parent`.
Draft bodies(const char* name, Index (*parent)(Draft&, Index)) {
  Draft d(name, 1);
  for (Index k = 0; k < dozen; ++k) {
    generators::BodySpec& b = d.body(parent(d, k), static_cast<JointKind>(k % 8));
    b.dof = 1 + k % 3;  // of generic joints
    if (k % 3 == 0) b.armature_decade = -1;
  }
  return d;
}

Index any_parent(Draft& d, Index k) { return k == 0 ? -1 : d.pick(); }
Index three_trees(Draft&, Index k) { return k % 4 == 0 ? -1 : k - 1; }
Index chain(Draft&, Index k) { return k - 1; }

/// Six rows, so few that conjugate gradients end.
generators::Spec few_rows() {
  Draft d = bodies("few_rows", any_parent);
  d.link(point, {11, 4});
  d.link(generic, {3, 7, 10}).rows = 2;
  d.link(distance, {9});
  d.damp(rows, -2, 1);
  return d.spec;
}

generators::Spec one_two_three_links() {
  Draft d = bodies("one_two_three_links", any_parent);
  d.link(weld, {11});
  d.link(hinge, {2, 8});
  d.link(generic, {1, 5, 9}).rows = 3;
  d.link(plane, {6, 10});
  d.damp(rows, -3, 2);
  return d.spec;
}

generators::Spec rows_on_joints() {
  Draft d = bodies("rows_on_joints", any_parent);
  for (Index k = 0; k < dozen; k += 2) d.joint_rows(k);
  for (Index k = 0; k < dozen; k += 3) d.joint_rows(k, 2);
  d.link(point, {5});
  d.damp(rows, -2, 2);
  return d.spec;
}

generators::Spec blocks() {
  Draft d = bodies("blocks", any_parent);
  for (Index k = 1; k < dozen; k += 4) d.link(contact, {k, k - 1});
  d.link(generic, {0, 6, 11}).rows = 4;
  d.joint_rows(3);
  d.joint_rows(3, 2);
  d.damp(block, -2, 1);
  return d.spec;
}

generators::Spec trees() {
  Draft d = bodies("trees", three_trees);
  d.link(point, {3, 4});
  d.link(weld, {7, 8});
  d.link(generic, {1, 6, 11}).rows = 2;
  d.link(contact, {2});
  d.damp(rows, -2, 1);
  d.spec.links.back().damping.kind = block;
  return d.spec;
}

/// Closures of a chain that overlap, nest and share bodies.
generators::Spec coupled_loops() {
  Draft d = bodies("coupled_loops", chain);
  d.link(point, {0, 6});
  d.link(point, {3, 9});
  d.link(distance, {4, 5});
  d.link(generic, {2, 7, 11}).rows = 2;
  d.link(contact, {11, 0});
  d.joint_rows(6);
  d.damp(rows, -3, 1);
  return d.spec;
}

/// R⁻¹ = 0 on every second constraint.
generators::Spec partly_hard() {
  Draft d = bodies("partly_hard", any_parent);
  d.link(point, {11});
  d.link(plane, {8, 2});
  d.link(generic, {4, 9, 10}).rows = 2;
  d.joint_rows(5);
  d.damp(rows, -1, 1);
  for (std::size_t k = 0; k < d.spec.links.size(); k += 2) d.spec.links[k].damping.kind = zero;
  return d.spec;
}

constexpr generators::Spec (*mechanisms[])() = {few_rows, one_two_three_links, rows_on_joints, blocks, trees, coupled_loops, partly_hard};

constexpr const char* held[] = {"exact columns = definition", "exact damped inverse = definition", "exact round trip"};

/// Checks one operator on one case; returns how many laws were broken and adds how many were checked.
int check_all(const OperatorRow& op, const Case& c, int& checked) {
  int broken = 0;
  const auto start = std::chrono::steady_clock::now();
  std::string line;
  for (const char* name : held) {
    const Outcome o = check(find_law(name), op, c);
    checked += o.skipped ? 0 : 1;
    broken += o.failed() ? 1 : 0;
    line += o.skipped ? std::string(" -") : o.failed() ? std::string(" BROKEN: ") + name : " =";
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  std::printf("  %-18s%s  %.2f s\n", std::string(op.name).c_str(), line.c_str(), seconds.count());
  return broken;
}

std::vector<const OperatorRow*> asked(const std::string& op, const std::string& defect) {
  if (!defect.empty()) return {&find_defect(defect).op};
  if (!op.empty()) return {&find_operator(op)};
  std::vector<const OperatorRow*> all;
  for (const OperatorRow& row : operators())
    if (std::get<Maker<Rational>>(row.makers)) all.push_back(&row);
  return all;
}

int run(const std::string& op, const std::string& defect) {
  std::printf("columns, damped inverse, round trip: = equal, - does not apply\n");
  const auto rows = asked(op, defect);
  std::vector<int> checked(rows.size(), 0);
  int wrong = 0;
  for (const auto& mechanism : mechanisms) {
    const generators::Spec spec = mechanism();
    generators::Built built = generators::build(spec);
    const Case c = make_case(std::move(built.problem), std::move(built.damping), spec.family, 1, true);
    const Structure& s = *c.problem.structure;
    std::printf("%s: %ld bodies, %ld freedoms, %ld rows\n", c.label.c_str(), static_cast<long>(s.bodies()),
                static_cast<long>(s.dofs()), static_cast<long>(s.rows));
    for (std::size_t k = 0; k < rows.size(); ++k) wrong += check_all(*rows[k], c, checked[k]);
  }
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (checked[k] == 0) std::printf("%s was checked nowhere\n", std::string(rows[k]->name).c_str()), ++wrong;
  std::printf(wrong == 0 ? "everything is equal\n" : "FAILED\n");
  return wrong == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  options::Command app{"Operators in rational numbers on mechanisms of twelve bodies: equal to the definition, and the round trip.\n"
               "Exit code 1 when something is not equal, or an operator was left out everywhere."};
  std::string op, defect;
  options::Option* one = app.add_option("--op", op, "only this operator");
  app.add_option("--defect", defect, "a wrong operator (see `delassus list defects`)")->excludes(one);
  return options::run(app, argc, argv, [&] { return run(op, defect); });
}
