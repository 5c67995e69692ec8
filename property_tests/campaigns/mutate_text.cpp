#include "property_tests/campaigns/mutate_text.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace delassus {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::size_t below(std::size_t n) { return n == 0 ? 0 : engine_() % n; }
  char byte() { return static_cast<char>(engine_() & 255); }

 private:
  std::mt19937_64 engine_;
};

constexpr std::string_view odd_numbers[] = {
    "1e999", "-1e999", "nan", "inf", "-inf", "0x10", "1,5", "+1", "1e-400", "-0", "0", "", " ", "2 ", " 2", "\t2", "2\n", "1e308", "-1", "1e-300",
    "1.", ".5", "5e", "--1", "1 2", "1 2 3", "0 0 0", "1 2 3 4", "${x}", "$(arg m)", "1d5", "1e5", "1_000", "1f", "\xD9\xA1", "9007199254740993",
    "0.1000000000000000055511151231257827021181583404541015625", "1e+2", "&#50;", "true", "1e16", "180", "3.5e-310"};
constexpr std::string_view odd_words[] = {"", " ", "world", "base", "\"", "<", ">", "&", "&amp;", "&lt;x&gt;", "<!--", "-->", "/>", "]]>", "<![CDATA[", "..", "/", "a/b",
                                         "\xEF\xBB\xBF", "\r\n", "${name}", "xacro:property", "nan", "null", "~", "{}", "[]", ": ", "- ", "%", "*a", "&a "};

bool of_number(char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E'; }
bool of_word(char c) { return of_number(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

struct Span {
  std::size_t at = 0, size = 0;
};

/// All stretches of characters that `in` accepts and that hold one that `must`.
template <class In, class Must> std::vector<Span> spans(const std::string& text, const In& in, const Must& must) {
  std::vector<Span> out;
  for (std::size_t i = 0; i < text.size();) {
    if (!in(text[i])) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < text.size() && in(text[end])) ++end;
    const bool word_before = i > 0 && of_word(text[i - 1]);
    if (!word_before && std::any_of(text.begin() + static_cast<std::ptrdiff_t>(i), text.begin() + static_cast<std::ptrdiff_t>(end), must)) out.push_back({i, end - i});
    i = end;
  }
  return out;
}

std::vector<Span> numbers(const std::string& text) {
  return spans(text, of_number, [](char c) { return c >= '0' && c <= '9'; });
}
std::vector<Span> words(const std::string& text) {
  return spans(text, of_word, [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); });
}
/// name="value" with the blank before it.
std::vector<Span> attributes(const std::string& text) {
  std::vector<Span> out;
  for (std::size_t equals = text.find("=\""); equals != std::string::npos; equals = text.find("=\"", equals + 2)) {
    const std::size_t end = text.find('"', equals + 2), blank = text.find_last_of(" \n\t", equals);
    if (end != std::string::npos && blank != std::string::npos) out.push_back({blank, end + 1 - blank});
  }
  return out;
}
std::vector<Span> lines(const std::string& text) {
  return spans(text, [](char c) { return c != '\n'; }, [](char) { return true; });
}
/// <name …> … </name> or <name …/>, from every '<' on.
std::vector<Span> elements(const std::string& text) {
  std::vector<Span> out;
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
    const std::size_t end = text.find('>', at);
    if (end == std::string::npos || at + 1 >= text.size() || !of_word(text[at + 1])) continue;
    if (text[end - 1] == '/') {
      out.push_back({at, end + 1 - at});
      continue;
    }
    const std::string close = "</" + text.substr(at + 1, text.find_first_of(" \t\n>", at) - at - 1) + ">";
    const std::size_t last = text.find(close, end);
    if (last != std::string::npos) out.push_back({at, last + close.size() - at});
  }
  return out;
}

template <std::size_t n> std::string_view any(const std::string_view (&of)[n], Random& random) { return of[random.below(n)]; }

using Finder = std::vector<Span> (*)(const std::string&);
constexpr std::array<Finder, 5> finders{numbers, words, attributes, lines, elements};

