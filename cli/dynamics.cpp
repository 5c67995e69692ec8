// `delassus dynamics SCENE`: bias forces, J̇ν, free and constrained accelerations, constraint forces.
#include "algorithms/dynamics/dynamics.h"

#include <cstdio>

#include "bench/text.h"
#include "cli/commands.h"
#include "cli/common.h"
#include "cli/names.h"
#include "cli/program/options.h"

namespace delassus::cli {

namespace {

struct DynamicsOptions {
  std::string scene, velocity, torque, acceleration, op = "ladder";
  bool as_json = false;
  double damping = 0, accuracy = 0;
  SceneOptions opening;
};

struct DynamicsAnswer {
  VectorX<double> nu, tau, wanted;                       ///< given, or zero
  VectorX<double> c, free, acceleration, rows, lambda;
  Report update, free_report, report;
};

VectorX<double> given(const std::string& file, Index size, const std::string& meaning) {
  return file.empty() ? VectorX<double>::Zero(size) : read_vector(file, size, meaning);
}

DynamicsAnswer compute(const DynamicsOptions& o, const Scene& scene) {
  const Index n = scene.model.dofs(), m = static_cast<Index>(scene.damping.diagonal.size());
  DynamicsAnswer a;
  a.nu = given(o.velocity, n, "velocities of the degrees of freedom");
  a.tau = given(o.torque, n, "torques of the degrees of freedom");
  a.wanted = given(o.acceleration, m, "accelerations of the constraint rows");
  Dynamics<double> dynamics(scene.model, scene.gravity, o.op);
  a.update = dynamics.update(scene.q, a.nu, scene.damping);
  a.c = dynamics.bias_forces();
  a.rows = dynamics.bias_rows();
  a.free_report = dynamics.aba(a.tau, a.free);
  a.report = dynamics.constrained_aba(a.tau, a.wanted, a.acceleration, a.lambda, Accuracy{o.accuracy});
  return a;
}

std::string outcome(const Model& model, const DynamicsAnswer& a) {
  const std::string at = place(model, a.report, !a.free_report.ok());
  std::string text = "status " + std::string(name(a.report.status)) + (at.empty() ? "" : " " + at);
  if (!a.report.rung.empty()) text += ", by " + std::string(a.report.rung);
  if (a.report.error_bound >= 0) text += bench::format(", forces: error at most %.1e (relative, energy norm)", a.report.error_bound);
  return text;
}

void print_text(const DynamicsOptions& o, const Scene& scene, const DynamicsAnswer& a) {
  const auto& g = scene.gravity;
  std::printf("%s  M ν̇ + c = τ + Jᵀλ,  J ν̇ + J̇ν + R⁻¹λ = a, every row held on both sides; %s\n", o.scene.c_str(),
              scene.has_gravity ? bench::format("gravity (%g, %g, %g) m/s²", g[0], g[1], g[2]).c_str() : "no gravity");
  std::printf("%6s  %14s  %14s  %14s  %14s  %14s  %s\n", "dof", "nu", "tau", "c", "free accel.", "acceleration", "joint");
  for (Index k = 0; k < a.c.size(); ++k)
    std::printf("%6lld  %14.8g  %14.8g  %14.8g  %14.8g  %14.8g  %s\n", static_cast<long long>(k), a.nu[k], a.tau[k], a.c[k], a.free[k],
                a.acceleration[k], joint_name(scene.model, k).c_str());
  if (a.lambda.size() > 0) std::printf("%6s  %14s  %14s  %14s  %s\n", "row", "wanted accel.", "J-dot nu", "lambda", "constraint");
  for (Index r = 0; r < a.lambda.size(); ++r) {
    const Units u = row_units(scene.model, r);
    std::printf("%6lld  %14.8g  %14.8g  %14.8g  %s%s\n", static_cast<long long>(r), a.wanted[r], a.rows[r], a.lambda[r],
                row_name(scene.model, r).c_str(), *u.force == 0 ? "" : bench::format(" [%s; %s]", u.acceleration, u.force).c_str());
  }
  std::printf("%s\n", outcome(scene.model, a).c_str());
}

json vector_json(const VectorX<double>& x) { return std::vector<double>(x.begin(), x.end()); }

int dynamics(const DynamicsOptions& o, bool has_damping) {
  const Scene scene = open(o.scene, o.opening, has_damping ? std::optional<double>(o.damping) : std::nullopt);
  const DynamicsAnswer a = compute(o, scene);
  if (o.as_json) {
    const json j = {{"scene", scene.name}, {"op", o.op}, {"dof", a.c.size()}, {"rows", a.lambda.size()}, {"gravity", {scene.gravity[0], scene.gravity[1], scene.gravity[2]}},
                    {"damping", damping_json(scene.damping)}, {"velocity", vector_json(a.nu)}, {"torque", vector_json(a.tau)},
                    {"row_acceleration", vector_json(a.wanted)}, {"bias_forces", vector_json(a.c)}, {"bias_rows", vector_json(a.rows)},
                    {"free_acceleration", vector_json(a.free)}, {"acceleration", vector_json(a.acceleration)},
                    {"lambda", vector_json(a.lambda)}, {"report", report_json(a.report)}, {"warnings", warnings_json(scene)}};
    std::printf("%s\n", j.dump().c_str());
  } else {
    print_text(o, scene, a);
  }
  return a.report.ok() ? good : law_broken;
}

}  // namespace

void add_dynamics(options::Command& app, Run& run) {
  options::Command* c = app.add_subcommand("dynamics", "bias forces, accelerations and constraint forces at given velocities and torques");
  auto o = std::make_shared<DynamicsOptions>();
  c->add_option("scene", o->scene, "name, .yaml file, robot's file (URDF) or swimmer:N")->required();
  c->add_option("--velocity", o->velocity, "JSON file with ν, one number per degree of freedom [rad/s or m/s]; at rest when left out");
  c->add_option("--torque", o->torque, "JSON file with τ, one number per degree of freedom [N m or N]; zero when left out");
  c->add_option("--acceleration", o->acceleration, "JSON file with the acceleration wanted of each row [rad/s² or m/s²]; zero, constraints just hold, when left out");
  c->add_option("--op", o->op, "operator that finds λ (see `delassus list operators`)")->capture_default_str();
  c->add_option("--accuracy", o->accuracy, "bound wanted on the relative error of λ in the energy norm; 0: all digits; inf: no certificate")
      ->check(options::at_least_or_inf(0, ""));
  options::Option* damping = c->add_option("--damping", o->damping, "R⁻¹ of every row [1/kg] instead of the scene's")->check(options::at_least(0, "1/kg"));
  c->add_flag("--json", o->as_json, "print {scene, op, dof, rows, gravity, damping, velocity, torque, row_acceleration, bias_forces, bias_rows, free_acceleration, acceleration, lambda, report, warnings}");
  add_scene_options(*c, o->opening);
  c->footer("Gravity is the scene's. Contacts, limits and joint friction are held like any other row: they may pull. Exit code 1 when the report's status is not ok.");
  c->callback([=, &run] { run = [=] { return dynamics(*o, damping->count() > 0); }; });
}

}  // namespace delassus::cli
