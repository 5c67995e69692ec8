// What MuJoCo says against a file, as a message of ours: element, line and value.
#pragma once

#include <tinyxml2.h>

#include <string>

namespace delassus {

struct MjcfSaid {
  std::string element;    ///< `inertial (line 4)`, `body "b" (line 3)`; "MuJoCo" where the message names no line of the file
  std::string text;       ///< the value, where an attribute is named, and MuJoCo's words
  std::string to_do;      ///< of a number that is none
};

/// Places the message ("… attribute 'mass' Element 'inertial', line 4") in the document it is about. Cost O(size).
[[nodiscard]] MjcfSaid mjcf_said(const tinyxml2::XMLDocument& document, const std::string& message);

/// Whether two messages are the same but for lines and numbers of objects.
[[nodiscard]] bool same_complaint(const std::string& a, const std::string& b);

}  // namespace delassus
