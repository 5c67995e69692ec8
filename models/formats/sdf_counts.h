// How often an SDF file says what it may say once, and how many numbers stand where: libsdformat takes the first and is silent.
#pragma once

#include <tinyxml2.h>

#include <string>

#include "models/robot.h"

namespace delassus {

/// Warns of an element that stands twice under one parent ("given twice": the first is taken).
/// @throws ModelError naming file, element and line where there are more or fewer numbers than SDF has there. Cost O(elements).
void check_counts(const std::string& file, const tinyxml2::XMLElement& root, Findings& findings);

}  // namespace delassus
