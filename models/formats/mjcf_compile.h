// MJCF compiled by MuJoCo, whatever it says collected; internal to the MJCF reader.
#pragma once

#include <mujoco/mujoco.h>

#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "algorithms/problem/problem.h"
#include "models/formats/mjcf_xml.h"

namespace delassus {

static_assert(std::is_same_v<mjtNum, double>);

struct DeleteMujocoModel {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
};

struct CompiledMjcf {
  std::unique_ptr<mjModel, DeleteMujocoModel> model;
  std::vector<std::string> warnings;                     ///< MuJoCo's own
  std::string refused;                                   ///< MuJoCo's message to the file itself, when it took it only as `text`
  std::vector<std::string> left_out;                     ///< assets that are not there, and geoms that need them
  bool fixed_inertia_lost = false;                       ///< of a link that the file fixes to the world
  std::vector<SiteEquality> site_equalities;
  std::string text;                                      ///< what was compiled instead of the file; "" for the file itself
  std::map<std::string, Matrix3<double>> full_inertia;   ///< by body name: `fullinertia` of the file, axes of the body
};

/// Compiles a file. When MuJoCo refuses it, it is tried again without what has no part in M, J and contacts (newer versions
/// write more of that than 2.2 reads), and without meshes, height fields and textures whose files are missing, which are
/// listed; an inertia that needs one is an error. @throws ModelError with MuJoCo's message. One file at a time: MuJoCo's handlers and
/// its last model are global.
[[nodiscard]] CompiledMjcf compile_mjcf(const std::string& file);

}  // namespace delassus
