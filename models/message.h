// Small helpers of the loaders: reading numbers strictly, shortening names for messages.
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

namespace delassus {

/// The text in double quotes, cut to 60 characters with the full length stated; control characters become '?'.
[[nodiscard]] inline std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 60;
  std::string out = "\"";
  for (const char c : text.substr(0, longest)) out += (static_cast<unsigned char>(c) < 0x20 ? '?' : c);
  out += '"';
  if (text.size() > longest) out += "... (" + std::to_string(text.size()) + " characters)";
  return out;
}

/// A finite decimal number filling the whole text (blanks around it allowed); no value otherwise. The locale is ignored.
[[nodiscard]] inline std::optional<double> finite_number(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return std::nullopt;
  text = text.substr(first, text.find_last_not_of(blanks) - first + 1);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace delassus
