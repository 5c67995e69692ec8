#include "property_tests/laws/summary.h"

#include <algorithm>
#include <iomanip>
#include <ostream>

namespace delassus::laws {

void Summary::add(const Outcome& o) {
  const std::pair key{std::string(o.op), std::string(o.law)};
  Cell& cell = cells_[key];
  if (o.skipped) {
    ++cell.skipped;
    ++reasons_[key][o.skipped];
    return;
  }
  ++checked_;
  ++cell.checked;
  if (cell.checked == 1 || o.verdict.ratio > cell.worst.ratio) {
    cell.worst = o.verdict;
    cell.where = o.label;
  }
  if (o.failed()) {
    ++cell.failed;
    failures_.push_back(o);
  }
}

void Summary::print(std::ostream& out, std::size_t most) const {
  std::string op;
  for (const auto& [key, cell] : cells_) {
    if (key.first != op) {
      op = key.first;
      out << '\n' << std::left << std::setw(36) << op << std::right << std::setw(9) << "checked" << std::setw(8)
          << "failed" << std::setw(9) << "skipped" << std::setw(13) << "worst ratio" << "  on\n";
    }
    out << "  " << std::left << std::setw(34) << key.second << std::right << std::setw(9) << cell.checked << std::setw(8)
        << cell.failed << std::setw(9) << cell.skipped;
    if (cell.checked > 0)
      out << std::setw(13) << std::setprecision(3) << cell.worst.ratio << "  " << cell.where;
    out << '\n';
    if (const auto at = reasons_.find(key); at != reasons_.end())
      for (const auto& [reason, count] : at->second) out << "      " << count << " skipped: " << reason << '\n';
  }
  out << '\n' << checked_ << " checked, " << failures_.size() << " failed\n";
  for (std::size_t k = 0; k < std::min(most, failures_.size()); ++k) laws::print(out, failures_[k]);
  if (failures_.size() > most) out << "… and " << failures_.size() - most << " more failures\n";
}

void print(std::ostream& out, const Outcome& o) {
  out << (o.skipped ? "skipped" : o.passed() ? "passed" : "FAILED") << "  " << o.op << "  " << o.law << "  [" << o.label << "]";
  if (o.skipped) out << "  " << o.skipped;
  else out << "  ratio " << o.verdict.ratio << " (" << o.verdict.bound << ")";
  if (!o.skipped && o.verdict.row >= 0) out << " row " << o.verdict.row;
  if (!o.verdict.note.empty()) out << "  " << o.verdict.note;
  out << '\n';
}

}  // namespace delassus::laws
