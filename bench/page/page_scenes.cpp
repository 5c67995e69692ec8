// Sections of the page: cost against size, and the scenes one by one.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "bench/page/drawing.h"
#include "bench/page/page.h"
#include "bench/page/plot.h"
#include "bench/text.h"

namespace delassus::bench {

namespace {

const char* const cell_head =
    "<thead><tr><th rowspan=\"2\">operator</th><th colspan=\"5\">time [µs]</th><th colspan=\"4\">operations</th>"
    "<th rowspan=\"2\">memory</th><th rowspan=\"2\">worst<br>ratio</th></tr><tr><th>analyze</th><th>update</th>"
    "<th>new<br>damping</th><th>apply</th><th>solve</th><th>update</th><th>new<br>damping</th><th>apply</th><th>solve</th>"
    "</tr></thead>";

std::string count_cell(std::int64_t n) { return "<td>" + short_count(n) + "</td>"; }

/// Time of a solve, or the status when it did not end well.
std::string solve_cell(const Cell& c) {
  if (c.solve_status.empty() || c.solve_status == "ok") return time_cell(c.time.solve);
  return "<td title=\"status of the solve\">" + escape(c.solve_status) + "</td>";
}

std::string cell_row(const Cell& c) {
  std::string s = "<tr><td>" + escape(c.op);
  if (!c.update_status.empty() && c.update_status != "ok") s += " <small class=\"bad\">" + escape(c.update_status) + "</small>";
  s += "</td>" + time_cell(c.time.analyze) + time_cell(c.time.update) + time_cell(c.time.new_damping) +
       time_cell(c.time.apply) + solve_cell(c);
  s += count_cell(c.operations.update) + count_cell(c.operations.new_damping) + count_cell(c.operations.apply) +
       count_cell(c.operations.solve);
  return s + "<td>" + short_bytes(c.bytes) + "</td>" + verdict_cell(c) + "</tr>";
}

std::string damping_text(const SceneResult& s) {
  if (s.rows == 0) return "";
  if (s.largest_damping == 0) return "no damping";
  std::string text = "R⁻¹ = " + format("%g", s.smallest_damping);
  if (s.largest_damping != s.smallest_damping) text += format(" … %g", s.largest_damping);
  return text + " kg⁻¹";
}

std::string facts(const SceneResult& s) {
  std::string text = format("%lld bodies in %lld tree%s, %lld dofs, <b>%lld rows</b>", static_cast<long long>(s.bodies),
                            static_cast<long long>(s.trees), s.trees == 1 ? "" : "s", static_cast<long long>(s.dofs),
                            static_cast<long long>(s.rows));
  text += ": " + escape(s.summary) + ". " + damping_text(s) + ".";
  if (s.has_loops) text += format(" Loops closed to %.0e.", s.loop_residual);
  text += " Kinematics and rows: " + three_digits(s.kinematics.lowest) + " µs.";
  if (s.provisional_pose) text += " The pose was made by hand.";
  return text;
}

/// From q to one answer, operator by operator: kinematics, update, solve, and what refinement and certificate add to it.
std::string time_bars(const SceneResult& s) {
  struct Bar {
    std::string op;
    std::array<double, 4> parts;
    double total;
  };
  std::vector<Bar> bars;
  for (const Cell& c : s.cells) {
    if (c.solve_status.empty() || !c.answered(&Phases::solve)) continue;
    const double solve = c.time.solve.lowest, plain = c.time.unrefined.measured() ? std::min(solve, c.time.unrefined.lowest) : solve;
    Bar bar{c.op, {s.kinematics.lowest, c.time.update.lowest, plain, solve - plain}, 0};
    for (const double part : bar.parts) bar.total += part;
    bars.push_back(bar);
  }
  if (bars.empty()) return "";
  std::stable_sort(bars.begin(), bars.end(), [](const Bar& x, const Bar& y) { return x.total < y.total; });
  constexpr double most = 6;  // times the fastest: what takes longer is named only
  std::string out, slower;
  const double fastest = bars.front().total;
  double longest = 0;
  for (const Bar& b : bars)
    if (b.total <= most * fastest) longest = std::max(longest, b.total);
  for (const Bar& b : bars) {
    if (b.total > most * fastest) {
      slower += (slower.empty() ? "" : ", ") + escape(b.op) + " " + three_digits(b.total / fastest) + "×";
      continue;
    }
    out += "<span>" + escape(b.op) + "</span><div>";
    for (std::size_t k = 0; k < 4; ++k) out += "<i class=\"k" + std::to_string(k) + "\" style=\"width:" + format("%.1f", 68 * b.parts[k] / longest) + "%\"></i>";
    out += three_digits(b.total) + " µs</div>";
  }
  return "<div class=\"bars-key\">from q to one answer:<i class=\"k0\"></i>kinematics and rows<i class=\"k1\"></i>update<i class=\"k2\"></i>solve<i class=\"k3\"></i>"
         "refine and certify</div><div class=\"bars\">" + out + "</div>" + (slower.empty() ? "" : "<p class=\"small soft\">slower than " + format("%g", most) + "× the fastest: " + slower + "</p>");
}

std::string scene_article(const SceneResult& s) {
  std::string out = "<article class=\"scene\" id=\"" + escape(s.name) + "\"><figure>" + s.picture + "</figure><div><h3>" +
                    escape(s.name) + "</h3><p class=\"small\">" + facts(s) + "</p><div class=\"wide\"><table>" + cell_head +
                    "<tbody>";
  for (const Cell& c : s.cells) out += cell_row(c);
  out += "</tbody></table></div>" + time_bars(s);
  if (!s.notes.empty()) {
    out += "<details class=\"small\"><summary>notes of the loader</summary><ul>";
    for (const std::string& note : s.notes) out += "<li>" + escape(note) + "</li>";
    out += "</ul></details>";
  }
  return out + "</div></article>";
}

/// One series per operator: value(cell) against the number of links, where it is known and positive.
template <class F> std::vector<Series> series(const Results& r, F&& value) {
  std::vector<Series> all;
  for (std::size_t i = 0; i < r.operators.size(); ++i) {
    Series s{r.operators[i].name, {}, static_cast<int>(i)};
    for (const Rung& rung : r.ladder) {
      const double y = rung.cells[i].skipped.empty() ? value(rung.cells[i]) : NAN;
      if (y > 0) s.points.emplace_back(static_cast<double>(rung.links), y);
    }
    if (!s.points.empty()) all.push_back(std::move(s));
  }
  return all;
}

std::string figure(const std::string& svg, const std::string& caption) {
  return svg.empty() ? "" : "<figure>" + svg + "<figcaption>" + caption + "</figcaption></figure>";
}

std::string plots(const Results& r) {
  const auto time = [&](const char* id, Timing Phases::*phase, const char* caption) {
    const auto value = [&](const Cell& c) { return c.answered(phase) ? (c.time.*phase).lowest : NAN; };
    return figure(plot(id, std::string(caption) + ": time against links", "links", "time [µs]", series(r, value)), caption);
  };
  std::string s = time("p-update", &Phases::update, "update: the numbers of a new configuration") +
                  time("p-damping", &Phases::new_damping, "new damping: the numbers of a new R⁻¹") +
                  time("p-apply", &Phases::apply, "apply: a = A f") + time("p-solve", &Phases::solve, "solve: f = A⁻¹ a");
  const auto operations = [](const Cell& c) {
    if (!c.answered(&Phases::solve)) return static_cast<double>(NAN);
    return static_cast<double>(std::max<std::int64_t>(0, c.operations.update) + std::max<std::int64_t>(0, c.operations.apply) +
                               std::max<std::int64_t>(0, c.operations.solve));
  };
  s += figure(plot("p-operations", "counted operations against links", "links", "operations", series(r, operations)),
              "counted operations of update, apply and solve together");
  const auto bytes = [](const Cell& c) { return static_cast<double>(c.bytes); };
  return s + figure(plot("p-bytes", "memory against links", "links", "memory [bytes]", series(r, bytes)),
                    "memory held by the operator");
}

std::string ladder_table(const Results& r) {
  std::string s = "<details><summary>The numbers of the plots</summary>";
  for (const Rung& rung : r.ladder) {
    s += "<div class=\"wide\"><table><caption>" + std::to_string(rung.links) + " links: " + std::to_string(rung.dofs) +
         " dofs, " + std::to_string(rung.rows) + " rows; kinematics and rows " + three_digits(rung.kinematics.lowest) +
         " µs</caption>" + cell_head + "<tbody>";
    for (const Cell& c : rung.cells)
      s += c.skipped.empty() ? cell_row(c)
                             : "<tr><td>" + escape(c.op) + "</td><td class=\"text soft\" colspan=\"11\">" + escape(c.skipped) + "</td></tr>";
    s += "</tbody></table></div>";
  }
  return s + "</details>";
}

/// Every distinct reason why an operator is missing from the upper part of the ladder.
std::string left_out(const Results& r) {
  std::set<std::string> seen;
  std::string s;
  for (const Rung& rung : r.ladder)
    for (const Cell& c : rung.cells)
      if (!c.skipped.empty() && seen.insert(c.op).second) s += "<li>" + escape(c.op + ": " + c.skipped) + "</li>";
  return s.empty() ? "" : "<ul class=\"small\">" + s + "</ul>";
}

}  // namespace

std::string ladder_section(const Results& r) {
  if (r.ladder.empty()) return "";
  std::string s = "<h2 id=\"size\">Cost against size</h2><p>Swimmers: a chain of N links in the plane, two ground contacts "
    "per link, so N + 2 degrees of freedom and 6N rows. Both axes are logarithmic; cost proportional to size has slope 1."
    "</p>" + left_out(r);
  const std::string figures = plots(r);
  s += figures.empty() ? "<p class=\"soft\">gnuplot was not found, so the plots are left out; the table holds their numbers.</p>"
                       : "<div class=\"grid\">" + figures + "</div>";
  return s + ladder_table(r);
}

std::string scenes_section(const Results& r) {
  std::string s = "<h2 id=\"scenes\">Scenes</h2><p>Each picture shows the configuration that was computed. Operations are "
    "additions, multiplications, divisions and square roots, counted by running the same code with a counting number type; "
    "<em>analyze</em> is done once per mechanism.</p>" + drawing_legend();
  for (const SceneResult& scene : r.scenes) s += scene_article(scene);
  return s;
}

}  // namespace delassus::bench
