#include "models/formats/sdf_text.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <string_view>
#include <vector>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "algorithms/errors/status.h"

namespace delassus {
namespace {

bool is(const tinyxml2::XMLElement* e, std::string_view name) { return name == e->Name(); }

/// Of a fixed joint, whose axis is nothing to refuse a file for.
bool idle_axis(const tinyxml2::XMLElement* e) {
  const tinyxml2::XMLElement* joint = e->Parent() == nullptr ? nullptr : e->Parent()->ToElement();
  return (is(e, "axis") || is(e, "axis2")) && joint != nullptr && is(joint, "joint") && joint->Attribute("type", "fixed") != nullptr;
}

/// From SDF 1.8 on; 1.10 is later than 1.9.
bool has_scopes(const char* version) {
  int major = 0, minor = 0;
  return version != nullptr && std::sscanf(version, "%d.%d", &major, &minor) == 2 && (major > 1 || (major == 1 && minor >= 8));
}

class InLines : public tinyxml2::XMLPrinter {
 public:
  InLines() : XMLPrinter(nullptr, true) {}
  bool VisitEnter(const tinyxml2::XMLElement& e, const tinyxml2::XMLAttribute* a) override {
    SealElementIfJustOpened();
    while (line_ < e.GetLineNum()) Putc('\n');
    return XMLPrinter::VisitEnter(e, a);
  }

 protected:
  void Write(const char* data, std::size_t size) override {
    line_ += static_cast<int>(std::count(data, data + size, '\n'));
    XMLPrinter::Write(data, size);
  }
  void Putc(char c) override {
    line_ += c == '\n';
    XMLPrinter::Putc(c);
  }

