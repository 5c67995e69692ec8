// `delassus apply SCENE --op NAME [--solve]`: one operator on one vector.
#include <cstdio>

#include "bench/accuracy/accuracy.h"
#include "bench/text.h"
#include "cli/commands.h"
#include "cli/common.h"
#include "cli/gravity.h"
#include "cli/names.h"
#include "cli/program/options.h"

namespace delassus::cli {

namespace {

struct ApplyOptions {
  std::string scene, op, input, rhs;
  bool solve = false, as_json = false;
  double damping = 0, accuracy = 0;
  SceneOptions opening;
};

void require_capability(const OperatorRow& row, bool solve) {
  if (solve ? row.solves : row.applies) return;
  std::string able;
  for (const OperatorRow& o : operators())
    if (solve ? o.solves : o.applies) able += (able.empty() ? "" : ", ") + std::string(o.name);
  throw ModelError("", "--op " + std::string(row.name), solve ? "it has no solve" : "it has no apply", able + (solve ? "; leave --solve out" : "; --solve asks for the other function"));
}

struct Answer {
  VectorX<double> output;
  Report report;
  std::vector<Index> dependent = {};  ///< hard rows left out
  double cost = -1;  ///< operations of update and solve, over those of lcaba; −1: not counted
  bool singular = false;  ///< M has no factor at this pose
};

/// What ones give: an acceleration that forces cause, so that dependent hard rows agree. Ones where M is singular.
VectorX<double> reachable(const Problem<double>& problem, const Damping<double>& damping) {
  const auto op = find_operator("aba_sweep").make<double>();
  op->analyze(problem.structure);
  const MatrixX<double> f = MatrixX<double>::Ones(op->size(), 1);
  MatrixX<double> a = f;
  if (!op->update(problem, damping).ok()) return a.col(0);
  Workspace<double> workspace(op->workspace());
  return (op->apply(f, a, workspace).ok() ? a : f).col(0);
}

bool mass_is_singular(const Problem<double>& problem, const Damping<double>& damping) {
  const auto op = find_operator("aba_sweep").make<double>();
  op->analyze(problem.structure);
  return op->update(problem, damping).status == Status::lost_pivot;
}

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
  if (report.status == Status::lost_pivot) answer.singular = mass_is_singular(problem, scene.damping);
  if (!solve || !report.ok()) return answer;
  const std::int64_t spent = accuracy::operations(row, problem, scene.damping, input, wanted, report);
  const std::int64_t least = accuracy::operations(find_operator("lcaba"), problem, scene.damping, input, Accuracy::full(), {});
  if (spent > 0 && least > 0) answer.cost = static_cast<double>(spent) / static_cast<double>(least);
  return answer;
}

/// What goes in, and what it is in words.
struct Input {
  VectorX<double> values;
  std::string what;
};

Input input_of(const ApplyOptions& o, const Scene& scene, Index rows) {
  const std::string meaning = o.solve ? "accelerations a of the constraint rows" : "forces f of the constraint rows";
  if (!o.input.empty()) return {read_vector(o.input, rows, meaning), meaning + ", read from " + o.input};
  if (o.rhs == "consistent") return {reachable(problem_of(scene), scene.damping), "A times ones: " + meaning + " that forces of 1 cause"};
  if (o.rhs == "gravity" || (o.rhs.empty() && o.solve)) {
    if (const auto a = rest_under_gravity(scene))
      return {*a, "−J M⁻¹g: what the rows need to stay at rest under gravity, motors off; the output holds them"};
    if (o.rhs == "gravity")
      throw ModelError(scene.file, "--rhs gravity", "the scene has no gravity, or M no inverse at this pose", "gravity: [x, y, z] in a scene whose M is regular; or another --rhs");
  }
  return {VectorX<double>::Ones(rows), "ones: a sample"};
}

void print_text(const ApplyOptions& o, const Model& model, const Input& input, const Answer& answer) {
  std::printf("%s  %s  %s\ninput: %s\n", o.scene.c_str(), o.op.c_str(), o.solve ? "f = A⁻¹ a" : "a = A f", input.what.c_str());
  std::printf("%6s  %24s %-6s  %24s %-6s  %s\n", "row", "input", "", "output", "", "what it is");
  for (Index i = 0; i < input.values.size(); ++i) {
    const Units u = row_units(model, i);
    const std::string of_input = bench::pad_right(o.solve ? u.acceleration : u.force, 6), of_output = bench::pad_right(o.solve ? u.force : u.acceleration, 6);
    std::printf("%6lld  %24.17g %s  %24.17g %s  %s\n", static_cast<long long>(i), input.values[i], of_input.c_str(), answer.output[i],
                of_output.c_str(), row_name(model, i).c_str());
  }
  const Report& r = answer.report;
  std::printf("status %s", std::string(name(r.status)).c_str());
  if (const std::string at = place(model, r, answer.singular); !at.empty()) std::printf(" %s", at.c_str());
  if (!r.rung.empty()) std::printf(", by %s (rungs tried: %d)", std::string(r.rung).c_str(), r.rungs_tried);
  if (r.iterations > 0) std::printf(", steps: %d", r.iterations);
  if (r.error_bound >= 0) std::printf(", error at most %.1e (relative, energy norm)", r.error_bound);
  else if (r.error_estimate >= 0) std::printf(", no bound");
  if (r.error_estimate >= 0) std::printf(", last correction %.1e", r.error_estimate);
  std::printf("\n");
  if (!answer.dependent.empty()) {
    std::printf("%zu of %lld rows are hard and depend on the others:\n", answer.dependent.size(), static_cast<long long>(input.values.size()));
    for (const Index row : answer.dependent) std::printf("%6lld  %s\n", static_cast<long long>(row), row_name(model, row).c_str());
  }
  if (answer.cost > 0) std::printf("update and solve: %.2f times the operations of lcaba\n", answer.cost);
}

int apply(const ApplyOptions& o, bool has_damping) {
  const OperatorRow& row = find_operator(o.op);
  const Scene scene = open(o.scene, o.opening, has_damping ? std::optional<double>(o.damping) : std::nullopt);
  require_capability(row, o.solve);
  const auto structure = structure_of(scene.model);
  const Input input = input_of(o, scene, structure->rows);
  const Answer answer = compute(row, scene, input.values, o.solve, Accuracy{o.accuracy});
  if (o.as_json) {
    json j = {{"scene", scene.name}, {"op", row.name}, {"function", o.solve ? "solve" : "apply"},
              {"dof", structure->dofs()}, {"rows", structure->rows}, {"damping", damping_json(scene.damping)},
              {"input", std::vector<double>(input.values.begin(), input.values.end())}, {"input_is", input.what},
              {"output", std::vector<double>(answer.output.begin(), answer.output.end())},
              {"report", report_json(answer.report)}, {"dependent_rows", answer.dependent},
              {"dependent_row_names", json::array()}, {"row_names", json::array()}, {"row_units", json::array()}, {"warnings", warnings_json(scene)}};
    for (const Index dependent : answer.dependent) j["dependent_row_names"].push_back(row_name(scene.model, dependent));
    for (Index i = 0; i < structure->rows; ++i) {
      const Units u = row_units(scene.model, i);
      j["row_names"].push_back(row_name(scene.model, i));
      j["row_units"].push_back({u.acceleration, u.force});
    }
    const std::string at = place(scene.model, answer.report, answer.singular);
    j["place"] = at.empty() ? json(nullptr) : json(at);
    if (answer.report.where >= 0) j["report"]["where_is"] = answer.report.at_row() ? "row" : "degree of freedom";
    if (o.solve) j["operations_over_lcaba"] = answer.cost > 0 ? json(answer.cost) : json(nullptr);
    if (!scene.damping.blocks.empty()) j["damping_blocks"] = damping_blocks_json(scene.damping);
    std::printf("%s\n", j.dump().c_str());
  } else {
    print_text(o, scene.model, input, answer);
  }
  return answer.report.ok() ? good : law_broken;
}

}  // namespace

