#include "algorithms/kit/test_scalars.h"
#include "bench/accuracy/accuracy_steps.h"

#include <algorithm>
#include <cmath>

#include "bench/page/plot.h"
#include "bench/text.h"

namespace delassus::accuracy {

namespace {

Path walk(const Rung& rung, const Problem<double>& problem, const Damping<double>& damping, const MatrixX<double>& a, const Truth& truth) {
  const auto op = rung.row->make<double>();
  op->analyze(problem.structure);
  const Report updated = op->update(problem, damping);
  Path path{rung.name, std::string(name(updated.status)), rung.style, {}};
  if (!updated.ok()) return path;
  Workspace<double> work(op->workspace());
  MatrixX<double> f(a.rows(), 1);
  const Report last = op->solve(a, f, Accuracy::full(), work);
  path.status = std::string(name(last.status));
  for (int steps = 0; steps <= last.iterations; steps += 1 + (steps < 16 ? 0 : steps / 8)) {
    const Report r = op->solve(a, f, {0, steps}, work);
    if (r.ok() || r.status == Status::not_converged)
      path.steps.push_back({steps, std::string(name(r.status)), truth.errors_of({f.col(0).cast<Quad>(), {}}), r.error_bound, r.error_estimate});
  }
  return path;
}

}  // namespace

Convergence converge(const Subject& subject, const std::vector<Rung>& rungs, double damping, const Options& options) {
  const VectorX<double> a = options.random_right_side ? random_acceleration(subject.rows(), options.seed)
                                                      : consistent_acceleration(subject.problem, options.seed);
  const Damping<double> d = damping == own_damping ? subject.damping : Damping<double>::uniform(subject.rows(), damping);
  const Truth truth(subject.problem, d, a);
  Convergence c{subject.name, subject.dofs(), subject.rows(), damping, truth.largest_eigenvalue(), truth.condition(), truth.why_not(), {}};
  for (const Rung& rung : rungs) {
    if (rung.arithmetic != Arithmetic::in_double || rung.row->name == default_rung) continue;
    c.paths.push_back(walk(rung, subject.problem, d, MatrixX<double>(a), truth));
  }
  return c;
}

std::string picture(const Convergence& c) {
  std::vector<bench::Series> series;
  for (const Path& path : c.paths) {
    bench::Series one{path.rung, {}, path.style};
    for (const Step& s : path.steps)
      if (!std::isnan(s.errors.motion)) one.points.emplace_back(s.steps + 1, std::clamp(s.errors.motion, 1e-17, 10.0));
    series.push_back(std::move(one));
  }
  return bench::labelled_plot("a-steps", "Motion error against evaluations, " + c.name, "evaluations (steps + 1)", "relative error of the motion", series);
}

}  // namespace delassus::accuracy
