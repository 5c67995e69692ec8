#include "cli/accuracy_simulation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bench/text.h"
#include "cli/common.h"

namespace delassus::cli {

using namespace accuracy;
using bench::format;
using bench::pad_left;
using bench::pad_right;

namespace {

json text(const std::string& s) { return s.empty() ? json(nullptr) : json(s); }
json to_json(const Distance& d) { return {{"metres", finite_json(d.metres)}, {"radians", finite_json(d.radians)}}; }
json to_json(const Reference& r) {
  return {{"error", to_json(r.error)}, {"order", finite_json(r.order)}, {"extrapolated", r.extrapolates}, {"why_not", text(r.why_not)}};
}
json to_json(const SimulatedCell& c, bool relaxed) {
  json out = {{"step", c.step}, {"tolerance", c.tolerance > 0 ? json(c.tolerance) : json(nullptr)}, {"why_not", text(c.why_not)}, {"error", to_json(c.error)},
              {"order", finite_json(c.order)}, {"seconds", finite_json(c.seconds)}, {"steps", c.steps}, {"rejected", c.rejected}, {"iterations", c.iterations}};
  if (relaxed) out["numerical"] = to_json(c.numerical), out["modelling"] = to_json(c.modelling);
  return out;
}

std::string error_text(double x) { return std::isnan(x) ? "–" : x == 0 ? "0" : format("%.1e", x); }

void print_reference(const char* law, const Reference& r, const SimulatedScene& s) {
  if (!r.why_not.empty()) {
    std::printf("no reference%s, and no errors: %s\n", law, r.why_not.c_str());
    return;
  }
  std::printf("reference%s by %s, %s %g s and %s: within %s m, %s rad; order seen %.2f%s\n", law, s.reference_by.c_str(), r.extrapolates ? "limit of steps to" : "steps of",
              s.reference_step, r.extrapolates ? "its doubles" : "compared with its doubles", error_text(r.error.metres).c_str(), error_text(r.error.radians).c_str(), r.order,
              r.extrapolates ? "" : ", not the declared one: nothing is extrapolated");
}

void print_line(const SimulatedLine& line, bool laws, double floor) {
  std::printf("\n%s, order %d%s%s\n", line.name.c_str(), line.order, line.why_not.empty() ? "" : ": ", line.why_not.c_str());
  const auto same = [&](const SimulatedCell& c) { return !c.why_not.empty() && c.why_not == line.cells.front().why_not; };
  if (!line.cells.empty() && std::all_of(line.cells.begin(), line.cells.end(), same)) {
    std::printf("  at every step: %s\n", line.cells.front().why_not.c_str());
    return;
  }
  for (const SimulatedCell& c : line.cells) {
    std::string row = pad_left(line.controlled ? "to " + format("%g", c.tolerance) : format("%.4g s", c.step), 12);
    if (!c.why_not.empty()) {
      std::printf("%s  %s\n", row.c_str(), c.why_not.c_str());
      continue;
    }
    for (const Distance& d : {c.error, c.numerical, c.modelling}) {
      row += pad_left(error_text(d.metres), 9) + pad_left(error_text(d.radians), 9);
      if (!laws) break;
      if (!line.relaxed) {
        row += pad_left("", 36);
        break;
      }
    }
    row += pad_left(std::isnan(c.order) ? "–" : format("%.2f", c.order), 7);
    row += pad_left(bench::three_digits(1e3 * c.seconds), 9) + format("%9lld", static_cast<long long>(c.steps));
    row += pad_left(line.controlled ? std::to_string(c.rejected) : std::to_string(c.iterations), 9);
    std::printf("%s%s\n", row.c_str(), c.error.size() <= floor ? "  not above the reference's own" : "");
  }
}

}  // namespace

json simulated_json(const SimulatedScene& s) {
  json lines = json::array();
  for (const SimulatedLine& line : s.lines) {
    json cells = json::array();
    for (const SimulatedCell& c : line.cells) cells.push_back(to_json(c, line.relaxed));
    lines.push_back({{"name", line.name}, {"integrator", line.settings.integrator}, {"order", line.order}, {"controlled", line.controlled},
                     {"law", line.relaxed ? "relaxed" : "exact"}, {"solver", text(line.settings.solver)}, {"residual", line.settings.residual},
                     {"operator", line.settings.op}, {"accuracy", line.settings.accuracy}, {"why_not", text(line.why_not)}, {"runs", cells}});
  }
  json out = {{"scene", s.name}, {"duration", s.duration}, {"bodies", s.bodies}, {"dof", s.dofs}, {"instants", s.instants},
              {"reference_by", s.reference_by}, {"reference_step", s.reference_step}, {"reference", to_json(s.reference)}, {"lines", lines}};
  if (s.has_relaxed) out["relaxed_reference"] = to_json(s.relaxed), out["between_laws"] = to_json(s.between_laws);
  return out;
}

void print_simulated(const SimulatedScene& s) {
  std::printf("%s: %g s, %d bodies, %d dofs. Errors of centres of mass [m] and rotations [rad]: root mean square over the bodies, the largest of %d instants\n",
              s.name.c_str(), s.duration, static_cast<int>(s.bodies), static_cast<int>(s.dofs), s.instants);
  print_reference(s.has_relaxed ? " of the exact law" : "", s.reference, s);
  if (s.has_relaxed) {
    print_reference(" of the relaxed law", s.relaxed, s);
    std::printf("their limits are %s m, %s rad apart\n", error_text(s.between_laws.metres).c_str(), error_text(s.between_laws.radians).c_str());
  }
  std::printf("\n        step    error      rad%s  order  time ms    steps iterations or rejected\n", s.has_relaxed ? "   numer.      rad   model.      rad" : "");
  for (const SimulatedLine& line : s.lines) print_line(line, s.has_relaxed, s.reference.error.size());
  std::printf("\n");
}

void add_simulate_options(options::Command& c, SimulateOptions& o, const options::Option* simulate) {
  auto& m = o.measured;
  std::vector<std::string> names;
  for (const auto& row : simulation::integrators()) names.emplace_back(row.name);
  c.add_option("--duration", o.duration, "with --simulate: simulated time, a whole number of the largest step")->check(options::duration())->capture_default_str()->needs(simulate);
  c.add_option("--step", m.step, "with --simulate: the largest step [s]; errors are looked at after each of its like")->check(options::above(0, "s"))->capture_default_str()->needs(simulate);
  c.add_option_function("--halvings", [&m](const std::string& text) { m.halvings = std::stoi(text); }, "with --simulate: how often the step is halved, 1 to 12 (default: 5); references take two more")
      ->check([](const std::string& text) { return text.size() <= 2 && options::whole(1)(text).empty() && std::stoi(text) <= 12 ? std::string() : "is '" + text + "' (accepted: a whole number from 1 to 12; a smaller --step for smaller ones)"; })
      ->needs(simulate);
  c.add_option("--integrator", m.integrators, "with --simulate: only these (see `delassus list integrators`)")->check(options::one_of(names))->needs(simulate);
  c.add_option("--solver", m.solvers, "with --simulate: only these solvers of contacts, limits and dry friction, by every law that they solve")->needs(simulate);
  c.add_option("--tolerance", m.tolerances, "with --simulate: asked of solvers [m/s], of the operator of equations, of error control; when left out 1e-6 and 1e-10, of error control 1e-3 … 1e-11")
      ->check(options::above(0, ""))->needs(simulate);
  c.add_option("--longest", m.longest, "with --simulate: a run that computes longer ends [s]")->check(options::above(0, "s"))->capture_default_str()->needs(simulate);
  c.add_option("--picture", o.picture, "with --simulate: FILE.svg, error against computing time")->needs(simulate);
}

}  // namespace delassus::cli
