#include "models/formats/mjcf_said.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <vector>

#include "algorithms/errors/message.h"

namespace delassus {
namespace {

using Element = tinyxml2::XMLElement;

/// What stands between `before` and `after`; "" when there is no such place.
std::string between(const std::string& text, std::string_view before, std::string_view after) {
  const std::size_t at = text.find(before), start = at + before.size();
  if (at == std::string::npos) return "";
  const std::size_t end = text.find(after, start);
  return end == std::string::npos ? "" : text.substr(start, end - start);
}

/// The line a message names, `line 4` or `line = 4`; 0: none.
int line_in(const std::string& text) {
  for (const std::string_view mark : {", line = ", ", line "}) {
    const std::size_t at = text.rfind(mark);
    if (at != std::string::npos) return std::atoi(text.c_str() + at + mark.size());
  }
  return 0;
}

/// The element that starts in this line, of this kind and name where they are given.
const Element* element_at(const tinyxml2::XMLDocument& document, int line, const std::string& kind, const std::string& name) {
  std::vector<const Element*> stack{document.RootElement()};
  while (!stack.empty()) {
    const Element* e = stack.back();
    stack.pop_back();
    const char* const own = e->Attribute("name");
    if (e->GetLineNum() == line && (kind.empty() || kind == e->Name()) && (name.empty() || (own != nullptr && name == own))) return e;
    for (const Element* c = e->LastChildElement(); c != nullptr; c = c->PreviousSiblingElement()) stack.push_back(c);
  }
  return nullptr;
}

/// The first word of an attribute that is no number; nothing where all are.
std::optional<std::string> no_number(const char* value) {
  std::istringstream words(value);
  std::string word;
  while (words >> word)
    if (!finite_number(word)) return word;
  return word.empty() ? std::optional<std::string>("") : std::nullopt;
}

/// ` mass "-1"` … of the element that gives the inertia.
std::string attributes(const Element* e) {
  std::string out;
  for (const tinyxml2::XMLAttribute* a = e->FirstAttribute(); a != nullptr; a = a->Next()) out.append(" ").append(a->Name()).append(" ").append(in_quotes(a->Value()));
  return out;
}

}  // namespace

MjcfSaid mjcf_said(const tinyxml2::XMLDocument& document, const std::string& message) {
  MjcfSaid out{"MuJoCo", message, ""};
  const std::string kind = between(message, "Element '", "'"), name = between(message, "Object name = ", ",");
  const int line = line_in(message);
  if (line == 0 || document.RootElement() == nullptr) return out;
  out.element = "line " + std::to_string(line), out.text = "MuJoCo: " + message;
  const Element* const e = kind.empty() && name.empty() ? nullptr : element_at(document, line, kind, name);
  if (e == nullptr) return out;
  const char* const own = e->Attribute("name");
  out.element = (own == nullptr ? "<" + std::string(e->Name()) + ">" : std::string(e->Name()) + " " + in_quotes(own)) + in_line(line);
  const char* const value = e->Attribute(between(message, "attribute '", "'").c_str());
  if (value != nullptr) {
    const std::optional<std::string> word = no_number(value);
    out.text = between(message, "attribute '", "'") + " " + in_quotes(value);
    if (word) out.text += (*word == value ? " " : ": " + in_quotes(*word) + " ") + not_a_number(*word).problem, out.to_do = not_a_number(*word).advice;
    out.text += "; MuJoCo: " + message;
  }
  const Element* const inertial = e->FirstChildElement("inertial");
  if (inertial != nullptr && message.find("mass and inertia") != std::string::npos)
    out.text = "its <inertial>" + in_line(inertial->GetLineNum()) + " has" + attributes(inertial) + "; " + out.text;
  return out;
}

bool same_complaint(const std::string& a, const std::string& b) {
  const auto plain = [](std::string text) {
    const std::size_t at = std::min(text.find("Object name = "), text.find(", line "));
    return at == std::string::npos ? text : text.substr(0, at);
  };
  return plain(a) == plain(b);
}

}  // namespace delassus