std::string once(std::string text, Random& random) {
  const std::size_t at = random.below(text.size() + 1);
  const std::size_t what = random.below(10);
  if (what == 0 && !text.empty()) text[std::min(at, text.size() - 1)] = random.byte();
  if (what == 1) text.insert(at, 1, random.byte());
  if (what == 2 && at < text.size()) text.erase(at, 1 + random.below(3));
  if (what == 3) text.insert(at, any(odd_words, random));
  if (what == 4 && random.below(8) == 0) text.resize(at);
  if (what < 5) return text;
  const std::vector<Span> found = (what < 7 ? numbers : finders[random.below(finders.size())])(text);
  if (found.empty()) return text;
  const Span s = found[random.below(found.size())], other = found[random.below(found.size())];
  const std::string here = text.substr(s.at, s.size), there = text.substr(other.at, other.size);
  if (what < 7) return text.replace(s.at, s.size, any(odd_numbers, random));
  switch (random.below(5)) {
    case 0: return text.erase(s.at, s.size);
    case 1: return text.insert(s.at, here);
    case 2: return text.insert(other.at, here);
    case 3: return text.replace(s.at, s.size, there);
    default: return text.replace(s.at, s.size, any(odd_words, random));
  }
}

std::string repeated(const std::string& unit, std::size_t times) {
  std::string out;
  for (std::size_t k = 0; k < times; ++k) out += unit;
  return out;
}

}  // namespace

std::string mutated(std::string text, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t k = 1 + random.below(4); k > 0; --k) text = once(std::move(text), random);
  return text;
}

std::vector<std::string> whole_kinds(const std::string& text) {
  using namespace std::string_literals;
  std::vector<std::string> out{"", " ", "\n", "\0"s, "\xEF\xBB\xBF", "<", ">", "</a>", "<a>", "<a/>", "<?xml version=\"1.0\"?>", "<?xml version=\"1.0\"?>\n", "<!-- only a comment -->",
                               "<!DOCTYPE robot>", "<![CDATA[x]]>", "text", "{", "[", "null", "robots", "robots:", "robots: [", "- a", "---", "...", "%YAML 9.9", "<robot/>",
                               "<robot name=\"\"/>", "<robot name=\"r\"/>", "<robot name=\"r\"><link/></robot>", "<mujoco/>", "<sdf/>", "<sdf version=\"9\"/>", "<mujoco><worldbody/></mujoco>",
                               repeated("<a>", 100000), repeated("<a>", 400) + repeated("</a>", 400), "<robot name=\"r\">" + repeated("<link name=\"l\">", 90) + repeated("</link>", 90) + "</robot>",
                               repeated("[", 100000), repeated("{a: ", 100000), repeated("- ", 20000), repeated("x", 1000000), "&a [*a]", "a: &a [*a, *a]"};
  out.push_back("\xEF\xBB\xBF" + text);
  out.push_back("\xFF\xFE" + text);
  out.push_back(text + "\0"s);
  out.push_back(text + text);
  out.push_back(text + "\n<!-- after -->\n");
  out.push_back(text + "junk");
  std::string crlf;
  for (const char c : text) crlf += c == '\n' ? "\r\n"s : std::string(1, c);
  out.push_back(crlf);
  for (std::size_t k = 1; k < 20; ++k) out.push_back(text.substr(0, k * text.size() / 20));
  for (const Span s : numbers(text))
    for (const std::string_view odd : odd_numbers) out.push_back(std::string(text).replace(s.at, s.size, odd));
  for (const Span s : attributes(text)) {
    out.push_back(std::string(text).erase(s.at, s.size));
    out.push_back(std::string(text).insert(s.at, text.substr(s.at, s.size)));
  }
  for (const Span s : elements(text)) {
    out.push_back(std::string(text).erase(s.at, s.size));
    out.push_back(std::string(text).insert(s.at, text.substr(s.at, s.size)));
  }
  return out;
}

}  // namespace delassus
