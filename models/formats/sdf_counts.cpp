#include "models/formats/sdf_counts.h"

#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include "algorithms/errors/message.h"
#include "algorithms/errors/status.h"

namespace delassus {
namespace {

using tinyxml2::XMLElement;

/// Numbers in an element that has a fixed count of them; a pose may have none.
const std::map<std::string_view, std::size_t> counts{
    {"mass", 1}, {"ixx", 1}, {"ixy", 1}, {"ixz", 1}, {"iyy", 1}, {"iyz", 1}, {"izz", 1}, {"damping", 1}, {"friction", 1}, {"lower", 1}, {"upper", 1}, {"effort", 1},
    {"velocity", 1}, {"radius", 1}, {"length", 1}, {"thread_pitch", 1}, {"gearbox_ratio", 1}, {"size", 3}, {"scale", 3}, {"radii", 3}, {"xyz", 3}, {"pose", 6}};
const std::set<std::string_view> once{
    "pose", "inertial", "mass", "inertia", "ixx", "ixy", "ixz", "iyy", "iyz", "izz", "static", "parent", "child", "axis", "axis2", "xyz", "use_parent_model_frame", "limit", "dynamics",
    "damping", "friction", "lower", "upper", "effort", "velocity", "thread_pitch", "gearbox_ratio", "gearbox_reference_body", "geometry", "box", "sphere", "cylinder", "capsule", "mesh",
    "size", "radius", "length", "scale", "uri"};

std::string element_of(const XMLElement& e) { return "<" + std::string(e.Name()) + "> (line " + std::to_string(e.GetLineNum()) + ")"; }

void check_numbers_of(const std::string& file, const XMLElement& e) {
  const auto expected = counts.find(e.Name());
  if (expected == counts.end() || e.FirstChildElement() != nullptr) return;
  const auto below = [&](const char* name) { return e.Parent()->ToElement() != nullptr && std::string_view(e.Parent()->Value()) == name; };
  if ((expected->first == "size" && !below("box")) || (expected->first == "scale" && !below("mesh"))) return;  // planes, heightmaps, images
  std::istringstream words(e.GetText() == nullptr ? "" : e.GetText());
  std::size_t n = 0;
  for (std::string word; words >> word;) ++n;
  const bool pose = expected->first == "pose", quaternion = pose && e.Attribute("rotation_format", "quat_xyzw") != nullptr;
  const std::size_t wanted = quaternion ? 7 : expected->second;
  if (n == wanted || (pose && n == 0)) return;
  throw ModelError(file, element_of(e), "holds " + std::to_string(n) + " numbers" + (n == 0 ? "" : ": " + in_quotes(e.GetText())),
                   pose ? "6 numbers, x y z [m] roll pitch yaw [rad], 7 with rotation_format=\"quat_xyzw\", or none" : std::to_string(wanted) + (wanted == 1 ? " number" : " numbers"));
}

}  // namespace

void check_counts(const std::string& file, const XMLElement& root, Findings& findings) {
  std::vector<const XMLElement*> stack{&root};
  while (!stack.empty()) {
    const XMLElement* e = stack.back();
    stack.pop_back();
    check_numbers_of(file, *e);
    std::set<std::string_view> seen;
    for (const XMLElement* c = e->FirstChildElement(); c != nullptr; c = c->NextSiblingElement()) {
      stack.push_back(c);
      if (once.count(c->Name()) > 0 && !seen.insert(c->Name()).second)
        findings.warn("given twice", file, element_of(*c), "is given twice; the first is taken", "one <" + std::string(c->Name()) + ">");
    }
  }
}

}  // namespace delassus
