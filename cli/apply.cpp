// `delassus apply SCENE --op NAME [--solve]`: one operator on one vector.
#include <cstdio>
#include <cstdlib>

#include <CLI/CLI.hpp>

#include "bench/accuracy.h"
#include "bench/text.h"
#include "cli/commands.h"
#include "cli/common.h"
#include "property_tests/options.h"

namespace delassus::cli {

namespace {

struct Options {
  std::string scene, op, input;
  bool solve = false, as_json = false;
  double damping = 0, accuracy = 0;
  SceneOptions opening;
};

void require_capability(const OperatorRow& row, bool solve) {
  if (solve ? row.solves : row.applies) return;
  std::string able;
  for (const OperatorRow& o : operators())
    if (solve ? o.solves : o.applies) able += (able.empty() ? "" : ", ") + std::string(o.name);
  throw ModelError("", "--op " + std::string(row.name), solve ? "it has no solve" : "it has no apply (use --solve)", able);
}

struct Answer {
  VectorX<double> output;
  Report report;
  std::vector<Index> dependent = {};  ///< hard rows left out
  double cost = -1;  ///< operations of update and solve, over those of lcaba; −1: not counted
};

Answer compute(const OperatorRow& row, const Scene& scene, const VectorX<double>& input, bool solve, Accuracy wanted) {
  const Problem<double> problem = problem_of(scene);
  const auto op = row.make<double>();
  op->analyze(problem.structure);
  const Report update = op->update(problem, scene.damping);
  Workspace<double> workspace(op->workspace());
  const MatrixX<double> in = input;
  MatrixX<double> out = MatrixX<double>::Zero(in.rows(), 1);
  Report report = solve ? op->solve(in, out, wanted, workspace) : op->apply(in, out, workspace);
  if (report.ok() && !update.ok() && solve) report = update;
  Answer answer{out.col(0), report, op->dependent_rows()};
  if (!solve || !report.ok()) return answer;
  const std::int64_t spent = accuracy::operations(row, problem, scene.damping, input, wanted, report);
  const std::int64_t least = accuracy::operations(find_operator("lcaba"), problem, scene.damping, input, Accuracy::full(), {});
  if (spent > 0 && least > 0) answer.cost = static_cast<double>(spent) / static_cast<double>(least);
  return answer;
}

void print_text(const Options& o, const VectorX<double>& input, const Answer& answer) {
  std::printf("%s  %s  %s\n%6s  %24s  %24s\n", o.scene.c_str(), o.op.c_str(), o.solve ? "f = A⁻¹ a" : "a = A f", "row",
              "input", "output");
  for (Index i = 0; i < input.size(); ++i)
    std::printf("%6lld  %24.17g  %24.17g\n", static_cast<long long>(i), input[i], answer.output[i]);
  const Report& r = answer.report;
  std::printf("status %s", std::string(name(r.status)).c_str());
  if (!r.rung.empty()) std::printf(", by %s (rungs tried: %d)", std::string(r.rung).c_str(), r.rungs_tried);
  if (r.iterations > 0) std::printf(", steps: %d", r.iterations);
  if (r.error_bound >= 0) std::printf(", error at most %.1e (relative, energy norm)", r.error_bound);
  if (r.error_estimate >= 0) std::printf(", last correction %.1e", r.error_estimate);
  std::printf("\n");
  if (!answer.dependent.empty()) {
    std::printf("hard rows that depend on the others:");
    for (const Index row : answer.dependent) std::printf(" %lld", static_cast<long long>(row));
    std::printf("\n");
  }
  if (answer.cost > 0) std::printf("update and solve: %.2f times the operations of lcaba\n", answer.cost);
}

int apply(const Options& o, bool has_damping) {
  const OperatorRow& row = find_operator(o.op);
  const Scene scene = open(o.scene, o.opening, has_damping ? std::optional<double>(o.damping) : std::nullopt);
  require_capability(row, o.solve);
  const auto structure = structure_of(scene.model);
  const std::string meaning = o.solve ? "accelerations a of the constraint rows" : "forces f of the constraint rows";
  const VectorX<double> input =
      o.input.empty() ? VectorX<double>::Ones(structure->rows) : read_vector(o.input, structure->rows, meaning);
  const Answer answer = compute(row, scene, input, o.solve, Accuracy{o.accuracy});
  if (o.as_json) {
    json j = {{"scene", scene.name}, {"op", row.name}, {"function", o.solve ? "solve" : "apply"},
              {"dof", structure->dofs()}, {"rows", structure->rows}, {"damping", damping_json(scene.damping)},
              {"input", std::vector<double>(input.begin(), input.end())},
              {"output", std::vector<double>(answer.output.begin(), answer.output.end())},
              {"report", report_json(answer.report)}, {"dependent_rows", answer.dependent},
              {"warnings", warnings_json(scene)}};
    if (o.solve) j["operations_over_lcaba"] = answer.cost > 0 ? json(answer.cost) : json(nullptr);
    if (!scene.damping.blocks.empty()) j["damping_blocks"] = damping_blocks_json(scene.damping);
    std::printf("%s\n", j.dump().c_str());
  } else {
    print_text(o, input, answer);
  }
  return answer.report.ok() ? good : law_broken;
}

}  // namespace

void add_apply(CLI::App& app, Run& run) {
  CLI::App* c = app.add_subcommand("apply", "apply or invert one operator: a = A f, or with --solve f = A⁻¹ a");
  auto o = std::make_shared<Options>();
  c->add_option("scene", o->scene, "name, .yaml file, robot's file (URDF) or swimmer:N")->required();
  c->add_option("--op", o->op, "operator (see `delassus list operators`)")->required();
  c->add_flag("--solve", o->solve, "f = A⁻¹ a instead of a = A f");
  c->add_option("--accuracy", o->accuracy,
                "with --solve: bound wanted on the relative error in the energy norm; 0: all digits; inf: no certificate")
      ->check([](const std::string& text) {
        char* end = nullptr;
        const double x = std::strtod(text.c_str(), &end);
        return !text.empty() && *end == 0 && x >= 0 ? std::string() : "'" + text + "' is not a number ≥ 0 (accepted: 0 … inf)";
      });
  c->add_option("--input", o->input, "JSON file with an array of one number per row; when left out, ones");
  CLI::Option* damping = c->add_option("--damping", o->damping, "R⁻¹ of every row [1/kg] instead of the scene's")->check(options::at_least(0, "1/kg"));
  c->add_flag("--json", o->as_json, "print {scene, op, function, dof, rows, damping, input, output, report, dependent_rows, warnings, with --solve operations_over_lcaba}");
  add_scene_options(*c, o->opening);
  c->footer("Exit code 1 when the report's status is not ok; the output is NaN then (null in JSON), or the best iterate.");
  c->callback([=, &run] { run = [=] { return apply(*o, damping->count() > 0); }; });
}

}  // namespace delassus::cli
