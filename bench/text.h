// Numbers and strings for people: fixed digits, SI prefixes, HTML escapes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace delassus::bench {

/// printf into a string.
[[nodiscard, gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);
/// Three significant digits without exponent: 0.0123, 1.23, 123, 12300; `–` for NaN.
[[nodiscard]] std::string three_digits(double x);
/// One significant digit with its exponent, for what is known no better: 3e-16; `–` for NaN.
[[nodiscard]] std::string rough_digit(double x);
/// An error ratio: three digits, `<0.001` below that, 0 for exact agreement.
[[nodiscard]] std::string ratio_text(double ratio);
/// A count with prefix: 950, 12.3 k, 1.23 M; `–` below zero.
[[nodiscard]] std::string short_count(std::int64_t n);
/// Bytes with prefix: 512 B, 12.3 kB, 1.23 MB (powers of 1000); `–` below zero.
[[nodiscard]] std::string short_bytes(std::int64_t n);
/// Text safe inside HTML and XML elements and double-quoted attributes.
[[nodiscard]] std::string escape(std::string_view s);
/// Pads with spaces to a width counted in characters (UTF-8 code points).
[[nodiscard]] std::string pad_left(const std::string& s, std::size_t width);
[[nodiscard]] std::string pad_right(const std::string& s, std::size_t width);
/// A table in Markdown, its columns as wide as their widest cell; the first row is the head. Columns stand to the right but the first
/// `left`, and empty cells at the end of a row are filled in.
[[nodiscard]] std::string markdown_table(const std::vector<std::vector<std::string>>& rows, std::size_t left = 1);

}  // namespace delassus::bench
