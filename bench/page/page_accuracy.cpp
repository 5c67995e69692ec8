// Section of the page: accuracy against time.
#include "bench/accuracy/accuracy_digest.h"
#include "bench/page/page.h"
#include "bench/text.h"

namespace delassus::bench {

std::string accuracy_section(const Results& r) {
  const AccuracyResult& a = r.accuracy;
  if (a.overview.empty() && a.digits.size() < 2) return "";
  std::string s = "<h2 id=\"accuracy\">Accuracy against time</h2><p>Left is accurate, low is cheap. One line per rung: the worst "
    "error of the motion over the scenes, ‖δν‖/‖ν‖ in the norm of M against an answer in 113 bits, at R⁻¹ ≤ 1e-10 (ringed), ≤ 1e-6 "
    "and ≤ 1e-2; the time of update and solve relative to <code>lcaba</code>, the paper's formula. At the right edge: no digit, or no "
    "answer.</p>";
  s += a.overview.empty() ? "<p class=\"soft\">gnuplot was not found, so the picture is left out.</p>"
                          : "<figure style=\"max-width:620px\">" + a.overview + "</figure>";
  if (a.digits.size() > 1)
    s += "<details><summary>Digits kept on " + std::to_string(a.digits.size() - 1) + " families, motion/λ</summary><p class=\"small\">* not converged, and it says so; a word: why there "
         "is no answer.</p>" + accuracy::html(a.digits, "Digits kept") + "</details>";
  if (!a.left_out.empty()) {
    s += "<details class=\"small\"><summary>Left out</summary><ul>";
    for (const std::string& line : a.left_out) s += "<li>" + escape(line) + "</li>";
    s += "</ul></details>";
  }
  return s;
}

}  // namespace delassus::bench
