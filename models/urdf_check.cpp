#include "models/urdf_check.h"

#include <tinyxml2.h>

#include <array>
#include <set>

#include <Eigen/Dense>

#include "models/message.h"
#include "models/robot.h"

namespace delassus {
namespace {

using tinyxml2::XMLElement;

/// Names the element in messages: `link "arm" <inertia> (line 7)`.
struct Place {
  const std::string& file;
  std::string owner;  // `link "arm"`

  [[noreturn]] void fail(const XMLElement& e, const std::string& problem, const std::string& accepted) const {
    std::string where = owner;
    if (owner.empty() || owner.rfind(e.Name(), 0) != 0) where += (where.empty() ? "<" : " <") + std::string(e.Name()) + ">";
    throw ModelError(file, where + " (line " + std::to_string(e.GetLineNum()) + ")", problem, accepted);
  }
};

std::vector<double> numbers(const Place& place, const XMLElement& e, const char* attribute, std::size_t count,
                            const std::string& unit) {
  const std::string accepted = std::to_string(count) + (count == 1 ? " finite number" : " finite numbers") + unit;
  const char* text = e.Attribute(attribute);
  if (text == nullptr) place.fail(e, "attribute " + std::string(attribute) + " is missing", accepted);
  std::vector<double> out;
  std::string_view rest(text);
  while (true) {
    const std::size_t first = rest.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) break;
    rest.remove_prefix(first);
    const std::size_t length = std::min(rest.find_first_of(" \t\r\n"), rest.size());
    const auto value = finite_number(rest.substr(0, length));
    if (!value) place.fail(e, std::string(attribute) + " = " + in_quotes(text) + " is not finite", accepted);
    out.push_back(*value);
    if (out.size() > count) break;
    rest.remove_prefix(length);
  }
  if (out.size() != count) place.fail(e, std::string(attribute) + " = " + in_quotes(text) + " has the wrong length", accepted);
  return out;
}

double number(const Place& place, const XMLElement& e, const char* attribute, const std::string& unit) {
  return numbers(place, e, attribute, 1, unit)[0];
}

double number_or(const Place& place, const XMLElement& e, const char* attribute, const std::string& unit, double other) {
  return e.Attribute(attribute) == nullptr ? other : number(place, e, attribute, unit);
}

Vector3<double> triple(const Place& place, const XMLElement& e, const char* attribute, const std::string& unit) {
  const std::vector<double> v = numbers(place, e, attribute, 3, unit);
  return {v[0], v[1], v[2]};
}

Pose<double> origin(const Place& place, const XMLElement& parent) {
  Pose<double> pose;
  const XMLElement* e = parent.FirstChildElement("origin");
  if (e == nullptr) return pose;
  if (e->Attribute("xyz") != nullptr) pose.translation = triple(place, *e, "xyz", " [m]");
  if (e->Attribute("rpy") != nullptr) pose.rotation = rotation_rpy(triple(place, *e, "rpy", " [rad]"));
  return pose;
}

std::string name_of(const Place& place, const XMLElement& e, const char* attribute = "name") {
  const char* text = e.Attribute(attribute);
  if (text == nullptr || *text == '\0')
    place.fail(e, "attribute " + std::string(attribute) + " is missing or empty", "a name");
  return text;
}

/// Positive semidefinite and λ3 ≤ λ1 + λ2, within the backward error of the symmetric eigenvalue problem.
void check_inertia(const Place& place, const XMLElement& e, double mass) {
  std::array<double, 6> v{};
  constexpr std::array<const char*, 6> names{"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
  for (std::size_t i = 0; i < 6; ++i) v[i] = number(place, e, names[i], " [kg m^2]");
  Matrix3<double> I;
  I << v[0], v[1], v[2], v[1], v[3], v[4], v[2], v[4], v[5];
  const double scale = I.cwiseAbs().maxCoeff();
  if (scale == 0) return;
  const std::string accepted = "principal moments l1 <= l2 <= l3 [kg m^2] with l1 >= 0 and l3 <= l1 + l2";
  const Vector3<double> l = scale * Matrix3<double>(I / scale).selfadjointView<Eigen::Lower>().eigenvalues();
  const double rounding = 30 * std::numeric_limits<double>::epsilon() * scale;
  const std::string found = "principal moments " + std::to_string(l[0]) + ", " + std::to_string(l[1]) + ", " + std::to_string(l[2]);
  if (l[0] < -rounding) place.fail(e, found + " [kg m^2]: one is negative", accepted);
  if (l[2] - l[1] - l[0] > rounding) place.fail(e, found + " [kg m^2] break the triangle inequality", accepted);
  if (mass == 0) place.fail(e, "a link of mass 0 has an inertia", "mass > 0 [kg], or mass and inertia both 0");
}

void check_inertial(const Place& place, const XMLElement& link) {
  const XMLElement* e = link.FirstChildElement("inertial");
  if (e == nullptr) return;
  (void)origin(place, *e);
  const XMLElement* m = e->FirstChildElement("mass");
  const XMLElement* I = e->FirstChildElement("inertia");
  if (m == nullptr) place.fail(*e, "<mass> is missing", "<mass value=\"...\"/> [kg]");
  if (I == nullptr) place.fail(*e, "<inertia> is missing", "<inertia ixx ixy ixz iyy iyz izz/> [kg m^2]");
  const double mass = number(place, *m, "value", " [kg]");
  if (mass < 0) place.fail(*m, "mass = " + in_quotes(m->Attribute("value")) + " kg is negative", "mass >= 0 [kg]");
  check_inertia(place, *I, mass);
}

double positive(const Place& place, const XMLElement& e, const char* attribute) {
  const double value = number(place, e, attribute, " > 0 [m]");
  if (!(value > 0)) place.fail(e, std::string(attribute) + " = " + in_quotes(e.Attribute(attribute)) + " m", "a length > 0 [m]");
  return value;
}

/// The primitives of a link; meshes are counted.
std::vector<Shape> shapes_of(const Place& place, const XMLElement& link, int& meshes) {
  std::vector<Shape> out;
  for (const XMLElement* c = link.FirstChildElement("collision"); c; c = c->NextSiblingElement("collision")) {
    Shape shape;
    shape.placement = origin(place, *c);
    const XMLElement* geometry = c->FirstChildElement("geometry");
    const XMLElement* g = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    if (g == nullptr) place.fail(*c, "has no geometry", "box, cylinder, sphere, capsule or mesh");
    const std::string kind = g->Name();
    if (kind == "mesh") {
      ++meshes;
      continue;
    }
    if (kind == "box") {
      shape.kind = Shape::Kind::box;
      shape.size = triple(place, *g, "size", " [m]") / 2;
      if (!(shape.size.minCoeff() > 0)) place.fail(*g, "size = " + in_quotes(g->Attribute("size")) + " m", "lengths > 0 [m]");
    } else if (kind == "sphere") {
      shape.kind = Shape::Kind::sphere;
      shape.size[0] = positive(place, *g, "radius");
    } else if (kind == "cylinder" || kind == "capsule") {
      shape.kind = kind == "cylinder" ? Shape::Kind::cylinder : Shape::Kind::capsule;
      shape.size = {positive(place, *g, "radius"), positive(place, *g, "length") / 2, 0};
    } else {
      place.fail(*g, "unknown geometry", "box, cylinder, sphere, capsule or mesh");
    }
    out.push_back(shape);
  }
  return out;
}

void check_limit(const Place& place, XMLElement& joint, CheckedUrdf::JointRow& row) {
  XMLElement* e = joint.FirstChildElement("limit");
  if (e == nullptr) return;
  const double lower = number_or(place, *e, "lower", " [rad or m]", 0);
  const double upper = number_or(place, *e, "upper", " [rad or m]", 0);
  if (lower > upper) place.fail(*e, "lower is above upper", "lower <= upper [rad or m]");
  row.range_given = e->Attribute("lower") != nullptr || e->Attribute("upper") != nullptr;
  row.effort_given = e->Attribute("effort") != nullptr;
  row.velocity_given = e->Attribute("velocity") != nullptr;
  for (const char* a : {"effort", "velocity"}) {
    if (number_or(place, *e, a, "", 0) < 0) place.fail(*e, std::string(a) + " = " + in_quotes(e->Attribute(a)) + " is negative", "a number >= 0");
    if (e->Attribute(a) == nullptr) e->SetAttribute(a, "0");  // urdfdom insists; 'given' remembers
  }
}

void check_dynamics(const Place& place, XMLElement& joint, CheckedUrdf::JointRow& row) {
  XMLElement* e = joint.FirstChildElement("dynamics");
  if (e == nullptr) return;
  for (const char* a : {"damping", "friction", "armature"})
    if (number_or(place, *e, a, "", 0) < 0) place.fail(*e, std::string(a) + " = " + in_quotes(e->Attribute(a)) + " is negative", "a number >= 0");
  row.armature = number_or(place, *e, "armature", " [kg m^2 or kg]", 0);
  if (e->Attribute("damping") == nullptr) e->SetAttribute("damping", "0");
}

void check_axis(const Place& place, const XMLElement& joint) {
  const XMLElement* e = joint.FirstChildElement("axis");
  if (e == nullptr) return;
  if (triple(place, *e, "xyz", "").norm() == 0)
    place.fail(*e, "axis " + in_quotes(e->Attribute("xyz")) + " has no direction", "three numbers, not all 0");
}

CheckedUrdf::JointRow joint_row(const std::string& file, XMLElement& e) {
  const Place top{file, ""};
  CheckedUrdf::JointRow row;
  row.name = name_of(top, e);
  row.line = e.GetLineNum();
  const Place place{file, "joint " + in_quotes(row.name)};
  const std::set<std::string> types{"revolute", "continuous", "prismatic", "fixed", "floating", "planar"};
  const std::string type = name_of(place, e, "type");
  if (!types.count(type)) place.fail(e, "type " + in_quotes(type) + " is unknown", "revolute, continuous, prismatic, fixed, floating, planar");
  for (const char* end : {"parent", "child"}) {
    const XMLElement* x = e.FirstChildElement(end);
    if (x == nullptr) place.fail(e, "<" + std::string(end) + "> is missing", "<" + std::string(end) + " link=\"...\"/>");
    (end[0] == 'p' ? row.parent : row.child) = name_of(place, *x, "link");
  }
  (void)origin(place, e);
  check_axis(place, e);
  check_limit(place, e, row);
  if ((type == "revolute" || type == "prismatic") && !e.FirstChildElement("limit"))
    place.fail(e, type + " without <limit>", "<limit lower upper effort velocity/>, or type continuous");
  check_dynamics(place, e, row);
  if (const XMLElement* m = e.FirstChildElement("mimic")) {
    (void)name_of(place, *m, "joint");
    (void)number_or(place, *m, "multiplier", "", 1);
    (void)number_or(place, *m, "offset", " [rad or m]", 0);
  }
  return row;
}

/// One root, one parent per link, no cycle.
void check_tree(const std::string& file, CheckedUrdf& out) {
  std::map<std::string, const CheckedUrdf::JointRow*> parent_joint;
  for (std::size_t j = 0; j < out.joints.size(); ++j) {
    const CheckedUrdf::JointRow& row = out.joints[j];
    const std::string element = "joint " + in_quotes(row.name) + " (line " + std::to_string(row.line) + ")";
    for (const std::string* link : {&row.parent, &row.child})
      if (!out.link_lines.count(*link)) throw ModelError(file, element, "link " + in_quotes(*link) + " does not exist", "a link of this file");
    if (row.parent == row.child) throw ModelError(file, element, "joins link " + in_quotes(row.parent) + " to itself", "two different links");
    const auto [it, first] = parent_joint.emplace(row.child, &row);
    if (!first)
      throw ModelError(file, element, "link " + in_quotes(row.child) + " already has the parent joint " + in_quotes(it->second->name),
                       "a tree: close loops with a constraint of the scene");
    out.children[row.parent].push_back(static_cast<Index>(j));
  }
  for (const auto& [link, line] : out.link_lines) {
    if (parent_joint.count(link)) continue;
    if (!out.root.empty())
      throw ModelError(file, "link " + in_quotes(link) + " (line " + std::to_string(line) + ")",
                       "is a second root besides link " + in_quotes(out.root), "one link without a parent");
    out.root = link;
  }
  if (out.root.empty()) throw ModelError(file, "robot", "every link has a parent: the joints form a cycle", "a tree");
  std::size_t reached = 0;
  std::vector<const std::string*> stack{&out.root};
  for (; !stack.empty(); ++reached) {
    const auto it = out.children.find(*stack.back());
    stack.pop_back();
    if (it != out.children.end())
      for (const Index j : it->second) stack.push_back(&out.joints[static_cast<std::size_t>(j)].child);
  }
  if (reached != out.link_lines.size()) throw ModelError(file, "robot", "some joints form a cycle apart from the root", "a tree");
}

void check_link(const std::string& file, const XMLElement& e, CheckedUrdf& out, int& meshes) {
  const std::string name = name_of(Place{file, ""}, e);
  const Place place{file, "link " + in_quotes(name)};
  if (!out.link_lines.emplace(name, e.GetLineNum()).second) place.fail(e, "the name is taken", "unique link names");
  check_inertial(place, e);
  std::vector<Shape> shapes = shapes_of(place, e, meshes);
  if (!shapes.empty()) out.shapes[name] = std::move(shapes);
}

void strip(XMLElement& robot) {
  robot.DeleteAttribute("version");
  for (XMLElement* e = robot.FirstChildElement(); e;) {
    XMLElement* next = e->NextSiblingElement();
    const std::string_view kind = e->Name();
    if (kind != "link" && kind != "joint") robot.DeleteChild(e);
    else for (const char* part : {"visual", "collision", "calibration", "safety_controller"})
      while (XMLElement* x = e->FirstChildElement(part)) e->DeleteChild(x);
    e = next;
  }
}

}  // namespace

CheckedUrdf check_urdf(const std::string& file) {
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLError error = document.LoadFile(file.c_str());
  if (error == tinyxml2::XML_ERROR_FILE_NOT_FOUND || error == tinyxml2::XML_ERROR_FILE_COULD_NOT_BE_OPENED ||
      error == tinyxml2::XML_ERROR_FILE_READ_ERROR)
    throw ModelError(file, "file", "cannot be read", "a URDF file");
  if (error != tinyxml2::XML_SUCCESS)
    throw ModelError(file, "line " + std::to_string(document.ErrorLineNum()), "broken XML: " + std::string(document.ErrorName()),
                     "well-formed XML");
  XMLElement* robot = document.RootElement();
  if (std::string_view(robot->Name()) != "robot")
    throw ModelError(file, "root element", in_quotes(robot->Name()) + " is no robot", "<robot name=\"...\">");
  (void)name_of(Place{file, ""}, *robot);
  CheckedUrdf out;
  std::set<std::string> joint_names;
  int meshes = 0;
  for (XMLElement* e = robot->FirstChildElement(); e; e = e->NextSiblingElement()) {
    if (std::string_view(e->Name()) == "link") check_link(file, *e, out, meshes);
    if (std::string_view(e->Name()) != "joint") continue;
    out.joints.push_back(joint_row(file, *e));
    if (!joint_names.insert(out.joints.back().name).second)
      Place{file, "joint " + in_quotes(out.joints.back().name)}.fail(*e, "the name is taken", "unique joint names");
  }
  if (out.link_lines.empty()) throw ModelError(file, "robot", "has no link", "at least one link");
  check_tree(file, out);
  if (meshes > 0) out.notes.push_back(file + ": " + std::to_string(meshes) + " collision meshes left out");
  strip(*robot);
  tinyxml2::XMLPrinter printer(nullptr, true);
  document.Print(&printer);
  out.text = printer.CStr();
  return out;
}

}  // namespace delassus
