#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/scaling/dissection.h"
#include "bench/machine.h"
#include "bench/page/plot.h"
#include "bench/scaling/scaling.h"
#include "bench/text.h"

namespace delassus::bench {

using nlohmann::json;

namespace {

using Table = std::vector<std::vector<std::string>>;

std::string whole(std::int64_t n) { return std::to_string(static_cast<long long>(n)); }

/// The last size an operator came to; nullptr: none.
const ScalingCell* last_cell(const ScalingLadder& l, std::size_t op, const ScalingSize** at = nullptr) {
  const ScalingCell* last = nullptr;
  for (const ScalingSize& size : l.sizes)
    if (size.cells[op].skipped.empty()) last = &size.cells[op], at ? *at = &size : nullptr;
  return last;
}

/// `2.00 (2)`: measured, and declared in brackets; `–` where there is no such phase or no work in it.
std::string order_text(const ScalingLadder& l, const ScalingCell& last, Asks what, bool regular) {
  const std::int64_t operations = last.operations[static_cast<std::size_t>(what)];
  if (operations < 0) return "–";
  if (operations == 0) return "no work";
  if (declared_orders(last.op)[static_cast<std::size_t>(what)].empty()) return "by the values";
  const Order order = order_of(l, last.op, what);
  if (std::isnan(order.measured)) return "too few sizes";
  const std::string declared = (regular ? format("%.0f", order.declared) : format("%.2f", order.declared)) + (order.logarithms == 0 ? "" : order.logarithms == 1 ? " log" : format(" log^%d", order.logarithms));
  return format("%s%.2f (%s)", order.agree() ? "" : "**≠** ", order.measured, declared.c_str());
}

std::string ladders_table(const Scaling& s) {
  Table rows{{"ladder", "s", "fixed", "what for", "s up to", "bodies", "n", "m"}};
  for (const ScalingLadder& l : s.ladders) {
    const generators::LadderRow& is = generators::find_ladder(l.name);
    const ScalingSize& last = l.sizes.back();
    rows.push_back({"`" + l.name + "`", std::string(is.size), std::string(is.fixed), std::string(is.purpose), whole(last.s), whole(last.bodies), whole(last.dofs), whole(last.rows)});
  }
  return markdown_table(rows, 4);
}

std::string orders_table(const ScalingLadder& l) {
  const bool regular = !generators::find_ladder(l.name).powers.empty();
  Table rows{{"operator", "s up to"}};
  for (std::size_t k = 0; k < asks_count; ++k) rows[0].emplace_back(name(static_cast<Asks>(k)));
  rows[0].insert(rows[0].end(), {"operations of the first at s", "steps of a solve", "left out"});
  for (std::size_t i = 0; i < l.sizes.front().cells.size(); ++i) {
    const ScalingSize* size = nullptr;
    const ScalingCell* last = last_cell(l, i, &size);
    const ScalingCell &first = l.sizes.front().cells[i], &end = l.sizes.back().cells[i];
    if (!last) continue;
    std::vector<std::string> row{"`" + last->op + "`", whole(size->s)};
    for (std::size_t k = 0; k < asks_count; ++k) row.push_back(order_text(l, *last, static_cast<Asks>(k), regular));
    const std::int64_t once = last->operations[static_cast<std::size_t>(last->operations[0] >= 0 ? Asks::product : Asks::first_solve)];
    row.push_back(short_count(once));
    row.push_back(last->whole < 0 || (first.steps == 0 && last->steps == 0) ? "" : whole(first.steps) + " → " + whole(last->steps) + (last->status == "ok" ? "" : " " + last->status));
    row.push_back(end.skipped);
    rows.push_back(row);
  }
  return markdown_table(rows);
}

bool keeps_matrix(const std::string& op) { return find_operator(op).holds != Holds::sparse; }

/// What a phase takes with as many steps as it needs; NAN: has none, or no answer.
double whole_cost(const ScalingCell& c, Asks what) {
  const auto of = [&](Asks phase) { return static_cast<double>(c.operations[static_cast<std::size_t>(phase)]); };
  const bool solves = what == Asks::solve || what == Asks::first_solve;
  if (!c.skipped.empty() || of(what) <= 0 || (solves && c.status != "ok")) return NAN;
  return of(what) + (solves ? static_cast<double>(c.whole) - of(Asks::solve) : 0);
}

/// The fewest operations of a phase at a size, of rows that keep a matrix or of those that do not; nullptr: none has it.
const ScalingCell* cheapest(const ScalingSize& size, Asks what, bool explicit_rows) {
  const ScalingCell* best = nullptr;
  for (const ScalingCell& c : size.cells)
    if (keeps_matrix(c.op) == explicit_rows && !std::isnan(whole_cost(c, what)) && (!best || whole_cost(c, what) < whole_cost(*best, what))) best = &c;
  return best;
}

/// From which number of answers at one configuration on the cheapest explicit row needs fewer operations than every other.
std::string answers(const ScalingSize& size, Asks first, Asks again) {
  const auto least = [&](bool explicit_rows, double times) {
    double cost = INFINITY;
    for (const ScalingCell& c : size.cells)
      if (keeps_matrix(c.op) == explicit_rows && !std::isnan(whole_cost(c, first))) cost = std::min(cost, whole_cost(c, first) + (times - 1) * whole_cost(c, again));
    return cost;
  };
  const auto pays = [&](double times) { return least(true, times) < least(false, times); };
  double none = 0, some = 1;
  while (!pays(some)) {
    none = some, some *= 2;
    if (some > 1e9) return "never";
  }
  while (some - none > 1) (pays(std::floor((none + some) / 2)) ? some : none) = std::floor((none + some) / 2);
  return format("%.0f", some);
}

/// The same at every doubling where explicit rows are within the budget; what does not change any more is said once.
std::string all_answers(const ScalingLadder& l, Asks first, Asks again) {
  std::vector<std::pair<std::string, std::int64_t>> all;
  for (const ScalingSize& size : l.sizes)
    if ((size.s & (size.s - 1)) == 0 && cheapest(size, first, true)) all.emplace_back(answers(size, first, again), size.s);
  std::string text;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool last = std::all_of(all.begin() + static_cast<std::ptrdiff_t>(i), all.end(), [&](const auto& a) { return a.first == all[i].first; });
    text += (text.empty() ? "" : ", ") + all[i].first + (last && i + 1 < all.size() ? " from " : " at ") + whole(all[i].second);
    if (last) break;
  }
  return text.empty() ? "–" : text;
}

/// On which side the cheaper row is, and from which size on: `**explicit** from 4 (kjr); free from 8 (cg)`.
std::string sides(const ScalingLadder& l, Asks what) {
  std::string text;
  int before = -1;
  for (const ScalingSize& size : l.sizes) {
    const ScalingCell *dense = cheapest(size, what, true), *free = cheapest(size, what, false);
    if (!dense || !free) break;
    const int now = whole_cost(*dense, what) < whole_cost(*free, what);
    if (now != before) text += (text.empty() ? "" : "; ") + std::string(now ? "**explicit**" : "free") + " from " + whole(size.s) + " (`" + (now ? dense : free)->op + "`)";
    before = now;
  }
  return text.empty() ? "–" : text;
}

std::string crossovers_table(const Scaling& s) {
  Table rows{{"ladder", "first product", "product again", "first solve", "solve again", "products from which explicit pays, at s", "solves, at s"}};
  for (const ScalingLadder& l : s.ladders) {
    rows.push_back({"`" + l.name + "`", sides(l, Asks::product), sides(l, Asks::apply), sides(l, Asks::first_solve), sides(l, Asks::solve), all_answers(l, Asks::product, Asks::apply), all_answers(l, Asks::first_solve, Asks::solve)});
  }
  return markdown_table(rows, 7);
}

int count_disagreements(const Scaling& s, int& held) {
  int off = 0;
  for (const ScalingLadder& l : s.ladders)
    for (const ScalingCell& c : l.sizes.front().cells)
      for (std::size_t k = 0; k < asks_count; ++k)
        if (const Order order = order_of(l, c.op, static_cast<Asks>(k)); !std::isnan(order.declared) && !std::isnan(order.measured)) ++held, off += !order.agree();
  return off;
}

}  // namespace

