// What messages are made of: numbers read strictly and written with all their digits, names shortened, and what to do about
// a text that is no number.
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

/// ` (line 7)`; "" where the line is not known.
[[nodiscard]] inline std::string in_line(int line) { return line > 0 ? " (line " + std::to_string(line) + ")" : ""; }

/// The shortest decimal number that reads back as the same double.
[[nodiscard]] inline std::string number_text(double x) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, x);
  return {buffer, result.ptr};
}

/// The numbers of a vector, separated by blanks.
template <class V> [[nodiscard]] std::string numbers_text(const V& v) {
  std::string out;
  for (const double x : v) out.append(out.empty() ? "" : " ").append(number_text(x));
  return out;
}

/// Less the blanks around it and a plus sign in front, which from_chars does not take.
[[nodiscard]] inline std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  text = text.substr(first, text.find_last_not_of(blanks) - first + 1);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  return text;
}

/// A finite decimal number filling the whole text (blanks around it allowed); no value otherwise. The locale is ignored.
/// Numbers below the range of double are 0, those above it have no value.
[[nodiscard]] inline std::optional<double> finite_number(std::string_view text) {
  text = without_blanks(text);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || end != text.data() + text.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {  // too large or too small: the wider type tells
    long double wide = 0;
    const auto wider = std::from_chars(text.data(), text.data() + text.size(), wide);
    if (wider.ec == std::errc() && std::abs(wide) < 1) return std::signbit(wide) ? -0.0 : 0.0;
    return std::nullopt;
  }
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Of a text that is no finite number: what is wrong with it, and what to do.
struct NotANumber {
  std::string problem, advice;
};
[[nodiscard]] inline NotANumber not_a_number(std::string_view text) {
  const auto holds = [&](std::string_view part) { return text.find(part) != std::string_view::npos; };
  if (holds("${") || holds("$(")) return {"is not expanded", "run xacro first"};
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) return {"holds no number", "write the number"};
  if (holds(",")) return {"is no number", "write a decimal point, and blanks between numbers"};
  if (text.find_first_of("0123456789") == std::string_view::npos) {
    if (holds("nan") || holds("NaN") || holds("NAN") || holds("inf") || holds("Inf") || holds("INF"))
      return {"is not finite", "write the number meant; nan and inf come from exports that failed"};
    return {"is no number", "write digits, such as -1.5e-3"};
  }
  const std::string_view number = without_blanks(text);
  double value = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error == std::errc::result_out_of_range && end == number.data() + number.size())
    return {"is beyond the range of double, 1.8e308", "check the exponent and the unit"};
  return {"is no number", "write the number alone, in the unit that is accepted"};
}

}  // namespace delassus
