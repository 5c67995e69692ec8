#include <algorithm>
#include <cmath>
#include <map>

#include "bench/peers/peer_table.h"
#include "bench/text.h"

namespace delassus::bench {

namespace {

using Cells = std::vector<std::vector<std::string>>;

std::string title(std::size_t k) {
  std::string s = name(step(k));
  std::replace(s.begin(), s.end(), '_', ' ');
  return s;
}
bool is_product(std::size_t k) { return step(k) == Step::first_product || step(k) == Step::product; }
/// What a step of a peer is held against; kinematics: any of ours.
std::string counterpart(const PeerEntry& peer, std::size_t k, bool certified) {
  if (step(k) == Step::kinematics) return certified_default;
  if (is_product(k)) return certified ? "" : peer.product;
  return certified && !peer.solve.empty() ? certified_default : peer.solve;
}

/// Ratios of one peer and step over the scenes.
struct Ratios {
  std::vector<std::pair<double, std::string>> of;  ///< with the scene

  [[nodiscard]] std::string text() const {
    if (of.empty()) return "–";
    double sum = 0;
    for (const auto& [ratio, scene] : of) sum += std::log(ratio);
    const auto [least, most] = std::minmax_element(of.begin(), of.end());
    return three_digits(std::exp(sum / static_cast<double>(of.size()))) + " (" + three_digits(least->first) + " … " + three_digits(most->first) + ")";
  }
};
Ratios ratios(const PeerTable& t, const std::string& peer, std::size_t k, bool certified) {
  Ratios r;
  for (const PeerScene& s : t.scenes)
    if (const PeerEntry* e = s.find(peer))
      if (const double x = s.ratio(*e, step(k), counterpart(*e, k, certified)); !std::isnan(x)) r.of.emplace_back(x, s.scene);
  return r;
}

std::string ratio_table(const PeerTable& t) {
  Cells cells{{"peer", "ours"}};
  for (std::size_t k = 0; k < step_count; ++k) cells[0].push_back(title(k));
  for (const PeerEntry& e : from_outside(t))
    for (const bool certified : {false, true}) {
      if (certified && (e.solve.empty() || e.solve == certified_default)) continue;
      std::vector<std::string> line{e.name, certified ? certified_default : e.solve.empty() || e.solve == e.product ? e.product : e.product + ", " + e.solve};
      for (std::size_t k = 0; k < step_count; ++k) line.push_back(certified && step(k) == Step::kinematics ? "–" : ratios(t, e.name, k, certified).text());
      cells.push_back(line);
    }
  return "### Time of the peer over ours\nGeometric mean over the scenes, in brackets the least and the largest. Above 1: ours is faster. `" + std::string(certified_default) +
         "` answers with a rigorous error bound, no peer does.\n\n" + markdown_table(cells, 2);
}

/// Where a peer is faster than its counterpart of the same algorithm, cell by cell.
std::string wins_text(const PeerTable& t) {
  std::string s = "### Where the peer is faster\n";
  for (const PeerEntry& e : from_outside(t))
    for (const bool certified : {false, true}) {
      if (certified && (e.solve.empty() || e.solve == certified_default)) continue;
      std::string where;
      int won = 0, cells = 0;
      for (std::size_t k = 0; k < step_count; ++k) {
        if (certified && step(k) == Step::kinematics) continue;
        std::string of_step;
        for (const auto& [ratio, scene] : ratios(t, e.name, k, certified).of) {
          ++cells;
          if (ratio >= 1) continue;
          ++won;
          of_step += (of_step.empty() ? "" : ", ") + scene + " " + three_digits(ratio);
        }
        if (!of_step.empty()) where += (where.empty() ? "" : "; ") + title(k) + ": " + of_step;
      }
      if (cells == 0) continue;
      s += "- `" + e.name + "` against " + (certified ? "`" + std::string(certified_default) + "`" : "the same algorithm of ours") + format(": %d of %d cells", won, cells) + (where.empty() ? "" : ". " + where) + ".\n";
    }
  return s;
}

std::string scene_table(const PeerScene& s) {
  Cells cells{{""}};
  for (std::size_t k = 0; k < step_count; ++k) cells[0].push_back(title(k));
  cells[0].insert(cells[0].end(), {"M", "a", "λ"});
  for (const PeerEntry& e : s.entries) {
    if (!e.cannot.empty() || !e.disagrees.empty()) continue;
    std::vector<std::string> line{e.name + (e.from_q ? " *" : "")};
    for (std::size_t k = 0; k < step_count; ++k) line.push_back(three_digits(e.time[k].median));
    for (const double error : {e.M_error, e.product_error, e.force_error}) line.push_back(rough_digit(error));
    cells.push_back(line);
  }
  std::string out = "#### " + s.scene + format(": %lld degrees of freedom, %lld rows, R⁻¹ = %g", static_cast<long long>(s.dofs), static_cast<long long>(s.rows), s.smallest_damping) +
                    (s.smallest_damping == s.largest_damping ? "" : format(" … %g", s.largest_damping)) +
                    format("; errors up to %.0e of a, %.0e of λ are taken for rounding\n", s.product_limit, s.force_limit) + markdown_table(cells);
  for (const PeerEntry& e : s.entries)
    if (!e.disagrees.empty()) out += "\n**`" + e.name + "` was not timed**, " + (e.loses_digits ? "it loses too many digits here: " : "its answers are not near enough: ") + e.disagrees + ".\n";
  return out;
}

/// By peer and reason, which names the element first.
std::string left_out(const PeerTable& t) {
  std::map<std::string, std::vector<std::string>> scenes;
  for (const PeerScene& scene : t.scenes)
    for (const PeerEntry& e : scene.entries)
      if (!e.cannot.empty()) scenes["`" + e.name + "`: " + e.cannot.substr(std::min(e.cannot.find(": ") + 2, e.cannot.size()))].push_back(scene.scene);
  std::string s;
  for (const auto& [why, of] : scenes) {
    s += "- ";
    for (const std::string& scene : of) s += (&scene == &of.front() ? "" : ", ") + scene;
    s += ", " + why + "\n";
  }
  return s.empty() ? s : "\n### Left out\n" + s;
}

std::string spread_line(const PeerTable& t) {
  std::vector<double> wide;
  for (const PeerScene& s : t.scenes)
    for (const PeerEntry& e : s.entries)
      for (const Spread& x : e.time)
        if (x.measured()) wide.push_back((x.high - x.low) / x.median);
  if (wide.empty()) return "";
  std::sort(wide.begin(), wide.end());
  return format(" The distance of the quartiles is %.0f %% of the median in the middle, above %.0f %% in one cell of ten.", 100 * wide[wide.size() / 2], 100 * wide[wide.size() * 9 / 10]);
}

}  // namespace

std::string peer_text(const PeerTable& t) {
  std::string s = t.text() +
                  "Medians of up to 15 rounds, all of a scene in turn in one process, by the clock of the thread." + spread_line(t) + "\n";
  if (t.interrupted) s += "**Interrupted**: scenes are missing.\n";
  if (t.disagreements() > 0) s += format("**%d were not timed**: their answers are not those of the definition.\n", t.disagreements());
  for (const PeerEntry& e : from_outside(t)) s += "- `" + e.name + "`: " + e.program + ", " + e.what + "\n";
  s += "\n" + ratio_table(t) + "\n" + wins_text(t) + "\n### Scene by scene [µs], and relative errors\nM: |δM_ij|/√(M_ii M_jj); a: of the product; λ: of the largest force. *: its first steps begin at q, kinematics included; its ratios above count ours likewise. A first product of ours "
         "that keeps a matrix is without the factor of A.\n";
  for (const PeerScene& scene : t.scenes) s += "\n" + scene_table(scene);
  return s + left_out(t);
}

}  // namespace delassus::bench