std::string scaling_text(const Scaling& s) {
  int held = 0;
  const int off = count_disagreements(s, held);
  std::string text = format("Counted operations; revision %s, %s. Budget: %.0e operations of a phase, %.1f GB. Orders held: %d, of which %d differ by more than 0.02.\n\n",
                            s.machine.revision.c_str(), s.machine.date.c_str(), s.budget, 1e-9 * s.most_bytes, held, off);
  if (s.ladders.empty() || s.ladders.front().sizes.empty()) return text;
  text += "### The ladders\n" + ladders_table(s) + "\n### Crossovers, by counted operations\n" + crossovers_table(s);
  for (const ScalingLadder& l : s.ladders)
    if (!l.sizes.empty()) text += "\n### " + l.name + ": measured order (declared)\n" + orders_table(l) + dissection_table(l);
  return text;
}

std::string scaling_picture(const Scaling& s, const std::string& ladder, Asks what) {
  std::vector<Series> series;
  for (const ScalingLadder& l : s.ladders)
    if (l.name == ladder && !l.sizes.empty())
      for (std::size_t i = 0; i < l.sizes.front().cells.size(); ++i) {
        Series& one = series.emplace_back(Series{l.sizes.front().cells[i].op, {}, static_cast<int>(i), false});
        for (const ScalingSize& size : l.sizes)
          if (const auto n = size.cells[i].operations[static_cast<std::size_t>(what)]; size.cells[i].skipped.empty() && n > 0) one.points.emplace_back(static_cast<double>(size.s), static_cast<double>(n));
      }
  if (series.empty()) return "";
  const std::string phase(name(what)), size(generators::find_ladder(ladder).size);
  return standalone(labelled_plot("ladder-" + ladder, phase + " of every operator on the ladder " + ladder, ladder + ": " + size, "operations, " + phase, series));
}

