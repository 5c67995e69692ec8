// What `delassus survey` finds out about one robot file.
#pragma once

#include "cli/common.h"

namespace delassus::cli {

struct SurveyOptions {
  std::string base = "auto";   ///< auto: free, or fixed where only that loads; free; fixed
  double armature = -1;        ///< [kg m² or kg] of joints that are given none; negative: none
  bool strict = false;
  std::int64_t poses = 2;      ///< random configurations
};

/// Whether the text is a robot that can be surveyed: a .urdf, or .xml and .sdf whose root element says so.
[[nodiscard]] bool is_robot_file(const std::string& file);

/// What urdfdom says when it refuses the file by itself; {dropped: what it says} when it reads it all the same; null when it
/// reads it without an error.
[[nodiscard]] json urdfdom_says(const std::string& file);

/// {file, state, …}, state one of
///   loads      base, bodies, dof, mass, warnings: [{kind, text}], notes, ratios: {M, J, A, apply}, rows: of J;
///              without a second reading: ratios: {apply}, not_compared: why
///   refused    why, kind (the message without names and numbers), right: a reason, or null: needs a look
/// and for URDF: urdfdom (as given), witness (null, or why it does not read it),
/// regular: {free, fixed} of M by the witness. A file that loads but is not what the witness reads has `differs`: what.
/// Never throws.
[[nodiscard]] json survey_file(const std::string& file, const json& urdfdom, const SurveyOptions& options);

}  // namespace delassus::cli
