// The XML of an SDF file beside libsdformat.
#pragma once

#include <tinyxml2.h>

#include <set>
#include <string>

namespace delassus {

/// Numbers of the file itself, read once more: the library takes the beginning of "2kg" for 2. @throws ModelError naming
/// element, line and text of one that is not finite. Cost O(size).
void check_sdf_numbers(const std::string& file, const tinyxml2::XMLElement& root);

/// The text, in quotes, of the first element of this kind that starts in this line and holds no others; "": there is none.
[[nodiscard]] std::string value_at(const tinyxml2::XMLElement& root, const std::string& kind, int line);

/// Names with "::", joint types that SDF does not have, joints without parent or child. @throws ModelError naming element, line and word.
void check_sdf_words(const std::string& file, const tinyxml2::XMLElement& root);

/// Lines of links with <inertial auto="true">, whose mass and inertia SDF 1.11 takes from densities and collision shapes.
[[nodiscard]] std::set<int> links_of_automatic_inertia(const tinyxml2::XMLElement& root);

/// The document printed with every element in the line that it has in the file: what a parser then says names that line.
[[nodiscard]] std::string text_on_its_lines(const tinyxml2::XMLDocument& document);

/// Takes out elements without a part in M, J and contacts: what is wrong in them is nothing to refuse a file for.
void leave_out_of_sdf(tinyxml2::XMLElement& root);

}  // namespace delassus
