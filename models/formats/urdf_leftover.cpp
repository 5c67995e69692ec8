// What a URDF holds beyond what is read: said, and taken out of the XML.
#include <algorithm>
#include <string_view>

#include "algorithms/errors/message.h"
#include "models/formats/urdf_check.h"

namespace delassus {
namespace {

using tinyxml2::XMLElement;
using Names = std::vector<std::string_view>;

/// What is known of an element: the children and attributes that are read, and the children that cannot matter.
struct Known {
  std::string_view element;
  Names read, silent, attributes;
  bool many;  // children may repeat
};

const std::vector<Known>& known_elements() {
  static const std::vector<Known> table{
      {"robot", {"link", "joint"}, {"material"}, {}, true},
      {"link", {"inertial", "collision"}, {"visual"}, {"name"}, true},
      {"inertial", {"origin", "mass", "inertia"}, {}, {}, false},
      {"collision", {"origin", "geometry"}, {"material", "verbose"}, {"name", "group"}, false},
      {"geometry", {"box", "sphere", "cylinder", "capsule", "mesh"}, {}, {}, false},
      {"joint", {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic"}, {"calibration", "safety_controller"}, {"name", "type"}, false},
      {"origin", {}, {}, {"xyz", "rpy"}, false},
      {"mass", {}, {}, {"value"}, false},
      {"inertia", {}, {}, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}, false},
      {"box", {}, {}, {"size"}, false},
      {"sphere", {}, {}, {"radius"}, false},
      {"cylinder", {}, {}, {"radius", "length"}, false},
      {"capsule", {}, {}, {"radius", "length"}, false},
      {"mesh", {}, {}, {"filename", "scale"}, false},
      {"parent", {}, {}, {"link"}, false},
      {"child", {}, {}, {"link"}, false},
      {"axis", {}, {}, {"xyz"}, false},
      {"limit", {}, {}, {"lower", "upper", "effort", "velocity"}, false},
      {"dynamics", {}, {}, {"damping", "friction", "armature"}, false},
      {"mimic", {}, {}, {"joint", "multiplier", "offset"}, false}};
  return table;
}

bool among(const Names& names, std::string_view name) { return std::find(names.begin(), names.end(), name) != names.end(); }

bool holds_joint(const XMLElement& e) {
  for (const XMLElement* c = e.FirstChildElement(); c; c = c->NextSiblingElement())
    if (std::string_view(c->Name()) == "joint" || holds_joint(*c)) return true;
  return false;
}

/// The first mechanical reduction other than 1 in a transmission; "" when there is none.
std::string reduction(const XMLElement& e) {
  for (const XMLElement* c = e.FirstChildElement(); c; c = c->NextSiblingElement()) {
    const std::string_view name = c->Name();
    if ((name == "mechanicalReduction" || name == "mechanical_reduction") && c->GetText() != nullptr && finite_number(c->GetText()) != 1)
      return c->GetText();
    if (std::string inner = reduction(*c); !inner.empty()) return inner;
  }
  return {};
}

class Walk {
 public:
  Walk(const std::string& file, Findings& findings) : file_(file), findings_(findings) {}

  void visit(XMLElement& e, const std::string& owner) {
    const std::string_view name = e.Name();
    const auto& table = known_elements();
    const auto row = std::find_if(table.begin(), table.end(), [&](const Known& k) { return k.element == name; });
    if (row == table.end()) return;
    attributes(e, *row);
    Names seen;
    for (XMLElement* c = e.FirstChildElement(); c;) {
      XMLElement* next = c->NextSiblingElement();
      const std::string_view child = c->Name();
      const bool read = among(row->read, child);
      const char* own = c->Attribute("name");
      const bool names_owner = name == "robot" && own != nullptr;
      const Place place{file_, names_owner ? std::string(child) + " " + in_quotes(own) : owner};
      if (read && (!row->many || child == "inertial") && among(seen, child)) {
        findings_.warn("given twice", file_, place.element(*c), "a second <" + std::string(child) + "> is left out", "one <" + std::string(child) + ">; the first is read");
        e.DeleteChild(c);
      } else if (read) {
        seen.push_back(child);
        visit(*c, place.owner);
      } else {
        if (!among(row->silent, child)) say(*c, place, name);
        e.DeleteChild(c);
      }
      c = next;
    }
  }

  void report() {
    if (!left_.empty()) {
      std::string text;
      for (const Left& l : left_)
        text += (text.empty() ? "" : ", ") + in_quotes(l.what) + (l.count > 1 ? " (" + std::to_string(l.count) + ", first in line " : " (line ") + std::to_string(l.line) + ")";
      findings_.note(file_ + ": left out, not read: " + text);
    }
    if (reductions_ > 0)
      findings_.note(file_ + ": " + std::to_string(reductions_) + (reductions_ == 1 ? " transmission has" : " transmissions have") +
                     " a mechanical reduction, the first of " + in_quotes(first_reduction_) +
                     ": rotors are no part of a URDF; armature = reduction^2 * rotor inertia [kg m^2 or kg] adds them");
  }

 private:
  struct Left {
    std::string what;
    int count, line;
  };

  void count(const std::string& what, int line) {
    const auto it = std::find_if(left_.begin(), left_.end(), [&](const Left& l) { return l.what == what; });
    if (it != left_.end()) ++it->count;
    else left_.push_back({what, 1, line});
  }

  void attributes(const XMLElement& e, const Known& row) {
    if (row.element == "robot") return;
    for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a; a = a->Next())
      if (!among(row.attributes, a->Name())) count(std::string(e.Name()) + " " + a->Name() + "=", e.GetLineNum());
  }

  void say(const XMLElement& e, const Place& place, std::string_view parent) {
    const std::string name = e.Name();
    if (name.find(':') != std::string::npos && name.rfind("xacro", 0) == 0) {
      findings_.warn("unexpanded xacro", file_, place.element(e), name + " is not expanded and left out", "run xacro first");
    } else if (name == "loop_joint") {
      findings_.warn("loop left out", file_, place.element(e), "the loop is left out", "close it with a constraint of the scene");
    } else if (name == "gazebo" && holds_joint(e)) {
      findings_.warn("loop left out", file_, place.element(e), "holds a joint, which is left out", "when it closes a loop: close it with a constraint of the scene");
    } else if (const std::string r = name == "transmission" ? reduction(e) : std::string(); !r.empty()) {
      if (reductions_++ == 0) first_reduction_ = r;
    } else {
      count(parent == "robot" ? name : std::string(parent) + "/" + name, e.GetLineNum());
    }
  }

  const std::string& file_;
  Findings& findings_;
  std::vector<Left> left_;
  int reductions_ = 0;
  std::string first_reduction_;
};

}  // namespace

void leave_out(const std::string& file, XMLElement& robot, Findings& findings) {
  Walk walk(file, findings);
  walk.visit(robot, "");
  walk.report();
}

}  // namespace delassus
