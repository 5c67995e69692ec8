// The XML of a URDF, checked: every element and number urdfdom would misread, drop or only print about.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "algorithms/model.h"

namespace delassus {

/// A URDF that has passed every check of its XML.
struct CheckedUrdf {
  struct JointRow {
    std::string name, parent, child;
    double armature = 0;
    bool effort_given = false, velocity_given = false, range_given = false;
    int line = 0;
  };
  std::string root;                                    ///< the one link without a parent
  std::vector<JointRow> joints;                        ///< in the order of the file
  std::map<std::string, std::vector<Index>> children;  ///< link → joints leaving it, in the order of the file
  std::map<std::string, std::vector<Shape>> shapes;    ///< link → collision primitives in the link frame
  std::map<std::string, int> link_lines;
  std::vector<std::string> notes;                      ///< what was left out
  std::string text;                                    ///< the same URDF without visuals and collisions, for urdfdom
};

/// @throws ModelError naming file, element (with line), value and what is accepted. Cost O(size of the file).
[[nodiscard]] CheckedUrdf check_urdf(const std::string& file);

}  // namespace delassus
