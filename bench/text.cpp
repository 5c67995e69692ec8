#include "bench/text.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <vector>

namespace delassus::bench {

std::string format(const char* pattern, ...) {
  std::va_list arguments, again;
  va_start(arguments, pattern);
  va_copy(again, arguments);
  const int size = std::vsnprintf(nullptr, 0, pattern, arguments);
  va_end(arguments);
  std::vector<char> buffer(static_cast<std::size_t>(size) + 1);
  std::vsnprintf(buffer.data(), buffer.size(), pattern, again);
  va_end(again);
  return std::string(buffer.data(), static_cast<std::size_t>(size));
}

std::string three_digits(double x) {
  if (std::isnan(x)) return "–";
  if (std::isinf(x)) return x > 0 ? "∞" : "−∞";
  if (x == 0) return "0";
  const int exponent = static_cast<int>(std::floor(std::log10(std::fabs(x))));
  if (exponent < -4) return format("%.1e", x);
  if (exponent <= 1) return format("%.*f", 2 - exponent, x);
  return format("%.0f", x);
}

std::string rough_digit(double x) { return std::isnan(x) ? "–" : format("%.0e", x); }

std::string ratio_text(double ratio) { return ratio > 0 && ratio < 0.001 ? "<0.001" : three_digits(ratio); }

namespace {

std::string with_prefix(std::int64_t n, const char* unit) {
  if (n < 0) return "–";
  if (n < 1000) return *unit ? format("%lld %s", static_cast<long long>(n), unit) : std::to_string(n);
  double x = static_cast<double>(n);
  const char* prefix = "kMGT";
  for (x /= 1000; x >= 999.5 && prefix[1]; ++prefix) x /= 1000;
  return three_digits(x) + " " + *prefix + unit;
}

std::size_t width_of(const std::string& s) {
  std::size_t n = 0;
  for (const char c : s) n += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  return n;
}

}  // namespace

std::string short_count(std::int64_t n) { return with_prefix(n, ""); }
std::string short_bytes(std::int64_t n) { return with_prefix(n, "B"); }

std::string escape(std::string_view s) {
  std::string out;
  for (const char c : s) {
    if (c == '&') out += "&amp;";
    else if (c == '<') out += "&lt;";
    else if (c == '>') out += "&gt;";
    else if (c == '"') out += "&quot;";
    else out += c;
  }
  return out;
}

std::string pad_left(const std::string& s, std::size_t width) {
  const std::size_t n = width_of(s);
  return n < width ? std::string(width - n, ' ') + s : s;
}

std::string pad_right(const std::string& s, std::size_t width) {
  const std::size_t n = width_of(s);
  return n < width ? s + std::string(width - n, ' ') : s;
}

std::string markdown_table(const std::vector<std::vector<std::string>>& rows, std::size_t left) {
  std::vector<std::size_t> width;
  for (const auto& row : rows) {
    width.resize(std::max(width.size(), row.size()), 3);
    for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], width_of(row[c]));
  }
  std::string out;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < width.size(); ++c) {
      const std::string cell = c < rows[r].size() ? rows[r][c] : "";
      out += "| " + (c < left ? pad_right(cell, width[c]) : pad_left(cell, width[c])) + " ";
    }
    out += "|\n";
    if (r > 0) continue;
    for (std::size_t c = 0; c < width.size(); ++c) out += "|" + std::string(width[c] + 1, '-') + (c < left ? "-" : ":");
    out += "|\n";
  }
  return out;
}

}  // namespace delassus::bench
