#include "models/sdf_text.h"

#include <algorithm>
#include <sstream>
#include <string_view>
#include <vector>

#include "algorithms/errors/message.h"
#include "algorithms/errors/status.h"

namespace delassus {

void check_sdf_numbers(const std::string& file, const tinyxml2::XMLElement& root) {
  static const char* const names[] = {"mass", "ixx", "ixy", "ixz", "iyy", "iyz", "izz", "pose", "xyz", "damping", "friction", "lower", "upper", "effort",
                                      "velocity", "radius", "length", "size", "scale", "thread_pitch", "gearbox_ratio", "radii"};
  std::vector<const tinyxml2::XMLElement*> stack{&root};
  while (!stack.empty()) {
    const tinyxml2::XMLElement* e = stack.back();
    stack.pop_back();
    const std::string name = e->Name();
    if (name == "plugin" || name == "visual" || name == "sensor" || name == "gui" || name == "scene" || name == "light" || name == "actor" || name == "state") continue;
    for (const tinyxml2::XMLElement* c = e->LastChildElement(); c; c = c->PreviousSiblingElement()) stack.push_back(c);
    if (e->GetText() == nullptr || e->FirstChildElement() != nullptr) continue;
    if (std::none_of(std::begin(names), std::end(names), [&](const char* n) { return name == n; })) continue;
    std::istringstream words(e->GetText());
    for (std::string word; words >> word;) {
      const bool infinite = word == "inf" || word == "-inf" || word == "+inf" || word == "Inf" || word == "-Inf" || word == "INF" || word == "-INF";
      const bool bound = name == "lower" || name == "upper" || name == "effort" || name == "velocity";
      if (finite_number(word) || (bound && infinite)) continue;
      throw ModelError(file, "<" + name + "> (line " + std::to_string(e->GetLineNum()) + ")", in_quotes(e->GetText()) + " is not finite",
                       std::string(bound ? "a number, inf or -inf" : "finite numbers") + "; correct the text");
    }
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
      if (no_friction || std::any_of(std::begin(names), std::end(names), [&](const char* n) { return name == n; })) e->DeleteChild(c);
      else stack.push_back(c);
      c = next;
    }
  }
}

}  // namespace delassus
