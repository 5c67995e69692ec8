// Collision meshes: found, read and turned into convex hulls, once contacts are looked for.
//
// Files are those assimp reads (STL, DAE, OBJ, ...), in metres times `scale`. Transforms inside a file (nodes, the unit of
// a DAE) are applied; its up axis is not: axes are the file's, as robot viewers take them. Coordinates are floats there.
// A mesh stands for its convex hull: what is hollow or notched becomes solid.
#pragma once

#include "models/robot.h"

namespace delassus {

/// Whether the library was built with assimp.
[[nodiscard]] bool has_mesh_files();

/// The file that a URI of a robot file means, "" when there is none; `tried` lists where it was looked for.
///   package://name/rest, model://name/rest   F/name/rest, or F/rest where F is itself called `name`, for F in mesh_path,
///                                            ROS_PACKAGE_PATH, the folder of the robot file and the folders above it
///   file:///path, /path                      as it is
///   path                                     from the folder of the robot file, then from each of mesh_path
[[nodiscard]] std::string find_mesh(const std::string& uri, const std::string& robot_file,
                                    const std::vector<std::string>& mesh_path, std::string& tried);

/// The points of all objects of a mesh file, or of those called `part`, in its root frame [m].
/// @throws std::runtime_error with assimp's message; when nothing of that name is there, or no point is finite.
[[nodiscard]] std::vector<Vector3<double>> mesh_points(const std::string& file, const std::string& part = "");

/// Adds the hull of every mesh of a robot to the shapes of its body, or to what stands, at most `most` vertices each. Warns about meshes that
/// are not found or cannot be read, and about hulls cut by more than `margin` [m]; notes how many were read and how far
/// they were cut. A file is read once. Cost: reading, and O(n log n) per mesh of n points.
void add_hulls(Model& model, Robot& robot, Index most, double margin, Findings& found);

}  // namespace delassus
