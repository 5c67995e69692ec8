// The XML of an SDF file beside libsdformat.
#pragma once

#include <tinyxml2.h>

#include <string>

namespace delassus {

/// Numbers of the file itself, read once more: the library takes the beginning of "2kg" for 2. @throws ModelError naming
/// element, line and text of one that is not finite. Cost O(size).
void check_sdf_numbers(const std::string& file, const tinyxml2::XMLElement& root);

/// Takes out elements without a part in M, J and contacts: what is wrong in them is nothing to refuse a file for.
void leave_out_of_sdf(tinyxml2::XMLElement& root);

}  // namespace delassus
