// The README's program: a double pendulum whose tip is held by a damped point constraint.
#include <cstdio>

// [readme]
#include "algorithms/delassus.h"
#include "algorithms/mechanism/kinematics.h"

int main() {
  using namespace delassus;
  Model model;
  for (Index i = 0; i < 2; ++i) {
    Body link{.name = i == 0 ? "upper" : "lower", .parent = i - 1, .mass = 1.0, .com = {0, 0, -0.5}};
    link.inertia.diagonal() << 0.1, 0.1, 0.01;
    link.joint.axis = {0, 1, 0};
    if (i == 1) link.joint.placement.translation = {0, 0, -1};
    model.add(link);
  }
  model.constraints.push_back({.name = "tip", .kind = Constraint::Kind::point, .a = {1, {.translation = {0, 0, -1}}}});

  const Problem<double> problem = kinematics<double>(model, VectorX<double>{{0.3, 0.4}});
  const auto lambda_R = find_operator("ladder").make<double>();
  lambda_R->analyze(problem.structure);                                               // once
  Report report = lambda_R->update(problem, Damping<double>::uniform(3, 1e-3));       // at q
  Workspace<double> workspace(lambda_R->workspace());
  VectorX<double> a{{0.0, 0.0, 9.81}}, f(3);
  report = lambda_R->solve(a, f, Accuracy{1e-8}, workspace);                         // f = (R⁻¹ + J M⁻¹ Jᵀ)⁻¹ a, as accurate as asked
  std::printf("%s: f = %.6f %.6f %.6f N\n", name(report.status).data(), f[0], f[1], f[2]);
  return report.ok() ? 0 : 1;
}
// [readme]
