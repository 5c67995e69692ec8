#include "models/formats/sdf_said.h"

#include <algorithm>
#include <cctype>
#include <iostream>
#include <mutex>
#include <sstream>

#include <console_bridge/console.h>
#include <sdf/Console.hh>
#include <sdf/sdf_config.h>

#include "algorithms/errors/message.h"
#include "models/formats/library_console.h"
#include "models/formats/sdf_text.h"

namespace delassus {
namespace {

sdf::Console::ConsoleStream& stream() { return sdf::Console::Instance()->GetMsgStream(); }

bool begins(const std::string& text, std::string_view with) { return text.rfind(with, 0) == 0; }

/// `/sdf/model[@name="m"]/joint[@name="j"]` -> `joint "j"`, `.../static` -> `<static>`.
std::string last_of(const std::string& path) {
  std::size_t slash = 0;
  bool quoted = false;
  for (std::size_t k = 0; k < path.size(); ++k) {
    if (path[k] == '"') quoted = !quoted;
    if (path[k] == '/' && !quoted) slash = k + 1;
  }
  const std::string last = path.substr(slash), kind = last.substr(0, last.find('['));
  constexpr std::string_view mark = "[@name=\"";
  const std::size_t at = last.find(mark), end = at == std::string::npos ? at : last.find("\"]", at + mark.size());
  return end == std::string::npos ? "<" + kind + ">" : kind + " " + in_quotes(last.substr(at + mark.size(), end - at - mark.size()));
}

/// The element a message speaks of, `link with name[arm]` or `[arm]`, that the file has; "" when there is none.
std::string element_of(const std::string& text, const XmlLines& lines) {
  for (std::size_t at = text.find('['); at != std::string::npos; at = text.find('[', at + 1)) {
    const std::size_t end = text.find(']', at);
    if (end == std::string::npos) break;
    const std::string name = text.substr(at + 1, end - at - 1), before = text.substr(0, at);
    const std::size_t with = before.rfind(" with name"), space = with == std::string::npos ? with : before.rfind(' ', with - 1);
    std::string kind = with == std::string::npos ? "" : before.substr(space == std::string::npos ? 0 : space + 1, with - (space == std::string::npos ? 0 : space + 1));
    for (char& c : kind) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (lines.has(kind, name)) return lines.element(kind, name);
    for (const char* other : {"joint", "link", "frame", "model", "collision"})
      if (lines.has(other, name)) return lines.element(other, name);
  }
  return "";
}

/// What only follows from another error.
bool follows(const std::string& text) {
  return begins(text, "Error reading element <") || begins(text, "Unable to read SDF string") || text.find("Graph") != std::string::npos;
}

/// Printed by libsdformat where nothing of the file is wrong: it tries older formats, and URDF, after every error.
bool idle(const std::string& text) { return text.find("old deprecated model") != std::string::npos || text.find("parseURDF") != std::string::npos; }

std::string shortened(const std::string& text) { return text.size() > 300 ? text.substr(0, 300) + "..." : text; }

}  // namespace

SdfConsole::SdfConsole() : lock_(library_console()), level_(console_bridge::getLogLevel()) {
  stream().SetStream(&text_);
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
}
SdfConsole::~SdfConsole() {
  stream().SetStream(&std::cerr);
  console_bridge::setLogLevel(static_cast<console_bridge::LogLevel>(level_));
}

std::vector<std::string> SdfConsole::messages() const {
  std::vector<std::string> out;
  std::string plain;
  bool escape = false;
  for (const char c : text_.str()) {
    if (c == '\x1b') escape = true;
    if (!escape) plain += c;
    if (escape && c == 'm') escape = false;
  }
  std::istringstream lines(plain);
  for (std::string line; std::getline(lines, line);) {
    const bool first = begins(line, "Warning [") || begins(line, "Error [") || begins(line, "Error Code");
    const std::size_t source = line.find("] ");
    if (first && source != std::string::npos) line = line.substr(source + 2);
    const std::size_t word = line.find_first_not_of(" \t");
    if (word == std::string::npos) continue;
    if (first || out.empty()) out.push_back(line.substr(word));
    else out.back() += " " + line.substr(word);
  }
  return out;
}

SdfSaid sdf_said(const sdf::Errors& errors, const std::vector<std::string>& printed, const XmlLines& lines, const tinyxml2::XMLElement& root) {
  std::vector<std::string> causes;
  const auto add = [&](const std::string& text) {
    if (causes.size() < 3 && std::find(causes.begin(), causes.end(), text) == causes.end()) causes.push_back(text);
  };
  const sdf::Error& first = errors.front();
  if (follows(first.Message()))  // the reason is only printed
    for (const std::string& text : printed)
      if (!idle(text)) add(shortened(text));
  add(shortened(first.Message()));
  for (const sdf::Error& e : errors)
    if (!follows(e.Message())) add(shortened(e.Message()));
  SdfSaid out;
  out.element = first.XmlPath() && first.LineNumber() ? last_of(*first.XmlPath()) + in_line(*first.LineNumber()) : element_of(first.Message(), lines);
  if (out.element.empty()) out.element = "<sdf>";
  const std::string value = out.element.front() == '<' && out.element != "<sdf>" ? value_at(root, out.element.substr(1, out.element.find('>') - 1), first.LineNumber().value_or(0)) : "";
  out.text = (value.empty() ? "" : value + "; ") + "libsdformat: ";
  for (std::size_t k = 0; k < causes.size(); ++k) out.text += (k > 0 ? "; " : "") + causes[k];
  return out;
}

SdfSaid sdf_said(const std::string& printed) {
  if (begins(printed, "Unable to convert from SDF version"))
    return {"<sdf version>", printed + "; it is read as " + SDF_PROTOCOL_VERSION, "a version that libsdformat " + std::string(SDF_VERSION_FULL) + " knows, up to " + SDF_PROTOCOL_VERSION + "; what a later one added is not read"};
  constexpr std::string_view mark = ":<data-string>:L";
  const std::size_t at = printed.find(mark), end = at == std::string::npos ? at : printed.find("]: ", at);
  if (!begins(printed, "[") || end == std::string::npos) return {"<sdf>", printed};
  const std::string line = printed.substr(at + mark.size(), end - at - mark.size());
  const bool digits = !line.empty() && line.size() < 9 && line.find_first_not_of("0123456789") == std::string::npos;
  return {last_of(printed.substr(1, at - 1)) + in_line(digits ? std::stoi(line) : 0), printed.substr(end + 3)};
}

}  // namespace delassus
