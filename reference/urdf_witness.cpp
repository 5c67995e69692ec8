// The reading of urdf_witness.h: tinyxml2 for the XML, strtod for the numbers.
#include "reference/urdf_witness.h"

#include <tinyxml2.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>

namespace delassus::reference {
namespace {

using tinyxml2::XMLElement;
using Kind = UrdfWitness::Kind;

[[noreturn]] void refuse(const XMLElement* e, const std::string& why) {
  throw std::runtime_error(e == nullptr ? why : "<" + std::string(e->Name()) + "> in line " + std::to_string(e->GetLineNum()) + ": " + why);
}

/// The numbers of an attribute: decimal, finite, between blanks.
std::vector<double> numbers(const XMLElement* e, const char* attribute) {
  const char* text = e->Attribute(attribute);
  if (text == nullptr) refuse(e, std::string(attribute) + " is missing");
  std::vector<double> out;
  for (const char* at = text; *at != '\0';) {
    const std::string word(at, std::strcspn(at, " \t\r\n"));
    at += word.size() + (at[word.size()] != '\0');
    if (word.empty()) continue;
    char* end = nullptr;
    const double x = std::strtod(word.c_str(), &end);
    if (word.find_first_not_of("0123456789+-.eE") != std::string::npos || *end != '\0' || !std::isfinite(x))
      refuse(e, std::string(attribute) + " has no number at '" + word + "'");
    out.push_back(x);
  }
  return out;
}

double number(const XMLElement* e, const char* attribute) {
  const std::vector<double> x = numbers(e, attribute);
  if (x.size() != 1) refuse(e, std::string(attribute) + " is not one number");
  return x[0];
}

UrdfWitness::Triple triple(const XMLElement* e, const char* attribute) {
  const std::vector<double> x = numbers(e, attribute);
  if (x.size() != 3) refuse(e, std::string(attribute) + " is not three numbers");
  return {x[0], x[1], x[2]};
}

std::string text(const XMLElement* e, const char* attribute) {
  const char* t = e->Attribute(attribute);
  if (t == nullptr || *t == '\0') refuse(e, std::string(attribute) + " is missing");
  return t;
}

void origin(const XMLElement* parent, UrdfWitness::Triple& xyz, UrdfWitness::Triple& rpy) {
  const XMLElement* e = parent->FirstChildElement("origin");
  if (e == nullptr) return;
  if (e->Attribute("xyz") != nullptr) xyz = triple(e, "xyz");
  if (e->Attribute("rpy") != nullptr) rpy = triple(e, "rpy");
}

class Reader {
 public:
  UrdfWitness read(const std::string& bytes) {
    if (bytes.find('\0') != std::string::npos) refuse(nullptr, "a NUL byte");
    tinyxml2::XMLDocument document;
    if (document.Parse(bytes.c_str(), bytes.size()) != tinyxml2::XML_SUCCESS) refuse(nullptr, document.ErrorName());
    const XMLElement* robot = document.RootElement();
    if (robot == nullptr) refuse(nullptr, "no root element");
    if (robot->NextSiblingElement() != nullptr) refuse(robot->NextSiblingElement(), "a second root element");
    if (std::string(robot->Name()) != "robot") refuse(robot, "no robot");
    attributes_once(robot);
    for (const XMLElement* e = robot->FirstChildElement("link"); e; e = e->NextSiblingElement("link")) link(e);
    for (const XMLElement* e = robot->FirstChildElement("joint"); e; e = e->NextSiblingElement("joint")) joint(e);
    vocabulary(robot);
    order();
    return std::move(out_);
  }

 private:
  /// XML allows an attribute once; tinyxml2 does not look. Iterative, for files nested without end.
  static void attributes_once(const XMLElement* root) {
    std::vector<const XMLElement*> pending{root};
    while (!pending.empty()) {
      const XMLElement* e = pending.back();
      pending.pop_back();
      std::set<std::string> seen;
      for (const auto* a = e->FirstAttribute(); a; a = a->Next())
        if (!seen.insert(a->Name()).second) refuse(e, std::string(a->Name()) + " is given twice");
      for (const XMLElement* c = e->FirstChildElement(); c; c = c->NextSiblingElement()) pending.push_back(c);
    }
  }

  void link(const XMLElement* e) {
    UrdfWitness::Link l;
    l.name = text(e, "name");
    if (!link_.emplace(l.name, static_cast<Index>(out_.links.size())).second) refuse(e, "the name " + l.name + " twice");
    if (const XMLElement* in = e->FirstChildElement("inertial")) {
      origin(in, l.com, l.rpy);
      const XMLElement* m = in->FirstChildElement("mass");
      const XMLElement* I = in->FirstChildElement("inertia");
      if (m == nullptr || I == nullptr) refuse(in, "no mass or no inertia");
      l.mass = number(m, "value");
      const char* names[] = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
      for (std::size_t k = 0; k < 6; ++k) l.inertia[k] = number(I, names[k]);
    }
    out_.links.push_back(l);
  }

