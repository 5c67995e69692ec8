#include "cli/check_digits.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <numeric>

#include "algorithms/errors/message.h"
#include "bench/page/digits_picture.h"
#include "bench/page/plot.h"
#include "bench/text.h"
#include "cli/commands.h"
#include "cli/common.h"
#include "generators/random.h"
#include "property_tests/laws/digits.h"
#include "property_tests/laws/laws.h"

namespace delassus::cli {

namespace {

using bench::format;
using digits::Link;

constexpr Index most_costs = 150;  // bodies for which the cost O(N²) of Link::cost is paid

/// A problem with names.
struct Subject {
  std::string label;
  std::optional<Scene> scene;
  Problem<double> problem;
  Damping<double> damping;
  std::vector<std::string> bodies, joints, rows;
};

const char* const no_damping = "a finite number above 0 [1/kg]; --op aba_sweep takes 0";

Subject subject(const DigitsOptions& o) {
  Subject s;
  if (o.scene.empty()) {
    const Index n = o.n > 0 ? o.n : [&] {
      const auto& sizes = generators::find_family(o.family).sizes;
      return sizes[sizes.size() / 2];
    }();
    const laws::Case c = laws::make_case(o.family, n, o.seed);
    s = {c.label, std::nullopt, c.problem, c.damping, {}, {}, {}};
    if (o.damping) s.damping = Damping<double>::uniform(c.rows(), *o.damping);
    for (Index i = 0; i < s.problem.structure->bodies(); ++i) {
      s.bodies.push_back("body " + std::to_string(i));
      s.joints.push_back(format("%d dof", static_cast<int>(s.problem.structure->dofs(i))));
    }
    s.rows.assign(static_cast<std::size_t>(c.rows()), "");
  } else {
    s.scene = open(o.scene, o.opening, o.damping);
    s.label = s.scene->name;
    s.problem = problem_of(*s.scene);
    s.damping = s.scene->damping;
    for (const Body& b : s.scene->model.bodies) {
      s.bodies.push_back(b.name);
      s.joints.push_back(b.joint.name.empty() ? std::string(name(b.joint.type)) : b.joint.name);
    }
    for (const Constraint& c : s.scene->model.constraints)
      s.rows.insert(s.rows.end(), static_cast<std::size_t>(row_count(s.scene->model, c)),
                    c.name.empty() ? std::string(name(c.kind)) : c.name);
  }
  if (o.damping) s.label += format(", damping %g 1/kg", *o.damping);
  return s;
}

digits::Measured measured(const Subject& s, const DigitsOptions& o) {
  generators::Random random(o.seed);
  VectorX<double> x(s.problem.structure->rows);
  for (double& e : x) e = random.integer(-1000, 1000) / 1000.0;
  const bool apply = o.op == "aba_sweep";
  const auto m = digits::measure(s.problem, s.damping, x, apply ? digits::Computation::apply : digits::Computation::solve, o.seed,
                                 s.problem.structure->bodies() <= most_costs ? digits::Costs::of_links_too : digits::Costs::of_stages);
  if (m.report.status == Status::zero_damping)
    throw ModelError("", "damping of row " + std::to_string(m.report.where), "is zero or its block singular: lcaba divides by it", no_damping);
  return m;
}

/// What the operator says in double, update or solve; random rounding takes the branches of the mean and may get further.
Report in_double(const Subject& s, const DigitsOptions& o) {
  const OperatorRow& row = find_operator(o.op);
  const auto op = row.make<double>();
  op->analyze(s.problem.structure);
  const Report updated = op->update(s.problem, s.damping);
  if (!updated.ok() || !row.solves) return updated;
  Workspace<double> work(op->workspace());
  const MatrixX<double> a = MatrixX<double>::Ones(s.problem.structure->rows, 1);
  MatrixX<double> f = a;
  return op->solve(a, f, work);
}

/// "lost_pivot at degree of freedom 3"
std::string outcome(const Report& r) {
  return std::string(name(r.status)) + (r.where < 0 ? std::string() : format(" at degree of freedom %d", static_cast<int>(r.where)));
}

void print_warning(const DigitsOptions& o, const Report& r) {
  if (!r.ok()) std::printf("WARNING: in double %s refuses this problem: %s. The digits are of what it would have computed.\n\n", o.op.c_str(), outcome(r).c_str());
}

std::string cell(double digits, std::size_t width = 10) { return bench::pad_left(format("%.1f", digits), width); }

const Link& worst_link(const digits::Measured& m) {
  return *std::min_element(m.links.begin(), m.links.end(), [](const Link& a, const Link& b) { return a.fewest() < b.fewest(); });
}
template <class T> const T& costliest(const std::vector<T>& parts) {
  return *std::max_element(parts.begin(), parts.end(), [](const T& a, const T& b) { return a.cost < b.cost; });
}

/// Rows, worst first.
std::vector<std::size_t> row_order(const digits::Measured& m) {
  std::vector<std::size_t> order(m.result.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return m.result[a].digits() < m.result[b].digits(); });
  return order;
}

void print_links(const Subject& s, const digits::Measured& m) {
  std::size_t body = 4, joint = 5;
  for (const std::string& b : s.bodies) body = std::max(body, b.size());
  for (const std::string& j : s.joints) joint = std::max(joint, j.size());
  std::printf("Digits lost, of %.1f\n  %s %s   inertia     pivot  backward   forward         a    cost\n", most_digits,
              bench::pad_right("body", body).c_str(), bench::pad_right("joint", joint).c_str());
  for (const Link& l : m.links) {
    const auto i = static_cast<std::size_t>(l.body);
    std::printf("  %s %s", bench::pad_right(s.bodies[i], body).c_str(), bench::pad_right(s.joints[i], joint).c_str());
    for (const double kept : {l.inertia, l.pivot, l.backward, l.forward, l.acceleration}) std::printf("%s", cell(most_digits - kept).c_str());
    std::printf("%s\n", std::isnan(l.cost) ? "      –" : cell(l.cost, 7).c_str());
  }
}

void print(const Subject& s, const DigitsOptions& o, const digits::Measured& m) {
  std::printf("%s, %s\n\n", s.label.c_str(), o.op.c_str());
  print_links(s, m);
  std::printf("\nDigits kept, rows of the result, worst first\n      row    J ν  result  value ± 95 %%\n");
  for (const std::size_t r : row_order(m))
    std::printf("  %7zu %6.1f %7.1f  %.8g ± %.1e  %s\n", r, m.motion[r].digits(), m.result[r].digits(), m.result[r].mean(),
                m.result[r].half_width(), s.rows[r].c_str());
  std::printf("\nParts: digits kept by their own numbers, and digits of the result they cost\n");
  for (const digits::Stage& stage : m.stages)
    std::printf("  %s %5.1f %7.1f\n", bench::pad_right(std::string(stage.name), 22).c_str(), stage.kept, stage.cost);
  if (m.links.empty()) return;
  const digits::Stage& stage = costliest(m.stages);
  const Link& step = costliest(m.links);
  std::printf("\nThe result keeps %.1f digits; costliest part: %s, %.1f.", m.stages.back().kept, std::string(stage.name).c_str(), stage.cost);
  if (step.cost > digits::clear_cost)
    std::printf(" Costliest step of the factor: %s, %.1f.", s.bodies[static_cast<std::size_t>(step.body)].c_str(), step.cost);
  std::printf("\nFewest digits on a link: %s, %.1f.\n", s.bodies[static_cast<std::size_t>(worst_link(m).body)].c_str(), worst_link(m).fewest());
}

json to_json(const Subject& s, const DigitsOptions& o, const digits::Measured& m, const Report& refused) {
  json links = json::array(), rows = json::array(), stages = json::array();
  for (const Link& l : m.links)
    links.push_back({{"body", s.bodies[static_cast<std::size_t>(l.body)]}, {"joint", s.joints[static_cast<std::size_t>(l.body)]},
                     {"inertia", l.inertia}, {"pivot", l.pivot}, {"backward", l.backward}, {"forward", l.forward},
                     {"acceleration", l.acceleration}, {"fewest", l.fewest()},
                     {"cost", std::isnan(l.cost) ? json(nullptr) : json(l.cost)}});
  for (const std::size_t r : row_order(m))
    rows.push_back({{"row", r}, {"constraint", s.rows[r]}, {"motion", m.motion[r].digits()}, {"result", m.result[r].digits()},
                    {"value", m.result[r].mean()}, {"half_width", m.result[r].half_width()}});
  for (const digits::Stage& stage : m.stages) stages.push_back({{"part", stage.name}, {"kept", stage.kept}, {"cost", stage.cost}});
  json j = {{"subject", s.label}, {"op", o.op}, {"most_digits", most_digits}, {"report", report_json(m.report)}, {"in_double", report_json(refused)},
            {"links", links}, {"rows", rows}, {"parts", stages}};
  if (s.scene) j["warnings"] = warnings_json(*s.scene);
  j["worst_link"] = m.links.empty() ? json(nullptr) : json(s.bodies[static_cast<std::size_t>(worst_link(m).body)]);
  return j;
}

/// Digits kept against the number of the link, for problems without geometry.
std::string link_plot(const Subject& s, const digits::Measured& m) {
  std::vector<bench::Series> series = {{"inertia", {}, 2}, {"pivot", {}, 0}, {"backward", {}, 3}, {"forward", {}, 1}};
  for (const Link& l : m.links) {
    const double kept[] = {l.inertia, l.pivot, l.backward, l.forward};
    for (std::size_t k = 0; k < series.size(); ++k) series[k].points.emplace_back(static_cast<double>(l.body), kept[k]);
  }
  std::string svg = bench::plot("digits", "Digits kept per link, " + s.label, "link", "digits kept", series, bench::Axes::linear);
  if (!svg.empty()) svg.insert(4, " style=\"background:#fff;color:#000\"");
  return svg;
}

void write_picture(const Subject& s, const DigitsOptions& o, const digits::Measured& m) {
  std::vector<bench::DigitsPanel> panels = {{"Factor: inertia and pivot", {}}, {"Backward sweep: D⁻¹u", {}}, {"Forward sweep: ν and a", {}}};
  for (const Link& l : m.links) {
    panels[0].digits.push_back(std::min(l.inertia, l.pivot));
    panels[1].digits.push_back(l.backward);
    panels[2].digits.push_back(std::min(l.forward, l.acceleration));
  }
  const std::string svg = s.scene ? bench::digits_picture(*s.scene, panels, "Digits kept: " + s.label) : link_plot(s, m);
  if (svg.empty()) throw ModelError("", "--picture", "the plot needs gnuplot, which cannot be run", "a scene, or gnuplot; install gnuplot, or give a scene");
  if (!(std::ofstream(o.picture) << svg << std::flush)) throw ModelError(o.picture, "file", "cannot be written", "a path to write an SVG to; make its folder first");
  if (!o.as_json) std::printf("%s: %s\n", o.picture.c_str(), s.scene ? "the scene after the factor and after each sweep" : "digits against link (a family has no geometry)");
}

}  // namespace

int check_digits(const DigitsOptions& o) {
  if (o.scene.empty() == o.family.empty())
    throw ModelError("", "check --digits", o.scene.empty() ? "no scene and no family is given" : "a scene and a family are given", "one of them; `delassus list scenes` and `list families` have the names");
  if (o.op != "aba_sweep" && o.op != "lcaba") throw ModelError("", "--op", "'" + o.op + "' cannot be measured", "aba_sweep, lcaba; leave --op away for lcaba");
  if (o.damping && !(std::isfinite(*o.damping) && *o.damping >= 0))
    throw ModelError("", "--damping", number_text(*o.damping) + " 1/kg", no_damping);
  const Subject s = subject(o);
  const digits::Measured m = measured(s, o);
  const Report refused = in_double(s, o);
  if (o.as_json) {
    std::printf("%s\n", to_json(s, o, m, refused).dump(1).c_str());
  } else if (m.report.ok()) {
    print_warning(o, refused);
    print(s, o, m);
  } else {
    std::printf("%s, %s: %s\n", s.label.c_str(), o.op.c_str(), outcome(m.report).c_str());
  }
  if (!m.report.ok()) return law_broken;
  if (!o.picture.empty()) write_picture(s, o, m);
  return good;
}

}  // namespace delassus::cli
