#include "cli/accuracy_steps.h"

#include <cmath>
#include <cstdio>

#include "bench/text.h"
#include "cli/common.h"

namespace delassus::cli {

using namespace accuracy;

namespace {

std::string known_text(double x) { return std::isnan(x) || x < 0 ? "–" : bench::format("%.1e", x); }

}  // namespace

void print_steps(const Convergence& c) {
  std::printf("%s: %d dofs, %d rows, ", c.name.c_str(), static_cast<int>(c.dofs), static_cast<int>(c.rows));
  if (c.damping == own_damping) std::printf("own damping");
  else if (c.damping == 0) std::printf("R⁻¹ = 0: hard rows");
  else std::printf("R⁻¹ = %g 1/kg, R λmax = %.0e", c.damping, c.largest_eigenvalue / c.damping);
  std::printf(", κ %s\n", known_text(c.condition).c_str());
  if (!c.no_reference.empty()) std::printf("no errors: %s\n", c.no_reference.c_str());
  for (const Path& path : c.paths) {
    std::printf("\n%s: %s\n", path.rung.c_str(), path.status.c_str());
    if (!path.steps.empty()) std::printf("  steps     motion          λ      bound   estimate\n");
    for (const Step& s : path.steps)
      std::printf("%7d%s%s%s%s\n", s.steps, bench::pad_left(known_text(s.errors.motion), 11).c_str(), bench::pad_left(known_text(s.errors.lambda), 11).c_str(),
                  bench::pad_left(known_text(s.error_bound), 11).c_str(), bench::pad_left(known_text(s.error_estimate), 11).c_str());
  }
  std::printf("\n");
}

json steps_json(const Convergence& c) {
  json paths = json::array();
  for (const Path& path : c.paths) {
    json steps = json::array();
    for (const Step& s : path.steps)
      steps.push_back({{"steps", s.steps}, {"status", s.status}, {"motion_error", finite_json(s.errors.motion)}, {"lambda_error", finite_json(s.errors.lambda)},
                       {"error_bound", known_json(s.error_bound)}, {"error_estimate", known_json(s.error_estimate)}});
    paths.push_back({{"rung", path.rung}, {"status", path.status}, {"steps", steps}});
  }
  return {{"subject", c.name}, {"dof", c.dofs}, {"rows", c.rows}, {"damping", c.damping == own_damping ? json("own") : json(c.damping)},
          {"largest_eigenvalue", finite_json(c.largest_eigenvalue)}, {"condition", finite_json(c.condition)},
          {"no_reference", c.no_reference.empty() ? json(nullptr) : json(c.no_reference)}, {"rungs", paths}};
}

}  // namespace delassus::cli