  void joint(const XMLElement* e) {
    static const std::map<std::string, Kind> kinds{
        {"fixed", Kind::fixed}, {"revolute", Kind::revolute}, {"continuous", Kind::revolute},
        {"prismatic", Kind::prismatic}, {"planar", Kind::planar}, {"floating", Kind::floating}};
    UrdfWitness::Joint j;
    j.name = text(e, "name");
    if (!joint_.insert(j.name).second) refuse(e, "the name " + j.name + " twice");
    const auto kind = kinds.find(text(e, "type"));
    if (kind == kinds.end()) refuse(e, "type " + text(e, "type"));
    j.kind = kind->second;
    j.parent = end(e, "parent");
    j.child = end(e, "child");
    origin(e, j.xyz, j.rpy);
    if (const XMLElement* axis = e->FirstChildElement("axis"); axis && j.kind != Kind::fixed && j.kind != Kind::floating) {
      j.axis = triple(axis, "xyz");
      if (j.axis == UrdfWitness::Triple{}) refuse(axis, "no direction");
    }
    if (const XMLElement* d = e->FirstChildElement("dynamics"); d && d->Attribute("armature")) j.armature = number(d, "armature");
    if (const XMLElement* m = e->FirstChildElement("mimic"); m && j.kind != Kind::fixed) {
      j.master = text(m, "joint");
      if (m->Attribute("multiplier") != nullptr) j.multiplier = number(m, "multiplier");
    }
    UrdfWitness::Link& child = out_.links[static_cast<std::size_t>(j.child)];
    if (child.joint >= 0) refuse(e, "a second parent of " + child.name);
    child.joint = static_cast<Index>(out_.joints.size());
    out_.joints.push_back(j);
  }

  Index end(const XMLElement* joint, const char* which) const {
    const XMLElement* e = joint->FirstChildElement(which);
    if (e == nullptr) refuse(joint, std::string("no ") + which);
    const auto it = link_.find(text(e, "link"));
    if (it == link_.end()) refuse(e, "no link " + text(e, "link"));
    return it->second;
  }

  /// Elements of `parent` that are not in `once` (at most one of each) or `many`.
  void only(const XMLElement* parent, const std::set<std::string>& once, const std::set<std::string>& many) {
    std::set<std::string> seen;
    for (const XMLElement* e = parent->FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string name = e->Name();
      const bool twice = once.count(name) && !seen.insert(name).second;
      if (twice || (!once.count(name) && !many.count(name)))
        out_.doubtful.push_back("<" + name + "> in line " + std::to_string(e->GetLineNum()) + (twice ? " is a second one" : " is unknown"));
    }
  }

  void vocabulary(const XMLElement* robot) {
    only(robot, {}, {"link", "joint", "material", "transmission", "gazebo", "sensor"});
    for (const XMLElement* e = robot->FirstChildElement("link"); e; e = e->NextSiblingElement("link")) {
      only(e, {"inertial"}, {"visual", "collision"});
      if (const XMLElement* in = e->FirstChildElement("inertial")) only(in, {"origin", "mass", "inertia"}, {});
    }
    for (const XMLElement* e = robot->FirstChildElement("joint"); e; e = e->NextSiblingElement("joint"))
      only(e, {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "calibration", "safety_controller"}, {});
  }

  void order() {
    if (out_.links.empty()) refuse(nullptr, "no link");
    std::vector<std::vector<Index>> children(out_.links.size());
    Index roots = 0;
    for (std::size_t i = 0; i < out_.links.size(); ++i) {
      const Index j = out_.links[i].joint;
      if (j >= 0) children[static_cast<std::size_t>(out_.joints[static_cast<std::size_t>(j)].parent)].push_back(static_cast<Index>(i));
      else out_.root = static_cast<Index>(i), ++roots;
    }
    if (roots != 1) refuse(nullptr, std::to_string(roots) + " links without a parent");
    out_.order.push_back(out_.root);
    for (std::size_t k = 0; k < out_.order.size(); ++k)
      for (const Index c : children[static_cast<std::size_t>(out_.order[k])]) out_.order.push_back(c);
    if (out_.order.size() != out_.links.size()) refuse(nullptr, "a cycle of joints");
  }

  UrdfWitness out_;
  std::map<std::string, Index> link_;
  std::set<std::string> joint_;
};

}  // namespace

double UrdfWitness::total_mass() const {
  double sum = 0;
  for (const Link& l : links) sum += l.mass;
  return sum;
}

Index UrdfWitness::moving() const {
  Index n = 0;
  for (const Joint& j : joints) n += j.kind != Kind::fixed;
  return n;
}

std::vector<Index> UrdfWitness::leaves() const {
  std::vector<char> has_child(links.size()), moved(links.size());
  for (const Joint& j : joints) has_child[static_cast<std::size_t>(j.parent)] = 1;
  std::vector<Index> out;
  for (const Index i : order) {
    const auto k = static_cast<std::size_t>(i);
    if (i == root) continue;
    const Joint& j = joints[static_cast<std::size_t>(links[k].joint)];
    moved[k] = moved[static_cast<std::size_t>(j.parent)] || j.kind != Kind::fixed;
    if (moved[k] && !has_child[k]) out.push_back(i);
  }
  return out;
}

UrdfWitness parse_urdf_witness(const std::string& bytes) { return Reader().read(bytes); }

UrdfWitness read_urdf_witness(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot be read");
  return parse_urdf_witness({std::istreambuf_iterator<char>(in), {}});
}

}  // namespace delassus::reference
