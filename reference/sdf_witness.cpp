// The reading of sdf_witness.h: tinyxml2 for the XML, strtod for the numbers.
#include "algorithms/kit/test_scalars.h"
#include "reference/sdf_witness.h"

#include <tinyxml2.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

namespace delassus::reference {
namespace {

using tinyxml2::XMLElement;
using Posed = SdfWitness::Posed;
using Kind = SdfWitness::Kind;
using namespace witness;

[[noreturn]] void refuse(const XMLElement* e, const std::string& why) {
  throw std::runtime_error(e == nullptr ? why : "<" + std::string(e->Name()) + "> in line " + std::to_string(e->GetLineNum()) + ": " + why);
}

[[noreturn]] void beyond(const XMLElement* e, const std::string& what) {
  throw NotServed("<" + std::string(e->Name()) + "> in line " + std::to_string(e->GetLineNum()) + ": " + what);
}

/// Blanks around a value mean nothing in SDF, in names neither.
std::string without_blanks(const char* text) {
  const std::string all = text == nullptr ? "" : text;
  const std::size_t first = all.find_first_not_of(" \t\n\v\f\r");
  return first == std::string::npos ? "" : all.substr(first, all.find_last_not_of(" \t\n\v\f\r") + 1 - first);
}

std::string attribute(const XMLElement* e, const char* name) { return without_blanks(e == nullptr ? nullptr : e->Attribute(name)); }
std::string text_of(const XMLElement* e) { return without_blanks(e == nullptr ? nullptr : e->GetText()); }

std::vector<double> numbers(const XMLElement* e) {
  std::vector<double> out;
  std::istringstream words(e->GetText() == nullptr ? "" : e->GetText());
  for (std::string word; words >> word;) {
    char* end = nullptr;
    const double x = std::strtod(word.c_str(), &end);
    if (word.find_first_not_of("0123456789+-.eE") != std::string::npos || *end != '\0' || !std::isfinite(x)) refuse(e, "no number at '" + word + "'");
    out.push_back(x);
  }
  return out;
}

/// The number in an element below `parent`, or what SDF takes where it is not given.
double number(const XMLElement* parent, const char* name, double otherwise) {
  const XMLElement* e = parent == nullptr ? nullptr : parent->FirstChildElement(name);
  if (e == nullptr) return otherwise;
  const std::vector<double> x = numbers(e);
  if (x.size() != 1) refuse(e, "is not one number");
  return x[0];
}

bool truth(const XMLElement* parent, const char* name) {
  const std::string text = text_of(parent->FirstChildElement(name));
  return text == "true" || text == "1" || text == "True" || text == "TRUE";
}

Posed operator*(const Posed& a, const Posed& b) { return {a.X * b.X, a.reach + b.reach, a.steps + b.steps}; }

/// The numbers of a <pose>; none: the identity.
Posed own_pose(const XMLElement* e) {
  Posed out;
  if (e == nullptr) return out;
  std::vector<double> x = numbers(e);
  if (x.empty()) return out;
  const bool quaternion = attribute(e, "rotation_format") == "quat_xyzw", degrees = attribute(e, "degrees") == "true" || attribute(e, "degrees") == "1";
  if (x.size() != (quaternion ? 7u : 6u)) refuse(e, "has " + std::to_string(x.size()) + " numbers");
  out.X.p = wide({x[0], x[1], x[2]});
  if (quaternion) out.X.R = of_quaternion(x[6], wide({x[3], x[4], x[5]}));
  else {
    if (degrees) for (std::size_t k = 3; k < 6; ++k) x[k] *= 3.141592653589793 / 180;
    out.X.R = of_rpy({x[3], x[4], x[5]});
  }
  out.reach = length(out.X.p);
  return out;
}

/// What a pose is relative to; "" for the element's own rule. Versions before 1.7 called it `frame`.
std::string relative_to(const XMLElement* e) {
  const std::string name = attribute(e, "relative_to");
  return name.empty() ? attribute(e, "frame") : name;
}

/// The names of one model.
struct Scope {
  const XMLElement* model;
  Posed at;                                    ///< of the model's frame in the world
  std::string prefix;
  bool stands;
  std::map<std::string, const XMLElement*> named;   ///< links, joints, frames, nested models
};

class Reader {
 public:
  SdfWitness read(const std::string& bytes) {
    if (bytes.find('\0') != std::string::npos) refuse(nullptr, "a NUL byte");
    tinyxml2::XMLDocument document;
    if (document.Parse(bytes.c_str(), bytes.size()) != tinyxml2::XML_SUCCESS) refuse(nullptr, document.ErrorName());
    const XMLElement* root = document.RootElement();
    if (root == nullptr) refuse(nullptr, "no root element");
    if (root->NextSiblingElement() != nullptr) refuse(root->NextSiblingElement(), "a second root element");
    if (std::string(root->Name()) != "sdf") refuse(root, "no SDF");
    for (const char* old : {"1.0", "1.1", "1.2", "1.3", "1.4"}) old_axes_ = old_axes_ || attribute(root, "version") == old;
    std::vector<const XMLElement*> models;
    only_served(root);
    for (const XMLElement* m = root->FirstChildElement("model"); m; m = m->NextSiblingElement("model")) models.push_back(m);
    if (models.size() > 1) beyond(models[1], "a second model beside the root's first");
    for (const XMLElement* w = root->FirstChildElement("world"); w; w = w->NextSiblingElement("world")) {
      only_served(w);
      if (w->FirstChildElement("joint") != nullptr || w->FirstChildElement("frame") != nullptr) beyond(w, "joints and frames of a world");
      for (const XMLElement* m = w->FirstChildElement("model"); m; m = m->NextSiblingElement("model")) models.push_back(m);
    }
    for (const XMLElement* m : models) {
      if (const std::string in = relative_to(m->FirstChildElement("pose")); !in.empty() && in != "world") beyond(m, "a pose relative to " + in);
      model(m, {}, models.size() > 1 ? attribute(m, "name") + "::" : "", false);
    }
    if (out_.links.empty()) refuse(nullptr, "no link");
    tree();
    return std::move(out_);
  }

