// Elements and numbers of a robot's XML: read strictly, and written back in the one form that every parser reads alike.
#pragma once

#include <tinyxml2.h>

#include <string>
#include <vector>

#include "algorithms/kit/spatial.h"

namespace delassus {

/// Names the element in messages: `link "arm" <inertia> (line 7)`.
struct Place {
  const std::string& file;
  std::string owner;  // `link "arm"`

  [[nodiscard]] std::string element(const tinyxml2::XMLElement& e) const;
  [[noreturn]] void fail(const tinyxml2::XMLElement& e, const std::string& problem, const std::string& accepted) const;
};

/// The numbers of an attribute, separated by blanks, tabs or line breaks. The attribute is rewritten: shortest decimal form,
/// one blank between. @throws ModelError unless there are `count` finite ones; `unit` begins with a blank.
std::vector<double> numbers(const Place& place, tinyxml2::XMLElement& e, const char* attribute, std::size_t count,
                            const std::string& unit);
double number(const Place& place, tinyxml2::XMLElement& e, const char* attribute, const std::string& unit);
double number_or(const Place& place, tinyxml2::XMLElement& e, const char* attribute, const std::string& unit, double other);
Vector3<double> triple(const Place& place, tinyxml2::XMLElement& e, const char* attribute, const std::string& unit);
/// The <origin> of an element; identity when it has none.
Pose<double> origin(const Place& place, tinyxml2::XMLElement& parent);
/// An attribute that must be there and not empty.
std::string name_of(const Place& place, const tinyxml2::XMLElement& e, const char* attribute = "name");

/// Loads a file. @throws ModelError when it cannot be read, is no XML, or holds no element.
/// @returns the root element, which lives as long as the document.
tinyxml2::XMLElement& load_xml(tinyxml2::XMLDocument& document, const std::string& file);

}  // namespace delassus
