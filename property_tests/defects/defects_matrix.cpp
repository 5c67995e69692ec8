#include "property_tests/defects/defects_matrix.h"

#include <algorithm>
#include <sstream>

namespace delassus::laws {
namespace {

constexpr std::string_view exact_prefix = "exact ", threads_suffix = " on two threads";
constexpr std::size_t none = ~std::size_t(0), name_width = 29, group = 10;

/// Laws that share a column: numbers in laws().
struct Column {
  std::string_view name;
  std::size_t rounded = none, exact = none;
};

const std::vector<Column>& columns() {
  static const std::vector<Column> all = [] {
    std::vector<Column> out;
    for (std::size_t k = 0; k < laws().size(); ++k) {
      const std::string_view law = laws()[k].name;
      if (law.ends_with(threads_suffix)) continue;
      const bool exact = law.starts_with(exact_prefix);
      const std::string_view name = exact ? law.substr(exact_prefix.size()) : law;
      auto at = std::find_if(out.begin(), out.end(), [&](const Column& c) { return c.name == name; });
      if (at == out.end()) at = out.insert(out.end(), {name});
      (exact ? at->exact : at->rounded) = k;
    }
    return out;
  }();
  return all;
}

char symbol(const Column& c, bool rounded, bool exact) {
  if (!rounded && !exact) return '.';
  if (c.exact == none || (rounded && exact)) return 'x';
  return exact ? 'e' : 'd';
}

bool caught(const std::vector<Entry>& entries, std::size_t law) { return law != none && entries[law].caught; }

/// The defect's line of the grid without its spaces: one symbol per column, and that of the threads.
std::string symbols(const std::vector<Entry>& entries) {
  std::string line;
  for (const Column& c : columns()) line += symbol(c, caught(entries, c.rounded), caught(entries, c.exact));
  bool by_threads = false;
  for (std::size_t k = 0; k < laws().size(); ++k) by_threads = by_threads || (laws()[k].name.ends_with(threads_suffix) && entries[k].caught);
  return line + (by_threads && line.find_first_not_of('.') == std::string::npos ? 'x' : '.');
}

std::string padded(std::string text, std::size_t width) { return text + std::string(width > text.size() ? width - text.size() : 0, ' '); }

std::string grouped(const std::string& symbols) {
  std::string out;
  for (std::size_t k = 0; k < symbols.size(); ++k) out += (k > 0 && k % group == 0 ? " " : "") + symbols.substr(k, 1);
  return out;
}

std::string grid(const DefectMatrix& m) {
  std::string out = padded("column", name_width);
  for (std::size_t k = 0; k < columns().size(); k += group) out += padded(std::to_string(k + 1), group + 1);
  for (std::size_t d = 0; d < m.defects.size(); ++d)
    if (!m.defects[d]->right()) out += "\n" + padded(std::string(m.defects[d]->name), name_width) + grouped(symbols(m.entries[d]));
  return out + "\n";
}

/// `| number | law |`, as the table of laws begins its lines.
std::string law_cell(std::size_t column) { return "| " + std::to_string(column + 1) + " | `" + std::string(columns()[column].name) + "` |"; }

std::string law_line(const DefectMatrix& m, std::size_t column) {
  const Column& c = columns()[column];
  int rounded = 0, exact = 0;
  std::string alone;
  for (std::size_t d = 0; d < m.defects.size(); ++d) {
    if (m.defects[d]->right()) continue;
    rounded += caught(m.entries[d], c.rounded);
    exact += caught(m.entries[d], c.exact);
    const std::string line = symbols(m.entries[d]);
    if (line[column] != '.' && std::count(line.begin(), line.end(), '.') == static_cast<std::ptrdiff_t>(columns().size()))
      alone += (alone.empty() ? "`" : ", `") + std::string(m.defects[d]->name) + "`";
  }
  return law_cell(column) + " " + (c.rounded == none ? "–" : std::to_string(rounded)) + " | " + (c.exact == none ? "–" : std::to_string(exact)) +
         " | " + alone + " |\n";
}

}  // namespace

std::vector<std::string_view> DefectMatrix::caught_by(std::size_t defect) const {
  std::vector<std::string_view> by;
  for (std::size_t k = 0; k < laws().size(); ++k)
    if (entries[defect][k].caught) by.push_back(laws()[k].name);
  return by;
}

std::string page(const DefectMatrix& matrix) {
  std::string out = "| column | law | catches | its exact twin | no other law catches |\n|---|---|---|---|---|\n";
  for (std::size_t c = 0; c < columns().size(); ++c) out += law_line(matrix, c);
  return out + "\n```\n" + grid(matrix) + "```\n";
}

std::vector<std::string> differences(const DefectMatrix& m, const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t c = 0; c < columns().size(); ++c)
    if (text.find("\n" + law_cell(c)) == std::string::npos) out.push_back("there is no line " + law_cell(c));
  for (std::size_t d = 0; d < m.defects.size(); ++d) {
    if (m.defects[d]->right()) continue;
    const std::string name(m.defects[d]->name), wanted = symbols(m.entries[d]);
    std::string found;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with(name + ' ')) found = line.substr(name.size());
    std::erase(found, ' ');
    if (found.size() != wanted.size()) out.push_back(name + ": no line of the grid, or one of another length");
    for (std::size_t c = 0; c < columns().size() && found.size() == wanted.size(); ++c) {
      const Column& column = columns()[c];
      const bool exact = caught(m.entries[d], column.exact), near = column.rounded != none && m.entries[d][column.rounded].near();
      if (found[c] != wanted[c] && !(near && (found[c] == symbol(column, true, exact) || found[c] == symbol(column, false, exact))))
        out.push_back(name + ": " + std::string(column.name) + " is '" + found[c] + "' on the page, '" + wanted[c] + "' here");
    }
    if (found.size() == wanted.size() && found.back() != wanted.back()) out.push_back(name + ": laws of two threads");
  }
  return out;
}

}  // namespace delassus::laws