 private:
  void only_served(const XMLElement* e) const {
    if (const XMLElement* i = e->FirstChildElement("include")) beyond(i, "an include");
  }

  void once(const XMLElement* e, const std::set<std::string>& names) {
    std::set<std::string> seen;
    for (const XMLElement* c = e->FirstChildElement(); c; c = c->NextSiblingElement())
      if (names.count(c->Name()) && !seen.insert(c->Name()).second) out_.doubtful.push_back("<" + std::string(c->Name()) + "> in line " + std::to_string(c->GetLineNum()) + " is a second one");
  }

  static Scope scope_of(const XMLElement* model) {
    Scope s{model, {}, {}, false, {}};
    for (const char* kind : {"link", "joint", "frame", "model"})
      for (const XMLElement* e = model->FirstChildElement(kind); e; e = e->NextSiblingElement(kind))
        if (const auto& [it, added] = s.named.emplace(attribute(e, "name"), e); !added && std::string(it->second->Name()) == kind)
          refuse(e, "the name " + attribute(e, "name") + " twice");  // in old files a joint may have a link's name, which then means the link
    return s;
  }

  /// The frame of this name in the frame of the scope's model.
  Posed in_model(const Scope& s, const std::string& name, int depth = 0) const {
    if (depth > 200) refuse(s.model, "poses refer to each other in a circle");
    if (name == "__model__" || name.empty()) return {};
    const std::size_t colons = name.find("::");
    const auto it = s.named.find(name.substr(0, colons));
    if (it == s.named.end()) refuse(s.model, "no frame " + name);
    const XMLElement* e = it->second;
    const Posed out = of_element(s, e, depth);
    return colons == std::string::npos ? out : out * in_model(scope_of(e), name.substr(colons + 2), depth + 1);
  }

  /// Where a link, joint, frame or nested model stands in the frame of its model.
  Posed of_element(const Scope& s, const XMLElement* e, int depth = 0) const {
    const XMLElement* pose = e->FirstChildElement("pose");
    const std::string kind = e->Name();
    std::string in = relative_to(pose);
    if (in.empty() && kind == "joint") in = text_of(e->FirstChildElement("child"));
    if (in.empty() && kind == "frame") in = attribute(e, "attached_to");
    if (in == "world") refuse(e, "pose relative to the world");
    const Posed out = in_model(s, in, depth + 1) * own_pose(pose);
    const std::string at = attribute(e, "placement_frame");
    return kind == "model" && !at.empty() ? out * reversed(in_model(scope_of(e), at, depth + 1)) : out;
  }

  static Posed reversed(const Posed& x) { return {inverse(x.X), x.reach, x.steps}; }

