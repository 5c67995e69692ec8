// Small helpers of the loaders: reading numbers strictly, writing them with all their digits, shortening names.
#pragma once

#include <charconv>
#include <cmath>
#include <limits>
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

/// The shortest decimal number that reads back as the same double.
[[nodiscard]] inline std::string number_text(double x) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, x);
  return {buffer, result.ptr};
}

/// The numbers of a vector, separated by blanks.
template <class V> [[nodiscard]] std::string numbers_text(const V& v) {
  std::string out;
  for (const double x : v) out += (out.empty() ? "" : " ") + number_text(x);
  return out;
}

/// A finite decimal number filling the whole text (blanks around it allowed); no value otherwise. The locale is ignored.
/// Numbers below the range of double are 0, those above it have no value.
[[nodiscard]] inline std::optional<double> finite_number(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return std::nullopt;
  text = text.substr(first, text.find_last_not_of(blanks) - first + 1);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {  // too large or too small: the wider type tells
    long double wide = 0;
    const auto wider = std::from_chars(text.data(), text.data() + text.size(), wide);
    if (wider.ec == std::errc() && std::abs(wide) < 1) return std::signbit(wide) ? -0.0 : 0.0;
    return std::nullopt;
  }
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace delassus
