// The name that was probably meant: an end for messages about names that do not exist.
#pragma once

#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

namespace delassus {

/// Least number of letters inserted, left out, exchanged or swapped with their neighbour that turns a into b. O(|a| |b|).
[[nodiscard]] inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    next[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      next[j] = std::min({row[j] + 1, next[j - 1] + 1, row[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) next[j] = std::min(next[j], before[j - 2] + 1);
    }
    before = row;
    row = next;
  }
  return row[b.size()];
}

/// `did you mean X? ` for the nearest of the names (any range of text) when at most a third of its letters differ; else
/// nothing. Names and texts beyond 200 letters are not compared.
template <class Names> [[nodiscard]] std::string did_you_mean(std::string_view text, const Names& names) {
  std::string best;
  std::size_t least = text.size();
  if (text.size() <= 200)
    for (const auto& name : names) {
      const std::string_view candidate(name);
      if (candidate.size() > 200) continue;
      const std::size_t d = edit_distance(text, candidate);
      if (3 * d <= std::max(text.size(), candidate.size()) && d < least) least = d, best = candidate;
    }
  return best.empty() ? "" : "did you mean " + best + "? ";
}

/// All the names, after the one that was probably meant; `rows` have a `name`.
template <class Rows> [[nodiscard]] std::string accepted_names(std::string_view text, const Rows& rows) {
  std::vector<std::string_view> names;
  std::string all;
  for (const auto& row : rows) {
    names.push_back(row.name);
    all.append(all.empty() ? "" : ", ").append(row.name);
  }
  return did_you_mean(text, names) + all;
}

}  // namespace delassus