void add_apply(options::Command& app, Run& run) {
  options::Command* c = app.add_subcommand("apply", "apply or invert one operator: a = A f, or with --solve f = A⁻¹ a");
  auto o = std::make_shared<ApplyOptions>();
  c->add_option("scene", o->scene, "name, .yaml file, robot's file (URDF) or swimmer:N")->required();
  c->add_option("--op", o->op, "operator (see `delassus list operators`)")->required();
  c->add_flag("--solve", o->solve, "f = A⁻¹ a instead of a = A f");
  c->add_option("--accuracy", o->accuracy,
                "with --solve: bound wanted on the relative error in the energy norm; 0: all digits; inf: no certificate")
      ->check(options::at_least_or_inf(0, ""));
  options::Option* input = c->add_option("--input", o->input, "JSON file with an array of one number per row; when left out, see --rhs");
  c->add_option("--rhs", o->rhs, "without --input: gravity: −J M⁻¹g, what the rows need to stay at rest under the scene's gravity; ones; consistent: A times ones, "
                "which dependent hard rows do not contradict; when left out, gravity with --solve where the scene has it, otherwise ones")
      ->check(options::one_of({"gravity", "ones", "consistent"}))->excludes(input);
  options::Option* damping = c->add_option("--damping", o->damping, "R⁻¹ of every row [1/kg] instead of the scene's")->check(options::at_least(0, "1/kg"));
  c->add_flag("--json", o->as_json, "print {scene, op, function, dof, rows, damping, input, input_is, output, row_names, row_units, report, dependent_rows, dependent_row_names, place, warnings, with --solve operations_over_lcaba}");
  add_scene_options(*c, o->opening);
  c->footer("Exit code 1 when the report's status is not ok; the output is NaN then (null in JSON), or the best iterate.");
  c->callback([=, &run] { run = [=] { return apply(*o, damping->count() > 0); }; });
}

}  // namespace delassus::cli