  /// The link that carries a frame, by its full name; "world".
  std::string carrier(const Scope& s, const std::string& name, int depth = 0) const {
    if (depth > 200) refuse(s.model, "frames refer to each other in a circle");
    if (name == "world") return name;
    if (name == "__model__" || name.empty()) {
      const std::string canonical = attribute(s.model, "canonical_link");
      if (!canonical.empty()) return carrier(s, canonical, depth + 1);
      if (const XMLElement* l = s.model->FirstChildElement("link")) return s.prefix + attribute(l, "name");
      const XMLElement* m = s.model->FirstChildElement("model");
      if (m == nullptr) refuse(s.model, "no link");
      return carrier(s, attribute(m, "name"), depth + 1);
    }
    const std::size_t colons = name.find("::");
    const auto it = s.named.find(name.substr(0, colons));
    if (it == s.named.end()) refuse(s.model, "no frame " + name);
    const XMLElement* e = it->second;
    const std::string kind = e->Name();
    if (kind == "link") return s.prefix + name;
    if (kind == "joint") return carrier(s, text_of(e->FirstChildElement("child")), depth + 1);
    if (kind == "frame") return carrier(s, attribute(e, "attached_to"), depth + 1);
    Scope nested = scope_of(e);
    nested.prefix = s.prefix + attribute(e, "name") + "::";
    return carrier(nested, colons == std::string::npos ? "" : name.substr(colons + 2), depth + 1);
  }

  /// Links, then nested models, then joints.
  void model(const XMLElement* m, const Posed& outer, const std::string& prefix, bool stands) {
    only_served(m);
    once(m, {"pose", "static"});
    Scope s = scope_of(m);
    s.prefix = prefix;
    s.stands = stands || truth(m, "static");
    s.at = outer * own_pose(m->FirstChildElement("pose"));
    if (const std::string at = attribute(m, "placement_frame"); !at.empty()) s.at = s.at * reversed(in_model(s, at));
    for (const XMLElement* l = m->FirstChildElement("link"); l; l = l->NextSiblingElement("link")) link(s, l);
    for (const XMLElement* n = m->FirstChildElement("model"); n; n = n->NextSiblingElement("model")) {
      const std::string in = relative_to(n->FirstChildElement("pose"));
      model(n, s.at * in_model(s, in), prefix + attribute(n, "name") + "::", s.stands);
    }
    for (const XMLElement* j = m->FirstChildElement("joint"); j; j = j->NextSiblingElement("joint")) joint(s, j);
  }

