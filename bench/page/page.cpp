#include "bench/page/page.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "bench/accuracy/accuracy.h"
#include "bench/text.h"

namespace delassus::bench {

std::string verdict_cell(const Cell& cell) {
  const LawResult* worst = cell.worst();
  if (!worst) return "<td class=\"soft\">–</td>";
  const bool good = cell.failed() == 0;
  const std::string some = cell.left_out() == 0 ? "" : format(" <small>%d/%d</small>", cell.checked(), cell.checked() + cell.left_out());
  if (good && !cell.against_definition())
    return "<td class=\"soft\" title=\"laws of identical bits alone: too large for the others\">" + format("%d of bits", cell.checked()) + "</td>";
  return std::string("<td class=\"") + (good ? "good" : "bad") + "\" title=\"" +
         escape(format("%d laws checked, %d left out; worst: ", cell.checked(), cell.left_out()) + worst->law) + "\">" + (good ? "✓ " : "✗ ") +
         escape(ratio_text(worst->ratio)) + some + "</td>";
}

std::string time_cell(const Timing& t, bool mark) {
  if (!t.measured()) return "<td class=\"soft\">–</td>";
  return std::string("<td") + (mark ? " class=\"fast\"" : "") + " title=\"median " + three_digits(t.median) + " µs of " +
         std::to_string(t.batches) + " batches\">" + three_digits(t.lowest) + "</td>";
}

std::string breakable(const std::string& name) {
  std::string s;
  for (const char c : escape(name)) s += c == '_' ? std::string("_<wbr>") : std::string(1, c);
  return s;
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
  return c.answered(&Phases::solve) ? c.time.update.lowest + c.time.solve.lowest : NAN;
}

/// How much faster `op` is than explicit matrices (dense_cholesky), from the scene where it is least to the one where it is most.
std::string against_dense(const Results& r, const std::string& op, Cost cost, const std::string& what) {
  double least = INFINITY, most = 0;
  const SceneResult *where_least = nullptr, *where_most = nullptr;
  for (const SceneResult& s : r.scenes) {
    const auto cell = [&](const std::string& name) { return std::find_if(s.cells.begin(), s.cells.end(), [&](const Cell& c) { return c.op == name; }); };
    const auto dense = cell("dense_cholesky"), own = cell(op);
    if (dense == s.cells.end() || own == s.cells.end()) continue;
    const double ratio = cost(*dense) / cost(*own);
    if (ratio < least) least = ratio, where_least = &s;
    if (ratio > most) most = ratio, where_most = &s;
  }
  if (!where_least) return "";
  return fact(three_digits(least) + "–" + three_digits(most) + "×", what + ": " + op + " over explicit matrices (dense_cholesky), from " + where_least->name + " to " + where_most->name);
}

using Column = Timing Phases::*;

/// In the place of a time: the status of what ended without an answer.
std::string no_answer(const Cell& c, Column phase) {
  return "<td class=\"soft\" title=\"ended without an answer\">" + breakable(phase == &Phases::solve && !c.solved() ? c.solve_status : c.update_status) + "</td>";
}

/// Scenes beside one another, operators below one another: there are more of these, and one without the phase has no line.
std::string matrix(const Results& r, const std::string& caption, Column phase) {
  std::string s = "<div class=\"wide\"><table class=\"matrix\"><caption>" + caption + "</caption><thead><tr><th>operator</th>";
  std::vector<double> best(r.scenes.size(), INFINITY);
  const auto has_phase = [&](const Cell& c) { return !phase || !c.answered(phase) || (c.time.*phase).measured(); };
  for (std::size_t k = 0; k < r.scenes.size(); ++k) {
    s += "<th><a href=\"#" + escape(r.scenes[k].name) + "\">" + breakable(r.scenes[k].name) + "</a></th>";
    for (const Cell& c : r.scenes[k].cells)
      if (phase && c.answered(phase) && (c.time.*phase).measured()) best[k] = std::min(best[k], (c.time.*phase).lowest);
  }
  s += "</tr></thead><tbody>";
  for (std::size_t i = 0; i < r.operators.size(); ++i) {
    if (std::none_of(r.scenes.begin(), r.scenes.end(), [&](const SceneResult& scene) { return has_phase(scene.cells[i]); })) continue;
    s += "<tr><td>" + escape(r.operators[i].name) + "</td>";
    for (std::size_t k = 0; k < r.scenes.size(); ++k) {
      const Cell& c = r.scenes[k].cells[i];
      s += !phase ? verdict_cell(c) : !c.answered(phase) ? no_answer(c, phase) : time_cell(c.time.*phase, (c.time.*phase).lowest <= 1.05 * best[k]);
    }
    s += "</tr>";
  }
  return s + "</tbody></table></div>";
}

/// What was not held, scene by scene, with the command that does it: for want of time, and what no law of size can judge.
std::string left_out_list(const Results& r) {
  std::string s;
  for (const SceneResult& scene : r.scenes) {
    std::string ops, blind;
    int n = 0;
    for (const Cell& c : scene.cells) {
      if (c.left_out()) ops += " --op " + c.op, n += c.left_out();
      if (c.checked() > 0 && !c.against_definition()) blind += (blind.empty() ? "" : ", ") + c.op;
    }
    const std::string name = "<b>" + escape(scene.name) + "</b>: ";
    if (n > 0) s += "<li>" + name + std::to_string(n) + " laws left out: <code>delassus check " + escape(scene.name + ops) + "</code></li>";
    if (!blind.empty())
      s += "<li>" + name + "held by laws of identical bits alone, too large for the bounds of the others or without an answer: " + escape(blind) +
           "; <code>delassus accuracy " + escape(scene.name) + "</code> measures them against 113 bits</li>";
  }
  if (r.interrupted) s = "<li><b>interrupted</b>: what is missing was not measured</li>" + s;
  return s.empty() ? "" : "<details class=\"small\" open><summary>What was not checked</summary><ul>" + s + "</ul></details>";
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
  const int left = r.left_out();
  const std::string beside = left_out_list(r);
  const std::string rest = left == 0 ? "" : "; " + std::to_string(left) + " more were left out, listed below with the commands that check them";
  s += fact(failed ? "<span class=\"bad\">✗ " + std::to_string(failed) + "</span>" : r.checked() == 0 ? "–" : left || r.interrupted || !beside.empty() ? "<span class=\"good\">✓ hold</span>" : "<span class=\"good\">✓ all hold</span>",
            failed ? "of " + std::to_string(r.checked()) + " law checks failed"
                   : std::to_string(r.checked()) + " law checks: " + std::to_string(r.operators.size()) +
                         " operators on " + std::to_string(r.scenes.size()) + " scenes" + escape(rest));
  s += fact(ratio < 0 ? "–" : escape(ratio_text(ratio)), where);
  s += against_dense(r, "aba_sweep", apply_cost, "time of one application");
  s += against_dense(r, accuracy::default_rung, first_solve_cost, "time of a new configuration and one solve");
  s += "</div>" + beside + "<nav><a href=\"#choosing\">Which operator</a> <a href=\"#overview\">Overview</a> <a href=\"#accuracy\">Accuracy</a> " + std::string(r.ladder.empty() ? "" : "<a href=\"#size\">Cost against size</a> ") + "<a href=\"#scenes\">Scenes</a> "
       "<a href=\"#laws\">Laws</a> <a href=\"#operators\">Operators</a> <a href=\"#machine\">Reproduce</a></nav>";
  return s;
}

std::string overview_section(const Results& r) {
  return "<h2 id=\"overview\">Overview</h2><p>Times are the lowest of several batches in one run, in microseconds, one "
         "core; the median is in each number's tooltip and in <code>results.json</code>. <b>Bold</b>: fastest on its scene, and what comes within 5 % of it. "
         "<em>update</em>: the numbers of a configuration; <em>apply</em>, <em>solve</em>: one vector.</p><div class=\"tables\">" +
         matrix(r, "Laws: worst error ratio (holds below 30)", nullptr) + matrix(r, "update [µs]", &Phases::update) +
         matrix(r, "apply [µs]", &Phases::apply) + matrix(r, "solve [µs]", &Phases::solve) + "</div>";
}

std::string page(const Results& r) {
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>delassus: report</title>"
         "<link rel=\"icon\" href=\"data:,\"><style>" + std::string(page_style()) + "</style></head>\n<body>\n" +
         summary_section(r) + "\n<main>\n" + (r.chosen ? scenes_section(r) + "\n" : "") + choosing_section(r) + "\n" + overview_section(r) + "\n" + accuracy_section(r) + "\n" +
         ladder_section(r) + "\n" + (r.chosen ? "" : scenes_section(r) + "\n") + laws_section(r) + "\n" + operators_section(r) + "\n" + machine_section(r) + "\n</main></body></html>\n";
}

}  // namespace delassus::bench
