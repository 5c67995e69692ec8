#include "property_tests/laws/law_tables.h"

#include <algorithm>
#include <cstdio>
#include <ostream>
#include <stdexcept>

namespace delassus::laws {
namespace {

struct Pinned {
  const char* family;
  Index n;
};
constexpr Pinned pinned[] = {{"generic", 4}, {"generic", 5}, {"swimmer", 2}, {"several_trees", 4}, {"star", 2}, {"hard", 3}, {"no_rows", 2}};

using Reasons = std::vector<const char*>;  // one per problem; nullptr: the law applies

/// The reason met most often on `problems`.
const char* most_frequent(const Reasons& reasons, const std::vector<std::size_t>& problems) {
  std::map<std::string_view, int> counts;
  const char* most = nullptr;
  for (const std::size_t k : problems)
    if (const int count = ++counts[reasons[k]]; !most || count > counts[most]) most = reasons[k];
  return most;
}

/// Of the reasons on problems where the law applies to another operator, so that they are about this one; of all where
/// there are none.
const char* why_never(const Reasons& own, const std::vector<Reasons>& of_operators) {
  std::vector<std::size_t> telling, all;
  for (std::size_t k = 0; k < own.size(); ++k) {
    if (!own[k]) return nullptr;
    all.push_back(k);
    if (std::any_of(of_operators.begin(), of_operators.end(), [&](const Reasons& r) { return !r[k]; })) telling.push_back(k);
  }
  return most_frequent(own, telling.empty() ? all : telling);
}

std::string digits(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", x);
  return text;
}

}  // namespace

const char* why_not(const LawRow& law, const OperatorRow& op, const Case& c) {
  try {
    return law.why_not(op, c);
  } catch (const std::runtime_error&) {
    return "gives up, and says so";
  }
}

std::vector<std::vector<const char*>> what_applies() {
  std::vector<Case> cases;
  for (const Pinned& p : pinned) cases.push_back(make_case(p.family, p.n, 1));
  std::vector<std::vector<const char*>> table;
  for (const LawRow& law : laws()) {
    std::vector<Reasons> reasons;
    for (const OperatorRow& op : operators()) {
      Reasons& own = reasons.emplace_back();
      for (const Case& c : cases) own.push_back(why_not(law, op, c));
    }
    auto& row = table.emplace_back();
    for (const Reasons& own : reasons) row.push_back(why_never(own, reasons));
  }
  return table;
}

void Promises::add(std::string_view family, const OperatorRow& op, const char* why_not) {
  Count& count = counts_[{std::string(family), std::string(op.name)}];
  count.applies += why_not == nullptr;
  count.unpromised += why_not != nullptr && std::string_view(why_not).starts_with("promises no digit");
}

void Promises::print(std::ostream& out) const {
  // Operators and families that have an entry of a tenth or more.
  const auto missed = [&](const auto& is) {
    return std::any_of(counts_.begin(), counts_.end(), [&](const auto& at) { return is(at.first) && at.second.many(); });
  };
  std::vector<std::string> columns;
  for (const OperatorRow& op : operators())
    if (missed([&](const auto& key) { return key.second == op.name; })) columns.emplace_back(op.name);
  out << "| family |";
  for (const std::string& op : columns) out << " `" << op << "` |";
  out << "\n|---|";
  for (std::size_t k = 0; k < columns.size(); ++k) out << "---|";
  out << '\n';
  for (const generators::FamilyRow& family : generators::families()) {
    if (!missed([&](const auto& key) { return key.first == family.name; })) continue;
    out << "| `" << family.name << "` |";
    for (const std::string& op : columns) {
      const auto at = counts_.find({std::string(family.name), op});
      const Count c = at == counts_.end() ? Count{} : at->second;
      if (c.unpromised == 0) out << " – |";
      else out << ' ' << c.unpromised << " of " << c.applies + c.unpromised << " |";
    }
    out << '\n';
  }
  double most = 0;  // of the families without a line
  for (const auto& at : counts_)
    if (const Count& c = at.second; c.unpromised > 0 && !missed([&](const auto& other) { return other.first == at.first.first; }))
      most = std::max(most, 100.0 * c.unpromised / (c.applies + c.unpromised));
  out << "\nOf every other family at most " << digits(most) << " % for any operator.\n";
}

void Ratios::add(const Outcome& o) {
  const std::string bound(o.verdict.bound);
  if (o.skipped || !(bound.starts_with("apply_") || bound.starts_with("solve_"))) return;
  ratios_[{std::string(o.op), bound}].push_back(o.verdict.ratio);
}

void Ratios::print(std::ostream& out) const {
  out << "| operator | bound | checked | no error | median | 99 % | largest |\n|---|---|---|---|---|---|---|\n";
  for (const OperatorRow& op : operators())
    for (const auto& [key, all] : ratios_) {
      if (key.first != op.name) continue;
      std::vector<double> above = all;
      std::erase(above, 0);
      if (above.empty()) continue;
      std::sort(above.begin(), above.end());
      const auto at = [&](double part) { return digits(above[static_cast<std::size_t>(part * static_cast<double>(above.size() - 1))]); };
      const std::size_t none = 100 * (all.size() - above.size()) / all.size();
      out << "| `" << op.name << "` | " << key.second << " | " << all.size() << " | " << none << " % | " << at(0.5) << " | " << at(0.99)
          << " | " << at(1) << " |\n";
    }
}

}  // namespace delassus::laws
