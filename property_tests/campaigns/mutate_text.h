// Mutations of texts that robots and scenes are written in: bytes, words, numbers, attributes, lines, elements. The same
// text and seed give the same mutant everywhere.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace delassus {

/// One to four mutations.
[[nodiscard]] std::string mutated(std::string text, std::uint64_t seed);

/// Texts that are no mutation of anything: empty, no root element, only a comment, nested without end, NUL bytes, …;
/// and whole kinds made of `text`: byte order mark, CRLF, cut short, every number replaced in turn by one that is none.
[[nodiscard]] std::vector<std::string> whole_kinds(const std::string& text);

}  // namespace delassus
