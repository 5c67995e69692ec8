// What newer versions of MuJoCo write and 2.2 cannot read, taken out where it has no part in M, J or contacts.
#include <algorithm>
#include <array>
#include <string_view>

#include "models/formats/mjcf_xml.h"

namespace delassus {
namespace {

using Element = tinyxml2::XMLElement;

template <std::size_t n> bool among(std::string_view word, const std::array<std::string_view, n>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// Elements that are drawn, measured, driven or stored.
constexpr std::array<std::string_view, 8> sections{"visual", "statistic", "sensor", "custom", "actuator", "contact", "numeric", "text"};
constexpr std::array<std::string_view, 18> drawn{"texture", "material", "camera", "light", "skin", "general", "motor", "position", "velocity", "intvelocity",
                                                 "damper", "cylinder", "muscle", "adhesion", "global", "quality", "headlight", "rgba"};
struct Attribute {
  std::string_view element, name;
};
constexpr Attribute newer_attributes[] = {
    {"body", "gravcomp"}, {"body", "sleep"}, {"joint", "actuatorfrcrange"}, {"joint", "actuatorfrclimited"}, {"joint", "actuatorgravcomp"},
    {"size", "memory"}, {"compiler", "conflict"}, {"compiler", "saveinertial"}, {"mesh", "maxhullvert"}, {"key", "ctrl"}, {"key", "act"},
    {"geom", "material"}, {"geom", "adhesion"}, {"site", "material"}, {"tendon", "material"}, {"spatial", "material"}, {"fixed", "actuatorfrcrange"},
    {"fixed", "actuatorfrclimited"}, {"spatial", "actuatorfrcrange"}, {"spatial", "actuatorfrclimited"}, {"fixed", "springlength"}, {"spatial", "springlength"}, {"hfield", "elevation"}};

bool droppable(const Element* e) {
  const std::string_view name = e->Name(), parent = e->Parent()->ToElement() == nullptr ? "" : e->Parent()->ToElement()->Name();
  if (parent == "mujoco") return among(name, sections);
  const bool in_default = parent == "default" || parent == "asset" || parent == "body" || parent == "worldbody" || parent == "frame";
  return in_default && among(name, drawn);
}

void drop_attributes(Element* e) {
  const std::string_view name = e->Name();
  for (const Attribute& a : newer_attributes)
    if (name == a.element) e->DeleteAttribute(a.name.data());
  if (name == "option") while (const auto* a = e->FirstAttribute()) e->DeleteAttribute(a->Name());
  if (name == "freejoint" && (e->Attribute("align", "auto") || e->Attribute("align", "false"))) e->DeleteAttribute("align");
  if (name != "flag") return;
  const bool off = e->Attribute("equality", "disable") != nullptr;
  while (const auto* a = e->FirstAttribute()) e->DeleteAttribute(a->Name());
  if (off) e->SetAttribute("equality", "disable");
}

/// `assetdir` stands for both folders; a short `polycoef` is completed by its default 0 1 0 0 0.
void respell(Element* e) {
  const std::string_view name = e->Name();
  if (name == "compiler" && e->Attribute("assetdir") != nullptr) {
    const std::string folder = e->Attribute("assetdir");
    for (const char* key : {"meshdir", "texturedir"})
      if (e->Attribute(key) == nullptr) e->SetAttribute(key, folder.c_str());
    e->DeleteAttribute("assetdir");
  }
  if (e->Attribute("polycoef") == nullptr) return;
  std::string text = e->Attribute("polycoef");
  std::size_t count = 0;
  for (std::size_t i = 0; i < text.size(); ++i) count += text[i] != ' ' && (i == 0 || text[i - 1] == ' ');
  for (; count < 5; ++count) text += count == 1 ? " 1" : " 0";
  e->SetAttribute("polycoef", text.c_str());
}

/// Takes a connect or weld between sites out, as what it says.
bool take_sites(Element* e, std::vector<SiteEquality>& out) {
  const std::string_view name = e->Name();
  if ((name != "connect" && name != "weld") || e->Attribute("site1") == nullptr || e->Attribute("site2") == nullptr) return false;
  out.push_back({e->Attribute("name") == nullptr ? "" : e->Attribute("name"), e->Attribute("site1"), e->Attribute("site2"), name == "weld",
                 e->Attribute("active", "false") == nullptr});
  return true;
}

void renew(Element* e, std::vector<SiteEquality>& sites) {
  drop_attributes(e);
  respell(e);
  for (Element *c = e->FirstChildElement(), *next = nullptr; c != nullptr; c = next) {
    next = c->NextSiblingElement();
    if (droppable(c) || take_sites(c, sites)) e->DeleteChild(c);
    else renew(c, sites);
  }
}

}  // namespace

void MjcfXml::respell_newer() {
  Element* root = doc_.RootElement();
  if (root == nullptr) return;
  renew(root, sites_);
  for (Element* c = root->FirstChildElement("compiler"); c != nullptr; c = c->NextSiblingElement("compiler"))
    if (c->Attribute("autolimits") != nullptr) return;
  root->InsertFirstChild(doc_.NewElement("compiler"))->ToElement()->SetAttribute("autolimits", "true");
}

}  // namespace delassus
