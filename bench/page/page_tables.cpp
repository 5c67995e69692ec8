// Sections of the page: laws, operators, and how to reproduce the run.
#include <map>

#include "bench/page/page.h"
#include "bench/text.h"

namespace delassus::bench {

namespace {

/// Worst outcome of one law for one operator over all scenes.
struct Worst {
  double ratio = -1;
  bool passed = true;
  int checked = 0;
  std::string scene, skipped;
};

Worst worst_of(const Results& r, std::size_t op, const std::string& law) {
  Worst w;
  for (const SceneResult& s : r.scenes)
    for (const LawResult& l : s.cells[op].laws) {
      if (l.law != law) continue;
      if (!l.skipped.empty()) {
        w.skipped = l.skipped;
        continue;
      }
      ++w.checked;
      w.passed = w.passed && l.passed;
      if (!(l.ratio <= w.ratio)) w.ratio = l.ratio, w.scene = s.name;
    }
  return w;
}

/// In four characters, for every operator has a column.
std::string short_ratio(double ratio) {
  if (!(ratio > 0)) return format("%.2g", ratio);
  if (ratio < 0.01) return "&lt;.01";
  return ratio < 0.995 ? format("%.2f", ratio).substr(1) : format("%.2g", ratio);
}

std::string law_cell(const Worst& w) {
  if (w.checked == 0) return "<td class=\"soft\" title=\"" + escape(w.skipped) + "\">–</td>";
  return std::string("<td class=\"") + (w.passed ? "good" : "bad") + "\" title=\"" +
         escape(std::to_string(w.checked) + " scenes; worst: " + w.scene) + "\">" +
         (w.passed ? short_ratio(w.ratio) : "✗ " + escape(ratio_text(w.ratio))) + "</td>";
}

std::string failures(const Results& r) {
  std::string s;
  for (const SceneResult& scene : r.scenes)
    for (const Cell& c : scene.cells)
      for (const LawResult& l : c.laws)
        if (l.skipped.empty() && !l.passed)
          s += "<li><code>" + escape(c.op + " · " + scene.name + " · " + l.law) + "</code>: ratio " + escape(ratio_text(l.ratio)) + (l.note.empty() ? "" : ", " + escape(l.note)) + "</li>";
  return s.empty() ? "" : "<h3 class=\"bad\">Laws that failed</h3><ul class=\"small\">" + s + "</ul>";
}

/// Every reason why a law was not checked, with how often.
std::string not_checked(const Results& r) {
  std::map<std::string, int> reasons;
  for (const SceneResult& scene : r.scenes)
    for (const Cell& c : scene.cells)
      for (const LawResult& l : c.laws)
        if (!l.skipped.empty()) ++reasons[l.law + ": " + l.skipped];
  if (reasons.empty()) return "";
  std::string s = "<details class=\"small\"><summary>What was not checked, and why</summary><ul>";
  for (const auto& [reason, n] : reasons) s += "<li>" + escape(reason) + format(" (%d×)", n) + "</li>";
  return s + "</ul></details>";
}

std::string yes(bool b) { return b ? "yes" : "no"; }

}  // namespace

std::string laws_section(const Results& r) {
  std::string s = "<h2 id=\"laws\">Laws</h2><p>A law is an identity between two routes. Its error is divided by the unit "
    "roundoff of the arithmetic and by a named bound; the ratio must stay below 30, the only tolerance there is. The table "
    "shows the worst ratio over all scenes; 0 is exact agreement, ✗ a law that is broken, – one that is not asked.</p>" + failures(r);
  s += "<details><summary>" + std::to_string(r.laws.size()) + " laws and the worst ratio of each operator</summary><div class=\"wide tables\"><table class=\"matrix upright\"><thead><tr><th>law</th>";
  for (const OperatorInfo& o : r.operators) s += "<th>" + breakable(o.name) + "</th>";
  s += "</tr></thead><tbody>";
  for (const RowInfo& law : r.laws) {
    s += "<tr><td>" + escape(law.name) + "</td>";
    for (std::size_t i = 0; i < r.operators.size(); ++i) s += law_cell(worst_of(r, i, law.name));
    s += "</tr>";
  }
  s += "</tbody></table></div></details>" + not_checked(r) +
       "<details><summary>What each law says</summary><div class=\"wide\"><table><thead><tr><th>law</th><th class=\"text\">identity</th>"
       "<th class=\"text\">measured against</th></tr></thead><tbody>";
  for (const RowInfo& law : r.laws)
    s += "<tr><td>" + escape(law.name) + "</td><td class=\"text\">" + escape(law.text) + "</td><td class=\"text\">" + escape(law.detail) + "</td></tr>";
  s += "</tbody></table></div></details>";
  s += "<div class=\"wide\"><table><caption>References</caption><thead><tr><th>name</th><th class=\"text\">what it is</th>"
       "<th class=\"text\">where it can be trusted</th></tr></thead><tbody>";
  for (const RowInfo& ref : r.references)
    s += "<tr><td>" + escape(ref.name) + "</td><td class=\"text\">" + escape(ref.text) + "</td><td class=\"text\">" +
         escape(ref.detail) + "</td></tr>";
  return s + "</tbody></table></div>";
}

std::string operators_section(const Results& r) {
  std::string s = "<h2 id=\"operators\">Operators</h2><div class=\"wide\"><table><thead><tr><th>name</th><th class=\"text\">"
    "summary</th><th class=\"text\">formula</th><th class=\"text\">cost</th><th>apply</th><th>solve</th><th>R⁻¹ = 0</th>"
    "<th class=\"text\">error grows</th><th class=\"text\">source</th></tr></thead><tbody>";
  for (const OperatorInfo& o : r.operators) {
    std::string error = o.applies ? "apply " + o.apply_error : "";
    if (o.solves) error += std::string(error.empty() ? "" : ", ") + "solve " + o.solve_error;
    s += "<tr><td>" + escape(o.name) + "</td><td class=\"text\">" + escape(o.summary) + "</td><td class=\"text math\">" +
         escape(o.formula) + "</td><td class=\"text\">" + escape(o.cost) + "</td><td>" + yes(o.applies) + "</td><td>" +
         yes(o.solves) + "</td><td>" + yes(o.zero_damping) + "</td><td class=\"text\">" + escape(error) +
         "</td><td class=\"text\">" + escape(o.source) + "</td></tr>";
  }
  return s + "</tbody></table></div>";
}

std::string machine_section(const Results& r) {
  const Machine& m = r.machine;
  std::string s = "<h2 id=\"machine\">Machine, and how to reproduce</h2><div class=\"wide\"><table><tbody>";
  const auto row = [&](const char* key, const std::string& value) {
    s += std::string("<tr><td>") + key + "</td><td class=\"text\">" + escape(value) + "</td></tr>";
  };
  row("processor", m.processor + format(", %d core%s seen", m.cores, m.cores == 1 ? "" : "s"));
  row("system", m.system);
  row("compiler", m.compiler + "  " + m.flags);
  row("revision", m.revision);
  row("date", m.date);
  row("run time", three_digits(r.seconds) + " s");
  s += "</tbody></table></div><pre>cmake --preset release\ncmake --build build/release\n"
       "build/release/cli/delassus report --out report" + std::string(r.quick ? " --quick" : "") + "</pre>";
  return s + "<p class=\"soft small\">Times belong to this machine and this run, and compare only within it. Checks run on "
             "all cores, timings alone on one. The numbers of this page are in <code>results.json</code> beside it.</p>";
}

}  // namespace delassus::bench
