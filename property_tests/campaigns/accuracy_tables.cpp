#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "property_tests/campaigns/accuracy_ladder.h"

namespace delassus::laws {
namespace {

using Error = double Errors::*;
/// Answers of one rung.
using Answers = std::vector<const Answered*>;

/// Those of rung k at one level, or at all (level = number of levels).
Answers answers_of(const Campaign& c, std::size_t k, std::size_t level) {
  Answers all;
  for (const LadderCell& cell : c.cells)
    if (level == std::size(levels) || cell.level == level) all.push_back(&cell.answers[k]);
  return all;
}

int share(const Answers& all, Error error, double most) {
  const auto count = std::count_if(all.begin(), all.end(), [&](const Answered* x) { return within(*x, error, most); });
  return all.empty() ? 0 : static_cast<int>(100 * count / static_cast<std::ptrdiff_t>(all.size()));
}

double worst(const Answers& all, Error error) {
  double most = 0;
  for (const Answered* x : all)
    if (within(*x, error, HUGE_VAL)) most = std::max(most, x->errors.*error);
  return most;
}

/// The power of ten above.
std::string power(double x) {
  char text[16];
  std::snprintf(text, sizeof text, "1e%d", static_cast<int>(std::ceil(std::log10(x))));
  return x > 0 ? text : "0";
}

/// Answers by status.
struct Count {
  int ok = 0, not_converged = 0, refused = 0;
  int wrong = 0;   ///< ok, and motion off by more than 1e-6
};
Count count(const Answers& all) {
  Count c;
  for (const Answered* x : all) {
    const bool ok = x->report.ok(), not_converged = x->report.status == Status::not_converged;
    c.ok += ok;
    c.not_converged += not_converged;
    c.refused += !ok && !not_converged;
    c.wrong += ok && !within(*x, &Errors::motion, 1e-6);
  }
  return c;
}

std::string shares(const Answers& all, Error error) {
  return std::to_string(share(all, error, 1e-6)) + " / " + std::to_string(share(all, error, 1e-10)) + " %";
}

void print_summary(const Campaign& c) {
  std::cout << "| rung | motion | worst | λ | worst | backward ≤ 1e-12 | ok | not_converged | refused | ok, motion off by > 1e-6 |\n"
               "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (std::size_t k = 0; k < c.rungs.size(); ++k) {
    const Answers all = answers_of(c, k, std::size(levels));
    const Count n = count(all);
    std::cout << "| `" << c.rungs[k]->name << "` | " << shares(all, &Errors::motion) << " | " << power(worst(all, &Errors::motion)) << " | "
              << shares(all, &Errors::force) << " | " << power(worst(all, &Errors::force)) << " | " << share(all, &Errors::backward, 1e-12)
              << " % | " << n.ok << " | " << n.not_converged << " | " << n.refused << " | " << n.wrong << " |\n";
  }
}

/// Heads a table whose columns are the levels.
void head(const char* first, const char* rule) {
  std::cout << "| " << first << " |";
  for (const Level& l : levels) std::cout << ' ' << l.name << " |";
  std::cout << "\n|" << rule;
  for (std::size_t l = 0; l < std::size(levels); ++l) std::cout << "---|";
}

/// Rung × R λmax: what `text` makes of the answers.
template <class Text> void print_levels(const Campaign& c, Text text) {
  head("rung", "---|");
  for (std::size_t k = 0; k < c.rungs.size(); ++k) {
    std::cout << "\n| `" << c.rungs[k]->name << "` |";
    for (std::size_t l = 0; l < std::size(levels); ++l) std::cout << ' ' << text(answers_of(c, k, l)) << " |";
  }
  std::cout << '\n';
}

/// Mechanism × R λmax: the judged rung's motion and force errors; its status unless ok; who answered unless the first.
void print_mechanisms(const Campaign& c) {
  head("mechanism | what", "---|---|");
  for (const LadderCell& cell : c.cells) {
    const Mechanism& m = mechanisms()[cell.mechanism];
    const Answered& x = cell.answers[c.judged];
    if (cell.level == 0) std::cout << "\n| `" << m.family << "` n=" << m.n << " | " << m.what << " |";
    std::cout << ' ' << power(x.errors.motion) << ' ' << power(x.errors.force);
    if (!x.report.rung.empty() && x.report.rung != "lcaba_refined") std::cout << ' ' << x.report.rung;
    if (!x.report.ok()) std::cout << ' ' << name(x.report.status);
    std::cout << " |";
  }
  std::cout << '\n';
}

}  // namespace

void print_tables(const Campaign& campaign) {
  std::cout << "## All problems\n";
  print_summary(campaign);
  std::cout << "\n## Motion, by R λmax\n";
  print_levels(campaign, [](const Answers& all) { return shares(all, &Errors::motion) + ", " + power(worst(all, &Errors::motion)); });
  std::cout << "\n## λ, by R λmax\n";
  print_levels(campaign, [](const Answers& all) { return shares(all, &Errors::force) + ", " + power(worst(all, &Errors::force)); });
  std::cout << "\n## ok / not_converged / refused, by R λmax\n";
  print_levels(campaign, [](const Answers& all) {
    const Count n = count(all);
    return std::to_string(n.ok) + " / " + std::to_string(n.not_converged) + " / " + std::to_string(n.refused);
  });
  std::cout << "\n## The default on every problem: motion, λ\n";
  print_mechanisms(campaign);
}

}  // namespace delassus::laws
