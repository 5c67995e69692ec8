// Joints of a URDF. What a fixed joint does not use is neither read nor judged.
#include <algorithm>
#include <array>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "models/formats/urdf_check.h"

namespace delassus {
namespace {

using tinyxml2::XMLElement;

/// A number, or ±infinity written as inf or infinity, which urdfdom cannot read: `limited` is false then, and the attribute 0.
double limit_or(const Place& place, XMLElement& e, const char* attribute, const std::string& unit, double other, bool& limited) {
  const char* text = e.Attribute(attribute);
  limited = text != nullptr;
  if (!limited) return other;
  for (const std::string_view word : {"inf", "Inf", "INF", "infinity", "Infinity", ".inf"})
    for (const char* sign : {"", "+", "-"})
      if (text == sign + std::string(word)) {
        limited = false;
        e.SetAttribute(attribute, "0");
        return *sign == '-' ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
      }
  return number(place, e, attribute, unit);
}

void read_range(const Place& place, XMLElement& e, CheckedUrdf::JointRow& row, Findings& findings, Tally& tally) {
  const bool given = e.Attribute("lower") != nullptr || e.Attribute("upper") != nullptr;
  bool lower = false, upper = false;
  row.lower = limit_or(place, e, "lower", " [rad or m]", 0, lower);
  row.upper = limit_or(place, e, "upper", " [rad or m]", 0, upper);
  if (row.type != "revolute" && row.type != "prismatic") return;
  row.range_given = given;
  if (!given) {
    tally.add("limits with neither lower nor upper, taken as none", place.element(e));
  } else if (row.lower > row.upper) {
    findings.warn("reversed limits", place.file, place.element(e),
                  "lower = " + number_text(row.lower) + " is above upper = " + number_text(row.upper) + " [rad or m]: taken as without limits",
                  "lower <= upper");
    row.range_given = false;
  }
}

void read_limit(const Place& place, XMLElement& joint, CheckedUrdf::JointRow& row, Findings& findings, Tally& tally) {
  XMLElement* e = joint.FirstChildElement("limit");
  if (e == nullptr) {
    if (row.type != "revolute" && row.type != "prismatic") return;
    findings.warn("no limits", place.file, place.element(joint), row.type + " without <limit>: taken as without limits",
                  "<limit lower upper effort velocity/>, or type continuous");
    e = joint.InsertNewChildElement("limit");
  } else {
    read_range(place, *e, row, findings, tally);
  }
  struct {
    const char* name;
    double& value;
    bool& given;
  } rows[] = {{"effort", row.effort, row.effort_given}, {"velocity", row.velocity, row.velocity_given}};
  for (auto& r : rows) {
    r.value = limit_or(place, *e, r.name, "", 0, r.given);
    if (!r.given) {
      e->SetAttribute(r.name, "0");  // urdfdom insists
      r.value = 0;
    } else if (r.value < 0) {
      tally.add("negative, taken as no limit", place.element(*e) + " " + r.name + " = " + number_text(r.value));
      r.given = false;
    }
  }
}

void read_dynamics(const Place& place, XMLElement& joint, CheckedUrdf::JointRow& row) {
  XMLElement* e = joint.FirstChildElement("dynamics");
  if (e == nullptr) return;
  row.armature_given = e->Attribute("armature") != nullptr;
  struct {
    const char *name, *unit;
    double& value;
  } rows[] = {{"damping", " >= 0 [N m s/rad or N s/m]", row.damping}, {"friction", " >= 0 [N m or N]", row.friction},
              {"armature", " >= 0 [kg m^2 or kg]", row.armature}};
  for (auto& r : rows) {
    r.value = number_or(place, *e, r.name, r.unit, 0);
    if (r.value < 0) place.fail(*e, std::string(r.name) + " = " + number_text(r.value) + " is negative", "a number" + std::string(r.unit) + "; correct the sign, or leave it out for 0");
  }
  if (e->Attribute("damping") == nullptr) e->SetAttribute("damping", "0");
}

void read_axis(const Place& place, XMLElement& joint, CheckedUrdf::JointRow& row) {
  XMLElement* e = joint.FirstChildElement("axis");
  if (e == nullptr) return;
  if (row.type == "floating") return joint.DeleteChild(e);
  row.axis = triple(place, *e, "xyz", "");
  if (row.axis.cwiseAbs().maxCoeff() == 0)
    place.fail(*e, "axis " + in_quotes(e->Attribute("xyz")) + " has no direction", "three numbers, not all 0; leave <axis> out for 1 0 0, or make the joint fixed");
}

void read_mimic(const Place& place, XMLElement& joint, CheckedUrdf::JointRow& row) {
  XMLElement* e = joint.FirstChildElement("mimic");
  if (e == nullptr) return;
  row.master = name_of(place, *e, "joint");
  row.multiplier = number_or(place, *e, "multiplier", "", 1);
  row.offset = number_or(place, *e, "offset", " [rad or m]", 0);
}

/// Only the frame and the two links of a fixed joint mean anything.
void strip_fixed(const Place& place, XMLElement& joint, Tally& tally) {
  if (joint.FirstChildElement("mimic") != nullptr)
    tally.add("a fixed joint follows nothing, its <mimic> is left out", place.element(joint));
  for (const char* part : {"axis", "limit", "dynamics", "mimic"})
    while (XMLElement* x = joint.FirstChildElement(part)) joint.DeleteChild(x);
}

}  // namespace

CheckedUrdf::JointRow joint_row(const std::string& file, XMLElement& e, Findings& findings, Tally& tally) {
  CheckedUrdf::JointRow row;
  row.name = name_of(Place{file, ""}, e);
  const Place place{file, "joint " + in_quotes(row.name)};
  row.place = place.element(e);
  constexpr std::array<std::string_view, 6> types{"revolute", "continuous", "prismatic", "fixed", "floating", "planar"};
  row.type = name_of(place, e, "type");
  if (std::find(types.begin(), types.end(), row.type) == types.end())
    place.fail(e, "type " + in_quotes(row.type) + " is unknown", did_you_mean(row.type, types) + "revolute, continuous, prismatic, fixed, floating, planar; ball, universal and cylindrical joints by joint_types of the scene");
  for (const char* end : {"parent", "child"}) {
    const XMLElement* x = e.FirstChildElement(end);
    if (x == nullptr) place.fail(e, "<" + std::string(end) + "> is missing", "<" + std::string(end) + " link=\"...\"/>; a joint joins two links");
    (end[0] == 'p' ? row.parent : row.child) = name_of(place, *x, "link");
  }
  row.origin = origin(place, e);
  if (row.fixed()) {
    strip_fixed(place, e, tally);
    return row;
  }
  read_axis(place, e, row);
  read_limit(place, e, row, findings, tally);
  read_dynamics(place, e, row);
  read_mimic(place, e, row);
  return row;
}

}  // namespace delassus
