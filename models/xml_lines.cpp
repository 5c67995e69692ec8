#include "models/xml_lines.h"

#include <tinyxml2.h>

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
    const auto [it, first] = line_.try_emplace({e->Name(), name}, e->GetLineNum());
    if (!first) it->second = 0;
  }
}

int XmlLines::line(const std::string& kind, const std::string& name) const {
  if (const auto it = line_.find({kind, name}); it != line_.end()) return it->second;
  const std::size_t scope = name.rfind("::");
  return scope == std::string::npos ? 0 : line(kind, name.substr(scope + 2));
}

std::string XmlLines::element(const std::string& kind, const std::string& name) const {
  return kind + " " + in_quotes(name) + in_line(line(kind, name));
}

}  // namespace delassus
