#include "bench/page.h"

#include <cmath>
#include <set>

#include "bench/text.h"

namespace delassus::bench {

std::string verdict_cell(const Cell& cell) {
  const LawResult* worst = cell.worst();
  if (!worst) return "<td class=\"soft\">–</td>";
  const bool good = cell.failed() == 0;
  return std::string("<td class=\"") + (good ? "good" : "bad") + "\" title=\"" +
         escape(format("%d laws checked; worst: ", cell.checked()) + worst->law) + "\">" + (good ? "✓ " : "✗ ") +
         escape(ratio_text(worst->ratio)) + "</td>";
}

std::string time_cell(const Timing& t, bool mark) {
  if (!t.measured()) return "<td class=\"soft\">–</td>";
  return std::string("<td") + (mark ? " class=\"fast\"" : "") + " title=\"median " + three_digits(t.median) + " µs of " +
         std::to_string(t.batches) + " batches\">" + three_digits(t.lowest) + "</td>";
}

namespace {

std::string fact(const std::string& value, const std::string& text) {
  return "<div><b>" + value + "</b><span>" + escape(text) + "</span></div>";
}

/// The largest ratio of all cells, with where it occurred.
std::pair<double, std::string> worst_of(const Results& r) {
  double ratio = -1;
  std::string where = "no law was checked";
  for (const SceneResult& s : r.scenes)
    for (const Cell& c : s.cells)
      if (const LawResult* w = c.worst(); w && !(w->ratio <= ratio)) {
        ratio = w->ratio;
        where = "worst error ratio; a law holds below 30 (" + c.op + ", " + s.name + ": " + w->law + ")";
      }
  return {ratio, where};
}

using Cost = double (*)(const Cell&);  // [µs]; NaN: not measured

double apply_cost(const Cell& c) { return c.time.apply.lowest; }
double first_solve_cost(const Cell& c) {
  return c.solve_status == "ok" ? c.time.update.lowest + c.time.solve.lowest : NAN;
}

/// The scene on which the slowest and the fastest operator are furthest apart. Times within 5 % count as equal; the
/// operator that comes first in the table is named then.
std::string largest_gap(const Results& r, Cost cost, const std::string& what) {
  double best = 0;
  std::string text;
  for (const SceneResult& s : r.scenes) {
    const Cell *slow = nullptr, *fast = nullptr;
    for (const Cell& c : s.cells) {
      const double t = cost(c);
      if (std::isnan(t)) continue;
      if (!slow || t > 1.05 * cost(*slow)) slow = &c;
      if (!fast || t < 0.95 * cost(*fast)) fast = &c;
    }
    if (!slow || slow == fast) continue;
    const double gap = cost(*slow) / cost(*fast);
    if (gap <= best) continue;
    best = gap;
    text = fact(three_digits(gap) + "×", what + " on " + s.name + ": " + fast->op + " faster than " + slow->op);
  }
  return text;
}

/// A name that may be broken after its underscores.
std::string breakable(const std::string& name) {
  std::string s;
  for (const char c : escape(name)) s += c == '_' ? std::string("_<wbr>") : std::string(1, c);
  return s;
}

using Column = Timing Phases::*;

std::string matrix(const Results& r, const std::string& caption, Column phase) {
  std::string s = "<div class=\"wide\"><table class=\"matrix\"><caption>" + caption + "</caption><thead><tr><th>scene</th>";
  for (const OperatorInfo& o : r.operators) s += "<th>" + breakable(o.name) + "</th>";
  s += "</tr></thead><tbody>";
  for (const SceneResult& scene : r.scenes) {
    s += "<tr><td><a href=\"#" + escape(scene.name) + "\">" + escape(scene.name) + "</a></td>";
    double best = INFINITY;
    if (phase)
      for (const Cell& c : scene.cells)
        if ((c.time.*phase).measured()) best = std::min(best, (c.time.*phase).lowest);
    for (const Cell& c : scene.cells)
      s += phase ? time_cell(c.time.*phase, (c.time.*phase).lowest <= 1.05 * best) : verdict_cell(c);
    s += "</tr>";
  }
  return s + "</tbody></table></div>";
}

}  // namespace

std::string summary_section(const Results& r) {
  const auto [ratio, where] = worst_of(r);
  const int failed = r.failed();
  std::string s = "<header><h1>delassus: report</h1><p>The operator <span class=\"math\">A = J M⁻¹ Jᵀ + R⁻¹</span> of "
    "articulated mechanisms, applied (<span class=\"math\">a = A f</span>) and inverted (<span class=\"math\">f = A⁻¹ a"
    "</span>): every operator of the library on every scene, checked against independent references and timed.</p>";
  s += "<p class=\"soft small\">" + escape(r.machine.date + " · revision " + r.machine.revision + " · " +
       r.machine.processor + " · " + r.machine.compiler) + (r.quick ? " · <b>quick run</b>" : "") + "</p></header>";
  s += "<div class=\"facts\">";
  const int unchecked = r.unchecked();
  const std::string rest = unchecked == 0 ? "" : "; " + std::to_string(unchecked) + " of these pairs were not checked, for want of time: delassus check SCENE --op NAME does";
  s += fact(failed ? "<span class=\"bad\">✗ " + std::to_string(failed) + "</span>" : r.checked() == 0 ? "–" : unchecked ? "<span class=\"good\">✓ hold</span>" : "<span class=\"good\">✓ all hold</span>",
            failed ? "of " + std::to_string(r.checked()) + " law checks failed"
                   : std::to_string(r.checked()) + " law checks: " + std::to_string(r.operators.size()) +
                         " operators on " + std::to_string(r.scenes.size()) + " scenes" + escape(rest));
  s += fact(ratio < 0 ? "–" : escape(ratio_text(ratio)), where);
  s += largest_gap(r, apply_cost, "one application");
  s += largest_gap(r, first_solve_cost, "new configuration and one solve");
  s += "</div><nav><a href=\"#overview\">Overview</a> <a href=\"#accuracy\">Accuracy</a> <a href=\"#size\">Cost against size</a> <a href=\"#scenes\">Scenes</a> "
       "<a href=\"#laws\">Laws</a> <a href=\"#operators\">Operators</a> <a href=\"#machine\">Reproduce</a></nav>";
  return s;
}

std::string overview_section(const Results& r) {
  return "<h2 id=\"overview\">Overview</h2><p>Times are the lowest of several batches in one run, in microseconds, one "
         "core; the median is in each number's tooltip and in <code>results.json</code>. <b>Bold</b>: fastest of its row, and what comes within 5 % of it. "
         "<em>update</em>: the numbers of a configuration; <em>apply</em>, <em>solve</em>: one vector.</p><div class=\"grid\">" +
         matrix(r, "Laws: worst error ratio (holds below 30)", nullptr) + matrix(r, "update [µs]", &Phases::update) +
         matrix(r, "apply [µs]", &Phases::apply) + matrix(r, "solve [µs]", &Phases::solve) + "</div>";
}

std::string page(const Results& r) {
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>delassus: report</title>"
         "<link rel=\"icon\" href=\"data:,\"><style>" + std::string(page_style()) + "</style></head>\n<body>\n" +
         summary_section(r) + "\n<main>\n" + overview_section(r) + "\n" + accuracy_section(r) + "\n" + ladder_section(r) + "\n" + scenes_section(r) +
         "\n" + laws_section(r) + "\n" + operators_section(r) + "\n" + machine_section(r) + "\n</main></body></html>\n";
}

}  // namespace delassus::bench
