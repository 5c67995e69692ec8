// MJCF compiled by MuJoCo, whatever it says collected; internal to the MJCF reader.
#pragma once

#include <mujoco/mujoco.h>

#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "algorithms/problem.h"

namespace delassus {

static_assert(std::is_same_v<mjtNum, double>);

struct DeleteMujocoModel {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
};

struct CompiledMjcf {
  std::unique_ptr<mjModel, DeleteMujocoModel> model;
  std::vector<std::string> warnings;                     ///< MuJoCo's own
  std::vector<std::string> left_out;                     ///< assets that are not there, and geoms that need them
  std::string text;                                      ///< what was compiled instead of the file; "" for the file itself
  std::map<std::string, Matrix3<double>> full_inertia;   ///< by body name: `fullinertia` of the file, axes of the body
};

/// Compiles a file. When files of meshes, height fields or textures are missing, what needs them is taken out and listed,
/// unless an inertia depends on it. @throws ModelError with MuJoCo's message. One file at a time: MuJoCo's handlers and
/// its last model are global.
[[nodiscard]] CompiledMjcf compile_mjcf(const std::string& file);

}  // namespace delassus
