// Links of a URDF: inertials and collision primitives.
#include <array>
#include <sstream>

#include "algorithms/errors/message.h"
#include "models/formats/urdf_check.h"

namespace delassus {
namespace {

using tinyxml2::XMLElement;

void read_inertial(const Place& place, XMLElement& link, CheckedUrdf::Link& out) {
  XMLElement* e = link.FirstChildElement("inertial");
  if (e == nullptr) return;
  out.has_inertial = true;
  out.inertial_place = place.element(*e);
  out.inertial.origin = origin(place, *e);
  XMLElement* m = e->FirstChildElement("mass");
  XMLElement* I = e->FirstChildElement("inertia");
  if (m == nullptr) place.fail(*e, "<mass> is missing", "<mass value=\"...\"/> [kg]; take <inertial> out for a massless link");
  if (I == nullptr) place.fail(*e, "<inertia> is missing", "<inertia ixx ixy ixz iyy iyz izz/> [kg m^2]; all six 0 for a point mass");
  out.inertial.mass = number(place, *m, "value", " [kg]");
  if (out.inertial.mass < 0) place.fail(*m, "mass = " + number_text(out.inertial.mass) + " kg is negative", "mass >= 0 [kg]; correct the sign");
  std::array<double, 6> v{};
  constexpr std::array<const char*, 6> names{"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
  for (std::size_t i = 0; i < 6; ++i) v[i] = number(place, *I, names[i], " [kg m^2]");
  out.inertial.inertia << v[0], v[1], v[2], v[1], v[3], v[4], v[2], v[4], v[5];
}

/// A length that is not negative.
double length(const Place& place, XMLElement& e, const char* attribute) {
  const double value = number(place, e, attribute, " >= 0 [m]");
  if (value < 0) place.fail(e, std::string(attribute) + " = " + number_text(value) + " m is negative", "a length >= 0 [m]; correct the sign");
  return value;
}

/// A primitive with a sense: none for what has no extent. A sphere of radius 0 is a point, a capsule of length 0 a sphere.
std::vector<Shape> primitive(const Place& place, XMLElement& g, Shape shape, Findings& findings, Tally& tally) {
  const std::string kind = g.Name();
  bool flat = false;
  if (kind == "box") {
    shape.kind = Shape::Kind::box;
    shape.size = triple(place, g, "size", " [m]") / 2;
    if (shape.size.minCoeff() < 0) place.fail(g, "size = " + in_quotes(g.Attribute("size")) + " m has a negative edge", "lengths >= 0 [m]; correct the sign");
    if (shape.size.maxCoeff() == 0) {
      tally.add("a box of size 0 0 0 touches nothing and is left out", place.element(g));
      return {};
    }
    flat = shape.size.minCoeff() == 0;
  } else if (kind == "sphere") {
    shape.kind = Shape::Kind::sphere;
    shape.size[0] = length(place, g, "radius");
  } else {
    shape.kind = kind == "cylinder" ? Shape::Kind::cylinder : Shape::Kind::capsule;
    shape.size = {length(place, g, "radius"), length(place, g, "length") / 2, 0};
    flat = kind == "cylinder" && shape.size.head<2>().minCoeff() == 0;
    if (kind == "capsule" && shape.size[1] == 0) shape.kind = Shape::Kind::sphere;
  }
  if (!flat) return {shape};
  findings.warn("flat collision shape", place.file, place.element(g), "a " + kind + " without volume is left out", "lengths > 0 [m]");
  return {};
}

/// A mesh as it is named; the file is read where contacts are looked for.
void add_mesh(const Place& place, const XMLElement& g, const Pose<double>& at, Findings& findings, std::vector<Robot::Mesh>& out) {
  Robot::Mesh mesh;
  mesh.placement = at;
  mesh.element = place.element(g);
  const char* const file = g.Attribute("filename");
  if (file == nullptr) return findings.warn("mesh not found", place.file, mesh.element, "names no file and is left out", "filename=\"...\"");
  mesh.uri = file;
  std::vector<double> scale;
  std::istringstream words(g.Attribute("scale") == nullptr ? "1 1 1" : g.Attribute("scale"));
  for (std::string word; words >> word;) scale.push_back(finite_number(word).value_or(std::numeric_limits<double>::quiet_NaN()));
  if (scale.size() != 3 || std::any_of(scale.begin(), scale.end(), [](double x) { return std::isnan(x); }))
    return findings.warn("mesh not read", place.file, mesh.element, "scale = " + in_quotes(g.Attribute("scale")) + " is not understood, the mesh is left out", "3 finite numbers");
  mesh.scale << scale[0], scale[1], scale[2];
  out.push_back(mesh);
}

/// The primitives of a link; meshes apart, and counted.
std::vector<Shape> shapes_of(const Place& place, XMLElement& link, Findings& findings, Tally& tally, int& meshes, std::vector<Robot::Mesh>& named) {
  std::vector<Shape> out;
  for (XMLElement* c = link.FirstChildElement("collision"); c; c = c->NextSiblingElement("collision")) {
    Shape shape;
    shape.placement = origin(place, *c);
    XMLElement* geometry = c->FirstChildElement("geometry");
    XMLElement* g = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    if (g == nullptr) {
      findings.warn("collision without geometry", place.file, place.element(*c), "has no geometry and is left out", "box, cylinder, sphere, capsule or mesh");
    } else if (std::string_view(g->Name()) == "mesh") {
      ++meshes;
      add_mesh(place, *g, shape.placement, findings, named);
    } else {
      for (const Shape& s : primitive(place, *g, shape, findings, tally)) out.push_back(s);
    }
  }
  return out;
}

}  // namespace

void check_link(const std::string& file, XMLElement& e, CheckedUrdf& out, Findings& findings, Tally& tally, int& meshes) {
  const std::string name = name_of(Place{file, ""}, e);
  const Place place{file, "link " + in_quotes(name)};
  CheckedUrdf::Link link;
  link.line = e.GetLineNum();
  read_inertial(place, e, link);
  link.shapes = shapes_of(place, e, findings, tally, meshes, link.meshes);
  if (!out.links.emplace(name, std::move(link)).second) place.fail(e, "the name is taken", "unique link names; rename one of the two");
}

}  // namespace delassus
