#include "bench/scaling/figure2.h"

#include <algorithm>
#include <cmath>

#include "bench/json.h"
#include "bench/scaling/ladder.h"
#include "bench/machine.h"
#include "bench/page/plot.h"
#include "bench/text.h"

namespace delassus::bench {

using nlohmann::json;

namespace {

double known(std::int64_t n) { return n < 0 ? NAN : static_cast<double>(n); }

SwimmerCell cell_of(const Cell& c) {
  SwimmerCell s{c.op, c.skipped, NAN, NAN, NAN, NAN, c.bytes};
  if (!c.skipped.empty()) return s;
  const Phases& t = c.time;
  const Operations& n = c.operations;
  const bool solves = t.solve.measured() && c.answered(&Phases::solve);
  if (solves) s.solve = t.update.lowest + t.solve.lowest, s.solve_operations = known(n.update) + known(n.solve);
  if (!t.apply.measured() || !c.answered(&Phases::apply)) return s;
  s.product = t.update.lowest + t.apply.lowest - (t.solve.measured() ? t.new_damping.lowest : 0);
  s.product_operations = known(n.update) + known(n.apply) - (t.solve.measured() ? known(n.new_damping) : 0);
  return s;
}

using Points = std::vector<std::pair<double, double>>;

Points points_of(const Figure2& f, const std::string& op, double SwimmerCell::*y) {
  Points p;
  for (const SwimmerSize& size : f.sizes)
    for (const SwimmerCell& c : size.cells)
      if (c.op == op && c.*y > 0) p.emplace_back(static_cast<double>(size.links), c.*y);
  return p;
}

std::string two_decimals(double x) { return std::isnan(x) ? "–" : format("%.2f", x); }

}  // namespace

double slope(const Points& points) {
  double largest = 0, n = 0, x1 = 0, y1 = 0, xx = 0, xy = 0;
  for (const auto& p : points) largest = std::max(largest, p.first);
  for (const auto& [a, b] : points) {
    if (a < largest / 10.001) continue;
    const double x = std::log(a), y = std::log(b);
    n += 1, x1 += x, y1 += y, xx += x * x, xy += x * y;
  }
  return n < 2 ? NAN : (n * xy - x1 * y1) / (n * xx - x1 * x1);
}

Figure2 measure_swimmers(std::int64_t largest, double budget, double longest, double most_bytes, const std::function<void(const std::string&)>& progress,
                         const std::function<bool()>& stop) {
  Figure2 f{this_machine(), longest, most_bytes, {}};
  for (const Rung& r : climb(ladder_sizes(largest), {budget, longest}, longest, most_bytes, progress, stop)) {
    SwimmerSize& size = f.sizes.emplace_back(SwimmerSize{r.links, r.dofs, r.rows, r.kinematics.lowest, {}});
    for (const Cell& c : r.cells) size.cells.push_back(cell_of(c));
  }
  return f;
}

std::string figure2_text(const Figure2& f) {
  const Machine& m = f.machine;
  std::string s = m.processor + "; " + m.compiler + " " + m.flags + "; revision " + m.revision + ", " + m.date +
                  format(". Budget: %g s per phase and %.1f GB.\n\n", f.longest, 1e-9 * f.most_bytes);
  if (f.sizes.empty()) return s;
  std::vector<std::vector<std::string>> rows{{"operator", "links", "rows", "product: operations", "time", "solve: operations", "time", "left out because"}};
  for (const SwimmerCell& first : f.sizes.front().cells) {
    const SwimmerSize* last = nullptr;
    std::string why;
    for (const SwimmerSize& size : f.sizes)
      for (const SwimmerCell& c : size.cells)
        if (c.op == first.op && (c.skipped.empty() || why.empty())) (c.skipped.empty() ? last = &size : nullptr), why = c.skipped;
    const auto of = [&](double SwimmerCell::*y) { return two_decimals(slope(points_of(f, first.op, y))); };
    rows.push_back({first.op, last ? std::to_string(last->links) : "–", last ? std::to_string(last->rows) : "–", of(&SwimmerCell::product_operations), of(&SwimmerCell::product),
                    of(&SwimmerCell::solve_operations), of(&SwimmerCell::solve), why.empty() ? "reached the end" : why});
  }
  return s + markdown_table(rows);
}

std::string figure2_picture(const Figure2& f, bool solves) {
  std::vector<Series> series;
  if (f.sizes.empty()) return "";
  for (std::size_t i = 0; i < f.sizes.front().cells.size(); ++i) {
    const std::string& op = f.sizes.front().cells[i].op;
    series.push_back({op, points_of(f, op, solves ? &SwimmerCell::solve : &SwimmerCell::product), static_cast<int>(i), false});
  }
  const std::string what = solves ? "first solve" : "first product";
  return standalone(labelled_plot(solves ? "swimmers-solve" : "swimmers-product", what + " of every operator on swimmers of growing length", "links", "µs, " + what, series));
}

void to_json(json& j, const Figure2& f) {
  j = {{"machine", f.machine}, {"longest_seconds", f.longest}, {"most_bytes", f.most_bytes}, {"swimmers", json::array()}};
  for (const SwimmerSize& s : f.sizes) {
    json& of = j["swimmers"].emplace_back(json{{"links", s.links}, {"dof", s.dofs}, {"rows", s.rows}, {"kinematics_microseconds", number(s.kinematics)}, {"operators", json::array()}});
    for (const SwimmerCell& c : s.cells) {
      json one = {{"operator", c.op}};
      if (!c.skipped.empty()) one["skipped"] = c.skipped;
      else one.update({{"product_microseconds", number(c.product)}, {"solve_microseconds", number(c.solve)}, {"product_operations", number(c.product_operations)},
                       {"solve_operations", number(c.solve_operations)}, {"bytes", c.bytes}});
      of["operators"].push_back(one);
    }
  }
}

void from_json(const json& j, Figure2& f) {
  f.machine = j.at("machine");
  f.longest = j.at("longest_seconds");
  f.most_bytes = j.at("most_bytes");
  f.sizes.clear();
  for (const json& s : j.at("swimmers")) {
    SwimmerSize& size = f.sizes.emplace_back(SwimmerSize{s.at("links"), s.at("dof"), s.at("rows"), number_of(s.at("kinematics_microseconds")), {}});
    for (const json& c : s.at("operators")) {
      SwimmerCell& cell = size.cells.emplace_back();
      cell.op = c.at("operator");
      cell.skipped = c.value("skipped", "");
      if (!cell.skipped.empty()) continue;
      cell.product = number_of(c.at("product_microseconds"));
      cell.solve = number_of(c.at("solve_microseconds"));
      cell.product_operations = number_of(c.at("product_operations"));
      cell.solve_operations = number_of(c.at("solve_operations"));
      cell.bytes = c.at("bytes");
    }
  }
}

}  // namespace delassus::bench
