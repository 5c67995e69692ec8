#include "models/formats/urdf_xml.h"

#include <fstream>
#include <iterator>

#include "algorithms/errors/message.h"
#include "models/robot.h"

namespace delassus {

using tinyxml2::XMLElement;

std::string Place::element(const XMLElement& e) const {
  std::string where = owner;
  const std::string name = e.Name();
  const bool is_owner = owner == name || owner.rfind(name + " ", 0) == 0;
  if (!is_owner) where += (where.empty() ? "<" : " <") + name + ">";
  return where + " (line " + std::to_string(e.GetLineNum()) + ")";
}

void Place::fail(const XMLElement& e, const std::string& problem, const std::string& accepted) const {
  throw ModelError(file, element(e), problem, accepted);
}

std::vector<double> numbers(const Place& place, XMLElement& e, const char* attribute, std::size_t count,
                            const std::string& unit) {
  const std::string accepted = std::to_string(count) + (count == 1 ? " finite number" : " finite numbers") + unit;
  const char* found = e.Attribute(attribute);
  if (found == nullptr) place.fail(e, "attribute " + std::string(attribute) + " is missing", accepted + "; add " + attribute + "=\"...\"");
  const std::string text = found;
  std::vector<double> out;
  std::string_view rest(text);
  while (true) {
    const std::size_t first = rest.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) break;
    rest.remove_prefix(first);
    const std::size_t length = std::min(rest.find_first_of(" \t\r\n"), rest.size());
    const auto value = finite_number(rest.substr(0, length));
    if (!value) {
      const std::string_view word = rest.substr(0, length);
      const NotANumber why = not_a_number(text.find('$') == std::string::npos ? word : std::string_view(text));
      place.fail(e, std::string(attribute) + " = " + in_quotes(text) + (word == text ? " " : ": " + in_quotes(word) + " ") + why.problem, accepted + "; " + why.advice);
    }
    out.push_back(*value);
    if (out.size() > count) break;
    rest.remove_prefix(length);
  }
  if (out.size() != count) place.fail(e, std::string(attribute) + " = " + in_quotes(text) + " has the wrong length", accepted + "; write " + std::to_string(count));
  e.SetAttribute(attribute, numbers_text(out).c_str());
  return out;
}

double number(const Place& place, XMLElement& e, const char* attribute, const std::string& unit) {
  return numbers(place, e, attribute, 1, unit)[0];
}

double number_or(const Place& place, XMLElement& e, const char* attribute, const std::string& unit, double other) {
  return e.Attribute(attribute) == nullptr ? other : number(place, e, attribute, unit);
}

Vector3<double> triple(const Place& place, XMLElement& e, const char* attribute, const std::string& unit) {
  const std::vector<double> v = numbers(place, e, attribute, 3, unit);
  return {v[0], v[1], v[2]};
}

Pose<double> origin(const Place& place, XMLElement& parent) {
  Pose<double> pose;
  XMLElement* e = parent.FirstChildElement("origin");
  if (e == nullptr) return pose;
  if (e->Attribute("quat_xyzw") != nullptr)
    place.fail(*e, "quat_xyzw = " + in_quotes(e->Attribute("quat_xyzw")) + " is of a later URDF and is not read", "rpy=\"...\" [rad]; convert the quaternion");
  if (e->Attribute("xyz") != nullptr) pose.translation = triple(place, *e, "xyz", " [m]");
  if (e->Attribute("rpy") != nullptr) pose.rotation = rotation_rpy(triple(place, *e, "rpy", " [rad]"));
  return pose;
}

std::string name_of(const Place& place, const XMLElement& e, const char* attribute) {
  const char* text = e.Attribute(attribute);
  if (text == nullptr || *text == '\0')
    place.fail(e, "attribute " + std::string(attribute) + " is missing or empty", "a name; write " + std::string(attribute) + "=\"...\"");
  return text;
}

namespace {

/// tinyxml2 takes a NUL byte for the end of the text.
void check_no_nul(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const std::size_t at = bytes.find('\0');
  if (at != std::string::npos)
    throw ModelError(file, "byte " + std::to_string(at), "is NUL, which no XML has: what follows would be lost", "text; convert a UTF-16 file to UTF-8");
}

}  // namespace

XMLElement& load_xml(tinyxml2::XMLDocument& document, const std::string& file) {
  check_no_nul(file);
  const tinyxml2::XMLError error = document.LoadFile(file.c_str());
  if (error == tinyxml2::XML_ERROR_FILE_NOT_FOUND || error == tinyxml2::XML_ERROR_FILE_COULD_NOT_BE_OPENED ||
      error == tinyxml2::XML_ERROR_FILE_READ_ERROR)
    throw ModelError(file, "file", "cannot be read", "a robot's file; check the path");
  if (error == tinyxml2::XML_ERROR_EMPTY_DOCUMENT) throw ModelError(file, "file", "is empty", "<robot>, <mujoco> or <sdf>; check how it was written");
  if (error != tinyxml2::XML_SUCCESS)
    throw ModelError(file, "line " + std::to_string(document.ErrorLineNum()), "broken XML: " + std::string(document.ErrorName()),
                     "well-formed XML; close or quote what stands there, xmllint says more");
  XMLElement* root = document.RootElement();
  if (root == nullptr) throw ModelError(file, "root element", "the XML holds no element", "<robot>, <mujoco> or <sdf>; check that the file is not a fragment");
  if (const XMLElement* second = root->NextSiblingElement())
    throw ModelError(file, "<" + std::string(second->Name()) + "> (line " + std::to_string(second->GetLineNum()) + ")",
                     "is a second root element behind <" + std::string(root->Name()) + ">", "one root element; remove the other or put it into a file of its own");
  return *root;
}

}  // namespace delassus
