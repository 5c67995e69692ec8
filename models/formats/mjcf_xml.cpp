#include "models/formats/mjcf_xml.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "algorithms/errors/message.h"

namespace delassus {
namespace {

namespace fs = std::filesystem;
using Element = tinyxml2::XMLElement;

std::string attribute(const Element* e, const char* name) {
  const char* text = e->Attribute(name);
  return text == nullptr ? "" : text;
}

/// Included elements have no line of the file.
std::string line_of(const Element* e) { return e->GetLineNum() > 0 ? " (line " + std::to_string(e->GetLineNum()) + ")" : ""; }

bool is(const Element* e, const char* name) { return std::string_view(e->Name()) == name; }

std::vector<Element*> children(Element* e) {
  std::vector<Element*> out;
  for (Element* c = e->FirstChildElement(); c != nullptr; c = c->NextSiblingElement()) out.push_back(c);
  return out;
}

/// A file, and not the line that a checkout without Git LFS leaves in its place.
bool there(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  constexpr std::string_view pointer = "version https://git-lfs";
  std::array<char, pointer.size()> start{};
  std::ifstream(path, std::ios::binary).read(start.data(), start.size());
  return std::string_view(start.data(), start.size()) != pointer;
}

/// The last value of a compiler option; later ones win in MuJoCo.
std::string compiler_option(const tinyxml2::XMLDocument& doc, const char* name) {
  std::string out;
  const Element* root = doc.RootElement();
  for (const Element* c = root == nullptr ? nullptr : root->FirstChildElement("compiler"); c != nullptr; c = c->NextSiblingElement("compiler"))
    if (c->Attribute(name) != nullptr) out = c->Attribute(name);
  return out;
}

std::vector<double> numbers(const char* text) {
  std::vector<double> out;
  std::string_view rest = text == nullptr ? "" : text;
  for (std::size_t end = 0; !rest.empty(); rest.remove_prefix(std::min(rest.size(), end + 1))) {
    end = std::min(rest.find_first_of(" \t\r\n"), rest.size());
    if (end == 0) continue;
    const auto x = finite_number(rest.substr(0, end));
    if (!x) return {};
    out.push_back(*x);
  }
  return out;
}

}  // namespace

MjcfXml::MjcfXml(const std::string& file) : file_(file), folder_(fs::path(file).parent_path().string()) {
  if (doc_.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS || doc_.RootElement() == nullptr) return;
  if (is(doc_.RootElement(), "mujocoinclude")) throw ModelError(file, "<mujocoinclude> (line " + std::to_string(doc_.RootElement()->GetLineNum()) + ")", "is a part that other files include", "a file with the root element mujoco; give the file that includes this one");
  if (!is(doc_.RootElement(), "mujoco")) throw ModelError(file, "<" + std::string(doc_.RootElement()->Name()) + "> (line " + std::to_string(doc_.RootElement()->GetLineNum()) + ")", "is no MJCF", "the root element mujoco; give an MJCF file");
  include(doc_.RootElement(), folder_, 0);
}

/// Puts the children of included roots where <include> stands. MuJoCo's paths are all relative to the first file.
void MjcfXml::include(Element* at, const std::string& folder, int depth) {
  if (depth > 200) return;  // MuJoCo has its own message for files that include each other
  for (Element* e : children(at)) {
    if (!is(e, "include")) {
      include(e, folder, depth + 1);
      continue;
    }
    tinyxml2::XMLDocument part;
    const std::string name = (fs::path(folder) / attribute(e, "file")).string();
    if (part.LoadFile(name.c_str()) != tinyxml2::XML_SUCCESS || part.RootElement() == nullptr) continue;
    included_ = true;
    Element* root = part.RootElement()->DeepClone(&doc_)->ToElement();
    include(root, folder, depth + 1);
    tinyxml2::XMLNode* after = e;
    while (tinyxml2::XMLNode* child = root->FirstChild()) after = at->InsertAfterChild(after, child);
    at->DeleteChild(e);
    doc_.DeleteNode(root);
  }
}

std::string MjcfXml::path_of(const char* kind, const std::string& file) const {
  const std::string both = compiler_option(doc_, "assetdir");
  std::string folder = compiler_option(doc_, std::string_view(kind) == "texture" ? "texturedir" : "meshdir");
  if (folder.empty()) folder = both;
  const bool bare = compiler_option(doc_, "strippath") == "true";
  const fs::path name = bare ? fs::path(file).filename() : fs::path(file);
  return (fs::path(folder_) / folder / name).string();
}

/// The assets without their files.
void MjcfXml::strip_assets(Element* assets) {
  for (Element* e : children(assets)) {
    const std::string kind = e->Name(), file = attribute(e, "file");
    bool missing = !file.empty() && !there(path_of(kind.c_str(), file));
    for (const char* side : {"fileright", "fileleft", "fileup", "filedown", "filefront", "fileback"})
      missing = missing || (e->Attribute(side) != nullptr && !there(path_of("texture", attribute(e, side))));
    if (!missing) continue;
    std::string name = attribute(e, "name");
    if (name.empty()) name = fs::path(file).stem().string();
    gone_[kind][name] = true;
    left_out_.push_back(kind + " " + in_quotes(name));
    assets->DeleteChild(e);
  }
}

/// Takes out what refers to assets that are gone. `moves`: the body or one above it has a joint; `depends`: its inertia
/// comes from its geoms.
void MjcfXml::strip_uses(Element* e, bool moves, bool depends) {
  for (Element* c : children(e)) {
    for (const auto& [attribute_name, kind] : {std::pair{"texture", "texture"}, {"material", "material"}, {"hfield", "hfield"}, {"mesh", "mesh"}}) {
      if (c == nullptr || gone_[kind].count(attribute(c, attribute_name)) == 0) continue;
      if (std::string_view(kind) == "texture" || std::string_view(kind) == "material") {
        c->DeleteAttribute(attribute_name);
        continue;
      }
      const bool geom = is(c, "geom"), massless = !moves || !depends;
      if (geom && (!massless || (c->Attribute("type") != nullptr && attribute(c, "type") != "mesh" && attribute(c, "type") != "hfield")))
        throw ModelError(file_, "geom with " + std::string(kind) + " " + in_quotes(attribute(c, attribute_name)) + line_of(c),
                         "the file of this " + std::string(kind) + " is missing and " + (massless ? "the shape is fitted to it" : "the inertia of its body comes from it"),
                         "the file in its place; put it there, or give the body an <inertial>");
      fixed_inertia_lost_ = fixed_inertia_lost_ || (geom && depends);
      if (geom) left_out_.push_back("geom of " + std::string(kind) + " " + in_quotes(attribute(c, attribute_name)) + line_of(c));
      e->DeleteChild(c);
      c = nullptr;
    }
    if (c == nullptr) continue;
    const bool joint = c->FirstChildElement("joint") != nullptr || c->FirstChildElement("freejoint") != nullptr;
    if (is(c, "worldbody")) strip_uses(c, false, false);
    else if (is(c, "body")) strip_uses(c, moves || joint, by_geoms_ || c->FirstChildElement("inertial") == nullptr);
    else strip_uses(c, moves, depends);
  }
}

bool MjcfXml::strip_missing_files() {
  Element* root = doc_.RootElement();
  if (root == nullptr) return false;
  for (Element* e : children(root))
    if (is(e, "asset")) strip_assets(e);
  if (left_out_.empty()) return false;
  by_geoms_ = compiler_option(doc_, "inertiafromgeom") == "true";
  strip_uses(root, false, false);
  return true;
}

std::string MjcfXml::text() const {
  tinyxml2::XMLPrinter printer;
  doc_.Print(&printer);
  return printer.CStr();
}

/// A line may be that of an included file.
MjcfSaid MjcfXml::said(const std::string& message) const {
  return included_ ? MjcfSaid{"MuJoCo", message, ""} : mjcf_said(doc_, message);
}

std::map<std::string, Matrix3<double>> MjcfXml::full_inertia() const {
  std::map<std::string, Matrix3<double>> out;
  const Element* root = doc_.RootElement();
  std::vector<const Element*> stack;
  for (const Element* e = root == nullptr ? nullptr : root->FirstChildElement("worldbody"); e != nullptr; e = e->NextSiblingElement("worldbody")) stack.push_back(e);
  while (!stack.empty()) {
    const Element* body = stack.back();
    stack.pop_back();
    for (const Element* c = body->FirstChildElement(); c != nullptr; c = c->NextSiblingElement()) {
      if (is(c, "body")) stack.push_back(c);
      if (!is(c, "inertial") || c->Attribute("fullinertia") == nullptr || body->Attribute("name") == nullptr) continue;
      const std::vector<double> x = numbers(c->Attribute("fullinertia"));
      if (x.size() != 6) continue;
      Matrix3<double> I;
      I << x[0], x[3], x[4], x[3], x[1], x[5], x[4], x[5], x[2];
      out[body->Attribute("name")] = I;
    }
  }
  return out;
}

}  // namespace delassus
