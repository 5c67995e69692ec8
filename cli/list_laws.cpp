#include "cli/list_laws.h"

#include <algorithm>
#include <cstdio>

#include "bench/text.h"
#include "property_tests/laws/law_tables.h"

namespace delassus::cli {

namespace {

/// Reasons in the order they are met; the letter of one is its place.
class Legend {
 public:
  /// ✓, or the letter of the reason.
  std::string mark(const json& applies) {
    if (applies.is_boolean()) return "✓";
    const std::string reason = applies;
    auto at = std::find(reasons_.begin(), reasons_.end(), reason);
    if (at == reasons_.end()) at = reasons_.insert(at, reason);
    return std::string(1, static_cast<char>('a' + (at - reasons_.begin())));
  }
  void print(const char* before) const {
    for (std::size_t k = 0; k < reasons_.size(); ++k)
      std::printf("%s%c  %s", before, static_cast<char>('a' + k), reasons_[k].c_str());
    std::printf("\n");
  }

 private:
  std::vector<std::string> reasons_;
};

std::vector<std::string> marks(const json& law, Legend& legend) {
  std::vector<std::string> out;
  for (const OperatorRow& op : operators()) out.push_back(legend.mark(law["operators"][std::string(op.name)]));
  return out;
}

}  // namespace

json laws_json() {
  const auto why_not = laws::what_applies();
  json out = json::array();
  for (std::size_t k = 0; k < laws::laws().size(); ++k) {
    const laws::LawRow& law = laws::laws()[k];
    json applies;
    for (std::size_t o = 0; o < operators().size(); ++o)
      applies[std::string(operators()[o].name)] = why_not[k][o] ? json(why_not[k][o]) : json(true);
    out.push_back({{"name", law.name}, {"summary", law.identity}, {"bound", law.bound}, {"operators", applies}});
  }
  return out;
}

void print_applies(const json& laws) {
  std::size_t width = 0, number = 0;
  for (const json& law : laws) width = std::max(width, law["name"].get<std::string>().size());
  std::printf("\nwhat applies to what:\n");
  for (const OperatorRow& op : operators()) std::printf("  %2zu  %s\n", ++number, std::string(op.name).c_str());
  std::printf("\n  %s", bench::pad_right("", width).c_str());
  for (std::size_t k = 1; k <= number; ++k) std::printf(" %2zu", k);
  std::printf("\n");
  Legend legend;
  for (const json& law : laws) {
    std::printf("  %s", bench::pad_right(law["name"], width).c_str());
    for (const std::string& mark : marks(law, legend)) std::printf("  %s", mark.c_str());
    std::printf("\n");
  }
  std::printf("\n  ✓  applies");
  legend.print("\n  ");
}

void print_applies_markdown(const json& laws) {
  std::vector<std::pair<std::vector<std::string>, std::string>> lines;  // marks, laws
  Legend legend;
  for (const json& law : laws) {
    const auto line = marks(law, legend);
    auto at = std::find_if(lines.begin(), lines.end(), [&](const auto& l) { return l.first == line; });
    if (at == lines.end()) at = lines.insert(at, {line, ""});
    at->second += (at->second.empty() ? "`" : ", `") + law["name"].get<std::string>() + "`";
  }
  std::printf("\n");
  for (const OperatorRow& op : operators()) std::printf("| `%s` ", std::string(op.name).c_str());
  std::printf("| laws |\n");
  for (std::size_t k = 0; k < operators().size(); ++k) std::printf("|---");
  std::printf("|---|\n");
  for (const auto& [line, names] : lines) {
    for (const std::string& mark : line) std::printf("| %s ", mark.c_str());
    std::printf("| %s |\n", names.c_str());
  }
  std::printf("\n✓ applies");
  legend.print("; ");
}

}  // namespace delassus::cli
