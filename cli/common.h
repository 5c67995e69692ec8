// What several subcommands share: how a scene is opened, damping from the command line, JSON of vectors, operators by capability.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "algorithms/delassus.h"
#include "models/scene.h"

namespace delassus::options {
class Command;
}

namespace delassus::cli {

using nlohmann::json;

/// Adds --strict, --base and --armature, which say how a scene or a robot's file is opened.
void add_scene_options(options::Command& app, SceneOptions& options);

/// Opens a scene and, when `damping` is given, replaces R⁻¹ of every row by it [1/kg]. Warnings go to standard error.
/// @throws ModelError for an unknown scene and for a damping that is negative or not finite.
[[nodiscard]] Scene open(const std::string& scene, const SceneOptions& options, const std::optional<double>& damping = std::nullopt);

/// [{kind, text}] of a scene's warnings.
[[nodiscard]] json warnings_json(const Scene& scene);

/// One number when every row has the same damping, otherwise an array of the rows' diagonal entries.
[[nodiscard]] json damping_json(const Damping<double>& damping);
/// [{row, R_inverse: [[…]]}] of the dense blocks.
[[nodiscard]] json damping_blocks_json(const Damping<double>& damping);
/// A number, or null where it is not finite.
[[nodiscard]] json finite_json(double x);
/// The same, and null where it is negative: not known.
[[nodiscard]] json known_json(double x);
/// Rows of a matrix.
[[nodiscard]] json matrix_json(const MatrixX<double>& m);
/// {status, where, iterations, backward_error, error_bound, rcond_estimate}; null: not computed.
[[nodiscard]] json report_json(const Report& report);

/// A JSON array of `size` finite numbers. @throws ModelError for a missing file, another length or anything else.
[[nodiscard]] VectorX<double> read_vector(const std::string& file, Index size, const std::string& meaning);

/// The named rows and the named defect, or all operators when neither is given. @throws ModelError listing the accepted
/// names.
[[nodiscard]] std::vector<const OperatorRow*> chosen_operators(const std::vector<std::string>& names,
                                                              const std::string& defect = {});

}  // namespace delassus::cli