 private:
  int line_ = 1;
};

}  // namespace

std::string text_on_its_lines(const tinyxml2::XMLDocument& document) {
  InLines printer;
  document.Print(&printer);
  return printer.CStr();
}

std::string value_at(const tinyxml2::XMLElement& root, const std::string& kind, int line) {
  std::vector<const tinyxml2::XMLElement*> stack{&root};
  while (!stack.empty()) {
    const tinyxml2::XMLElement* e = stack.back();
    stack.pop_back();
    if (is(e, kind) && e->GetLineNum() == line && e->FirstChildElement() == nullptr) return in_quotes(e->GetText() == nullptr ? "" : e->GetText());
    for (const tinyxml2::XMLElement* c = e->LastChildElement(); c; c = c->PreviousSiblingElement()) stack.push_back(c);
  }
  return "";
}

std::set<int> links_of_automatic_inertia(const tinyxml2::XMLElement& root) {
  std::set<int> out;
  std::vector<const tinyxml2::XMLElement*> stack{&root};
  while (!stack.empty()) {
    const tinyxml2::XMLElement* e = stack.back();
    stack.pop_back();
    for (const tinyxml2::XMLElement* c = e->LastChildElement(); c; c = c->PreviousSiblingElement()) stack.push_back(c);
    const tinyxml2::XMLElement* inertial = is(e, "link") ? e->FirstChildElement("inertial") : nullptr;
    if (inertial != nullptr && inertial->BoolAttribute("auto")) out.insert(e->GetLineNum());
  }
  return out;
}

void check_sdf_words(const std::string& file, const tinyxml2::XMLElement& root) {
  static const std::vector<std::string> types{"ball", "continuous", "fixed", "gearbox", "prismatic", "revolute", "revolute2", "screw", "universal"};
  const bool scopes = has_scopes(root.Attribute("version"));
  std::vector<const tinyxml2::XMLElement*> stack{&root};
  while (!stack.empty()) {
    const tinyxml2::XMLElement* e = stack.back();
    stack.pop_back();
    for (const tinyxml2::XMLElement* c = e->LastChildElement(); c; c = c->PreviousSiblingElement()) stack.push_back(c);
    const char* const name = e->Attribute("name");
    const std::string element = std::string(e->Name()) + " " + in_quotes(name == nullptr ? "" : name) + in_line(e->GetLineNum());
    if (scopes && name != nullptr && std::string_view(name).find("::") != std::string_view::npos)
      throw ModelError(file, element, "its name has \"::\" in it, which stands between a model's name and a link's", "names without :: from SDF 1.8 on; rename it, or put the link into a <model> of its own");
    for (const char* end : {"parent", "child"})
      if (is(e, "joint") && e->FirstChildElement(end) == nullptr)
        throw ModelError(file, element, "has no <" + std::string(end) + ">", "a <parent> and a <child>; write the link's name, or world");
    const char* const type = is(e, "joint") ? e->Attribute("type") : nullptr;
    if (type == nullptr) continue;
    std::string small = type, all;
    for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (std::find(types.begin(), types.end(), small) != types.end()) continue;
    for (const std::string& t : types) all += (all.empty() ? "" : ", ") + t;
    throw ModelError(file, element, "type " + in_quotes(type) + " is none of SDF", did_you_mean(small, types) + all + "; correct the type");
  }
}

void check_sdf_numbers(const std::string& file, const tinyxml2::XMLElement& root) {
  static const char* const names[] = {"mass", "ixx", "ixy", "ixz", "iyy", "iyz", "izz", "pose", "xyz", "damping", "friction", "lower", "upper", "effort",
                                      "velocity", "radius", "length", "size", "scale", "thread_pitch", "gearbox_ratio", "radii"};
  std::vector<const tinyxml2::XMLElement*> stack{&root};
  while (!stack.empty()) {
    const tinyxml2::XMLElement* e = stack.back();
    stack.pop_back();
    const std::string name = e->Name();
    if (name == "plugin" || name == "visual" || name == "sensor" || name == "gui" || name == "scene" || name == "light" || name == "actor" || name == "state") continue;
    if (idle_axis(e)) continue;
    for (const tinyxml2::XMLElement* c = e->LastChildElement(); c; c = c->PreviousSiblingElement()) stack.push_back(c);
    if (e->GetText() == nullptr || e->FirstChildElement() != nullptr) continue;
    if (std::none_of(std::begin(names), std::end(names), [&](const char* n) { return name == n; })) continue;
    std::istringstream words(e->GetText());
    double size = 0;
    for (std::string word; words >> word;) {
      size = std::max(size, std::fabs(finite_number(word).value_or(1)));
      const bool infinite = word == "inf" || word == "-inf" || word == "+inf" || word == "Inf" || word == "-Inf" || word == "INF" || word == "-INF";
      const bool bound = name == "lower" || name == "upper" || name == "effort" || name == "velocity";
      if (finite_number(word) || (bound && infinite)) continue;
      throw ModelError(file, "<" + name + "> (line " + std::to_string(e->GetLineNum()) + ")", in_quotes(e->GetText()) + " is not finite",
                       std::string(bound ? "a number, inf or -inf" : "finite numbers") + "; correct the text");
    }
    if (name == "xyz" && size == 0)
      throw ModelError(file, "<xyz> (line " + std::to_string(e->GetLineNum()) + ")", in_quotes(e->GetText()) + " is no direction", "a vector that is not 0; give the axis, or take a fixed joint");
  }
}

void leave_out_of_sdf(tinyxml2::XMLElement& root) {
  static const char* const names[] = {"visual", "sensor", "plugin", "gui", "scene", "light", "actor", "physics", "atmosphere", "magnetic_field",
                                      "spherical_coordinates", "wind", "audio", "audio_sink", "audio_source", "state", "road", "particle_emitter", "battery", "projector"};
  std::vector<tinyxml2::XMLElement*> stack{&root};
  while (!stack.empty()) {
    tinyxml2::XMLElement* e = stack.back();
    stack.pop_back();
    for (tinyxml2::XMLElement* c = e->FirstChildElement(); c;) {
      tinyxml2::XMLElement* const next = c->NextSiblingElement();
      const std::string_view name = c->Name();
      const bool no_friction = (name == "mu" || name == "mu2") && c->GetText() != nullptr && finite_number(c->GetText()).value_or(0) < 0;  // -1: not given
      if (no_friction || idle_axis(c) || std::any_of(std::begin(names), std::end(names), [&](const char* n) { return name == n; })) e->DeleteChild(c);
      else stack.push_back(c);
      c = next;
    }
  }
}

}  // namespace delassus
