#include "models/formats/xml_lines.h"

#include <tinyxml2.h>

#include <algorithm>
#include <vector>

#include "algorithms/errors/message.h"

namespace delassus {

XmlLines::XmlLines(const std::string& file) {
  tinyxml2::XMLDocument document;
  if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS || document.RootElement() == nullptr) return;
  std::vector<const tinyxml2::XMLElement*> stack{document.RootElement()};
  while (!stack.empty()) {
    const tinyxml2::XMLElement* e = stack.back();
    stack.pop_back();
    for (const tinyxml2::XMLElement* c = e->FirstChildElement(); c; c = c->NextSiblingElement()) stack.push_back(c);
    const char* const name = e->Attribute("name");
    if (name == nullptr) continue;
    lines_[{e->Name(), name}].push_back(e->GetLineNum());
  }
}

std::vector<int> XmlLines::lines(const std::string& kind, const std::string& name) const {
  if (const auto it = lines_.find({kind, name}); it != lines_.end()) return it->second;
  const std::size_t scope = name.rfind("::");
  return scope == std::string::npos ? std::vector<int>{} : lines(kind, name.substr(scope + 2));
}

int XmlLines::line(const std::string& kind, const std::string& name) const {
  const std::vector<int> all = lines(kind, name);
  return all.size() == 1 ? all.front() : 0;
}

std::string XmlLines::element(const std::string& kind, const std::string& name) const {
  std::vector<int> all = lines(kind, name);
  std::sort(all.begin(), all.end());
  const std::string two = all.size() == 2 ? " (line " + std::to_string(all[0]) + " or " + std::to_string(all[1]) + ")" : "";
  return kind + " " + in_quotes(name) + (two.empty() ? in_line(line(kind, name)) : two);
}

}  // namespace delassus