  void link(const Scope& s, const XMLElement* e) {
    SdfWitness::Link l;
    l.name = s.prefix + attribute(e, "name");
    l.at = s.at * of_element(s, e);
    l.stands = s.stands;
    once(e, {"pose", "inertial"});
    const XMLElement* in = e->FirstChildElement("inertial");
    const XMLElement* I = in == nullptr ? nullptr : in->FirstChildElement("inertia");
    if (in != nullptr) {
      once(in, {"pose", "mass", "inertia"});
      l.solid.centre = own_pose(in->FirstChildElement("pose")).X;
    }
    if (I != nullptr) once(I, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"});
    l.solid.mass = number(in, "mass", 1);
    const char* names[] = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
    for (std::size_t k = 0; k < 6; ++k) l.solid.inertia[k] = number(I, names[k], k == 0 || k == 3 || k == 5 ? 1 : 0);
    if (!link_.emplace(l.name, static_cast<Index>(out_.links.size())).second) refuse(e, "the name " + l.name + " twice");
    out_.links.push_back(l);
  }

  Index link_of(const XMLElement* at, const std::string& name) const {
    if (name == "world") return -1;
    const auto it = link_.find(name);
    if (it == link_.end()) refuse(at, "no link " + name);
    return it->second;
  }

  /// In the world: given in the axes of the joint, of the model where an old version says so, or of a frame.
  Real3 axis(const Scope& s, const SdfWitness::Joint& j, const XMLElement* e) {
    once(e, {"xyz", "use_parent_model_frame"});
    const XMLElement* xyz = e->FirstChildElement("xyz");
    const std::vector<double> x = xyz == nullptr ? std::vector<double>{0, 0, 1} : numbers(xyz);
    if (x.size() != 3) refuse(e, "<xyz> is not three numbers");
    const Real3 given = wide({x[0], x[1], x[2]});
    if (length(given) == Quad(0)) refuse(e, "no direction");
    const std::string in = attribute(xyz, "expressed_in");
    const bool of_model = in == "__model__" || (in.empty() && (old_axes_ || truth(e, "use_parent_model_frame")));
    const Real33 R = of_model ? s.at.X.R : in.empty() ? j.at.X.R : (s.at * in_model(s, in)).X.R;
    return R * Real3(given / length(given));
  }

  void joint(const Scope& s, const XMLElement* e) {
    static const std::map<std::string, std::pair<Kind, std::size_t>> kinds{
        {"fixed", {Kind::fixed, 0}}, {"ball", {Kind::ball, 0}}, {"revolute", {Kind::revolute, 1}}, {"continuous", {Kind::revolute, 1}},
        {"prismatic", {Kind::prismatic, 1}}, {"screw", {Kind::screw, 1}}, {"universal", {Kind::universal, 2}},
        {"revolute2", {Kind::universal, 2}}, {"gearbox", {Kind::gearbox, 2}}};
    SdfWitness::Joint j;
    j.name = s.prefix + attribute(e, "name");
    if (s.named.at(attribute(e, "name")) != e) j.name += "_joint";  // as libsdformat calls it, with a warning
    const auto kind = kinds.find(attribute(e, "type"));
    if (kind == kinds.end()) refuse(e, "type " + attribute(e, "type"));
    j.kind = kind->second.first;
    once(e, {"parent", "child", "pose", "axis", "axis2", "thread_pitch", "screw_thread_pitch", "gearbox_ratio", "gearbox_reference_body"});
    for (const char* end : {"parent", "child"})
      if (text_of(e->FirstChildElement(end)).empty()) refuse(e, std::string("no ") + end);
    j.parent = link_of(e, carrier(s, text_of(e->FirstChildElement("parent"))));
    j.child = link_of(e, carrier(s, text_of(e->FirstChildElement("child"))));
    j.at = text_of(e->FirstChildElement("child")) == "world" ? own_pose(e->FirstChildElement("pose")) : s.at * of_element(s, e);
    const char* names[] = {"axis", "axis2"};
    for (std::size_t k = 0; k < kind->second.second; ++k) {
      const XMLElement* a = e->FirstChildElement(names[k]);
      if (a == nullptr) refuse(e, std::string("no ") + names[k]);
      j.axes.push_back(axis(s, j, a));
    }
    j.pitch = number(e, "thread_pitch", 1);
    j.ratio = number(e, "gearbox_ratio", 1);
    if (j.kind == Kind::gearbox) j.reference = link_of(e, s.prefix + text_of(e->FirstChildElement("gearbox_reference_body")));
    if (j.child < 0) {  // the motion is that of the link
      std::swap(j.parent, j.child);
      for (Real3& a : j.axes) a = -a;
    }
    if (j.child < 0) refuse(e, "joins the world to itself");
    out_.joints.push_back(std::move(j));
  }

  void tree() {
    for (std::size_t k = 0; k < out_.joints.size(); ++k) {
      SdfWitness::Joint& j = out_.joints[k];
      SdfWitness::Link& child = out_.links[static_cast<std::size_t>(j.child)];
      if (j.kind == Kind::gearbox || child.joint >= 0 || child.stands) continue;
      Index up = j.parent;
      while (up >= 0 && up != j.child) {
        const Index by = out_.links[static_cast<std::size_t>(up)].joint;
        up = by < 0 ? -1 : out_.joints[static_cast<std::size_t>(by)].parent;
      }
      if (up == j.child && j.parent >= 0) continue;
      child.joint = static_cast<Index>(k);
      j.in_tree = true;
    }
    std::vector<char> done(out_.links.size());
    while (out_.order.size() < out_.links.size())
      for (std::size_t i = 0; i < out_.links.size(); ++i) {
        const Index j = out_.links[i].joint, parent = j < 0 ? -1 : out_.joints[static_cast<std::size_t>(j)].parent;
        if (done[i] || (parent >= 0 && !done[static_cast<std::size_t>(parent)])) continue;
        done[i] = 1;
        out_.order.push_back(static_cast<Index>(i));
      }
  }

  SdfWitness out_;
  std::map<std::string, Index> link_;
  bool old_axes_ = false;
};

}  // namespace

bool SdfWitness::root_stands(Index link) const {
  const Link& l = links[static_cast<std::size_t>(link)];
  return l.stands || (l.joint >= 0 && joints[static_cast<std::size_t>(l.joint)].kind == Kind::fixed && joints[static_cast<std::size_t>(l.joint)].parent < 0);
}

Index SdfWitness::moving() const {
  Index n = 0;
  for (const Joint& j : joints) n += j.in_tree && j.kind != Kind::fixed;
  return n;
}

std::vector<Index> SdfWitness::leaves() const {
  std::vector<char> has_child(links.size()), moved(links.size());
  for (const Joint& j : joints)
    if (j.in_tree && j.parent >= 0) has_child[static_cast<std::size_t>(j.parent)] = 1;
  std::vector<Index> out;
  for (const Index i : order) {
    const auto k = static_cast<std::size_t>(i);
    if (links[k].joint < 0) continue;
    const Joint& j = joints[static_cast<std::size_t>(links[k].joint)];
    moved[k] = (j.parent >= 0 && moved[static_cast<std::size_t>(j.parent)]) || j.kind != Kind::fixed;
    if (moved[k] && !has_child[k]) out.push_back(i);
  }
  return out;
}

SdfWitness parse_sdf_witness(const std::string& bytes) { return Reader().read(bytes); }

SdfWitness read_sdf_witness(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot be read");
  return parse_sdf_witness({std::istreambuf_iterator<char>(in), {}});
}

}  // namespace delassus::reference
