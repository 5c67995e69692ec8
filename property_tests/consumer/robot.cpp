// A robot and a scene through the installed package: what the feet carry when everything falls and no motor turns.
//   robot ROBOT.urdf SCENE
#include <cstdio>

// [readme]
#include "algorithms/delassus.h"
#include "models/scene.h"

int main(int argc, char** argv) {
  using namespace delassus;
  if (argc != 3) return 2;
  const Scene robot = load_robot(argv[1]), scene = open_scene(argv[2]);   // ModelError says what is wrong with a file, and where
  const Problem<double> problem = problem_of(scene);                     // the numbers at scene.q
  const auto lambda_R = find_operator("ladder").make<double>();
  lambda_R->analyze(problem.structure);
  Report report = lambda_R->update(problem, scene.damping);
  Workspace<double> workspace(lambda_R->workspace());
  VectorX<double> a(problem.structure->rows), f(problem.structure->rows);
  for (Index row = 0; row < a.size(); ++row)
    a[row] = -problem.K[static_cast<std::size_t>(row)].tail<3>().dot(scene.gravity);  // rows with the ground: fall, undone
  report = lambda_R->solve(a, f, Accuracy{1e-8}, workspace);
  // [readme]
  std::printf("%s: %d dofs\n%s, %s: first contact %.6f N along its normal, %.6f and %.6f N along the ground\n", robot.name.c_str(), static_cast<int>(robot.model.dofs()),
              scene.file.c_str(), name(report.status).data(), f[0], f[1], f[2]);
  // Numbers that this program allocated, and the library reads: aligned as the library wants them, whichever it is.
  VectorX<double> g(a.size());
  for (const Problem<double>& copy : std::vector<Problem<double>>(8, problem))
    if (!lambda_R->update(copy, scene.damping).ok() || !lambda_R->solve(a, g, Accuracy{1e-8}, workspace).ok() || g != f) return 1;
  return report.ok() && f[0] > 0 ? 0 : 1;  // the ground pushes
}