void to_json(json& j, const Scaling& s) {
  j = {{"machine", s.machine}, {"budget_operations", s.budget}, {"most_bytes", s.most_bytes}, {"ladders", json::array()}};
  for (const ScalingLadder& l : s.ladders) {
    json& ladder = j["ladders"].emplace_back(json{{"ladder", l.name}, {"sizes", json::array()}});
    for (const ScalingSize& z : l.sizes) {
      json& size = ladder["sizes"].emplace_back(json{{"s", z.s}, {"bodies", z.bodies}, {"dof", z.dofs}, {"rows", z.rows}, {"terms", z.terms}, {"operators", json::array()}});
      for (const ScalingCell& c : z.cells) {
        json one = {{"operator", c.op}};
        if (!c.skipped.empty()) one["skipped"] = c.skipped;
        else one.update({{"operations", c.operations}, {"whole_solve", c.whole}, {"bytes", c.bytes}, {"steps", c.steps}, {"status", c.status}});
        size["operators"].push_back(one);
      }
    }
  }
}

void from_json(const json& j, Scaling& s) {
  s = {j.at("machine"), j.at("budget_operations"), j.at("most_bytes"), {}};
  for (const json& l : j.at("ladders")) {
    ScalingLadder& ladder = s.ladders.emplace_back(ScalingLadder{l.at("ladder"), {}});
    for (const json& z : l.at("sizes")) {
      ScalingSize& size = ladder.sizes.emplace_back(ScalingSize{z.at("s"), z.at("bodies"), z.at("dof"), z.at("rows"), z.at("terms"), {}});
      size.terms.resize(static_cast<std::size_t>(Term::count));
      for (const json& c : z.at("operators")) {
        ScalingCell& cell = size.cells.emplace_back();
        cell.op = c.at("operator");
        cell.skipped = c.value("skipped", "");
        if (!cell.skipped.empty()) continue;
        cell.operations = c.at("operations");
        cell.whole = c.at("whole_solve"), cell.bytes = c.at("bytes"), cell.steps = c.at("steps"), cell.status = c.at("status");
      }
    }
  }
}

}  // namespace delassus::bench
