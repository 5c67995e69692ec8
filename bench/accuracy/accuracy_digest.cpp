#include "bench/accuracy/accuracy_digest.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/text.h"

namespace delassus::accuracy {

using bench::format;

namespace {

constexpr double rounding = 1 + 1e-6;  // of powers of ten

bool claimed(const Level& level) { return level.damping >= claimed_from / rounding && level.damping <= claimed_to * rounding; }

/// The error, infinite where there is no answer.
double counted(double error) { return std::isnan(error) ? HUGE_VAL : error; }

double worst_motion(const Table& table, std::string_view rung) {
  double worst = -1;
  for (const Level& level : table.levels)
    if (const Cell* c = level.find(rung); c && claimed(level)) worst = std::max(worst, counted(c->errors.motion));
  return worst < 0 ? std::nan("") : worst;
}

double median(std::vector<double> x) {
  if (x.empty()) return std::nan("");
  std::sort(x.begin(), x.end());
  return x[x.size() / 2];
}

std::string error_text(double e) { return std::isnan(e) ? "–" : std::isinf(e) ? "no answer" : format("%.0e", e); }
std::string ratio(double x) { return std::isnan(x) ? "–" : bench::three_digits(x); }

std::string place(double away) { return away == 0 ? "origin" : format("%g km", away / 1000); }

/// `16/15`: digits of motion and λ; otherwise why there are none.
std::string digits_cell(const Cell& c) {
  if (std::isnan(c.errors.motion)) return c.status == "ok" ? "–" : c.status;
  std::string text = format("%.0f/%.0f", std::floor(digits(c.errors.motion)), std::floor(digits(c.errors.lambda)));
  return c.status == "ok" ? text : text + "*";
}

}  // namespace

double digits(double error) { return error == 0 ? 16 : std::clamp(-std::log10(error), 0.0, 16.0); }

std::vector<Claim> claims(const std::vector<Table>& tables, const std::string& rung) {
  std::vector<Claim> all;
  for (const Table& t : tables) {
    if (!t.is_scene) continue;
    Claim claim{t.name, rung, t.away, -1, -1, 0, 0, std::nan(""), 0, 0, worst_motion(t, fast_rung), worst_motion(t, world_rung)};
    for (const Level& level : t.levels) {
      const Cell* c = level.find(rung);
      if (!c || !claimed(level)) continue;
      ++claim.levels;
      claim.certificates += c->certificate_true();
      if (const double e = counted(c->errors.motion); e > claim.motion) claim.motion = e, claim.motion_damping = level.damping;
      if (const double e = counted(c->errors.lambda); e > claim.lambda)
        claim.lambda = e, claim.lambda_damping = level.damping, claim.condition = level.condition;
    }
    if (claim.levels > 0) all.push_back(claim);
  }
  return all;
}

std::vector<Cost> costs(const std::vector<Table>& tables) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<double>> times, operations;
  std::map<std::string, int> points;
  for (const Table& t : tables)
    for (const Level& level : t.levels) {
      const Cell* fast = level.find(fast_rung);
      if (!fast || !claimed(level)) continue;
      for (const Cell& c : level.cells) {
        if (std::find(order.begin(), order.end(), c.rung) == order.end()) order.push_back(c.rung);
        ++points[c.rung];
        if (c.time > 0 && fast->time > 0) times[c.rung].push_back(c.time / fast->time);
        if (c.operations > 0 && fast->operations > 0)
          operations[c.rung].push_back(static_cast<double>(c.operations) / static_cast<double>(fast->operations));
      }
    }
  std::vector<Cost> all;
  for (const std::string& rung : order)
    if (!times[rung].empty())
      all.push_back({rung, median(times[rung]), median(operations[rung]), points[rung], static_cast<int>(times[rung].size()),
                     static_cast<int>(operations[rung].size())});
  return all;
}

Grid claims_grid(const std::vector<Claim>& claims) {
  Grid grid{{"scene", "rung", "place", "motion error", "at R⁻¹", "certificate", "λ error", "at R⁻¹", "κ(A) there", "`lcaba`: motion",
             "`lcaba` about the world's origin", "holds"}};
  for (const Claim& c : claims)
    grid.push_back({c.scene, c.rung, place(c.away), error_text(c.motion), format("%g", c.motion_damping),
                    format("%d of %d true", c.certificates, c.levels), error_text(c.lambda), format("%g", c.lambda_damping),
                    error_text(c.condition), error_text(c.fast), error_text(c.world), c.holds() ? "yes" : "**no**"});
  return grid;
}

Grid costs_grid(const std::vector<Cost>& costs) {
  Grid grid{{"rung", "time / time of `lcaba`", "operations / operations of `lcaba`", "timed, counted, of", "aim"}};
  for (const Cost& c : costs) {
    const double aim = c.rung == default_rung ? aimed_default : c.rung == "lcaba_qr" ? aimed_qr : std::nan("");
    const auto met = [&](double x) { return x < aim ? std::string("met") : std::string("missed"); };
    grid.push_back({c.rung, ratio(c.time), ratio(c.operations), format("%d, %d, %d", c.timed, c.counted, c.points),
                    std::isnan(aim) ? "" : format("%g: time %s, operations %s", aim, met(c.time).c_str(), met(c.operations).c_str())});
  }
  return grid;
}

Grid digits_grid(const std::vector<Table>& tables) {
  Grid grid{{"problem", "κ(A)"}};
  for (const Table& t : tables) {
    if (t.levels.empty()) continue;
    const Level& level = t.levels.front();
    if (grid.size() == 1)
      for (const Cell& c : level.cells)
        if (c.style >= 0) grid[0].push_back(c.rung);
    grid.push_back({t.name, error_text(level.condition)});
    for (std::size_t k = 2; k < grid[0].size(); ++k) {
      const Cell* c = level.find(grid[0][k]);
      grid.back().push_back(!c ? "–" : level.no_reference.empty() ? digits_cell(*c) : "?");
    }
  }
  return grid;
}

std::string markdown(const Grid& grid) {
  std::string s;
  for (std::size_t r = 0; r < grid.size(); ++r) {
    s += "|";
    for (const std::string& cell : grid[r]) s += " " + cell + " |";
    s += "\n";
    if (r > 0) continue;
    s += "|";
    for (std::size_t k = 0; k < grid[0].size(); ++k) s += k == 0 ? "---|" : "---:|";
    s += "\n";
  }
  return s;
}

std::string html(const Grid& grid, const std::string& caption) {
  std::string s = "<div class=\"wide\"><table><caption>" + bench::escape(caption) + "</caption>";
  for (std::size_t r = 0; r < grid.size(); ++r) {
    const char* const tag = r == 0 ? "th" : "td";
    s += r == 0 ? "<thead><tr>" : "<tr>";
    for (const std::string& cell : grid[r]) s += std::string("<") + tag + ">" + bench::escape(cell) + "</" + tag + ">";
    s += r == 0 ? "</tr></thead><tbody>" : "</tr>";
  }
  return s + "</tbody></table></div>";
}

}  // namespace delassus::accuracy
