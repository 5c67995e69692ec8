#include <dlfcn.h>

#include <filesystem>
#include <fstream>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "models/box_piles.h"
#include "models/scene.h"
#include "models/swimmer.h"
#include "models/formats/yaml.h"

namespace delassus {
namespace {

namespace fs = std::filesystem;

/// Where an installation has its scenes, from where this code was loaded: the shared library, or the program.
std::vector<fs::path> installed_folders() {
  std::error_code error;
  std::vector<fs::path> out;
  Dl_info library;
  static const char here = 0;
  if (dladdr(&here, &library) && library.dli_fname) out.push_back(fs::path(library.dli_fname).parent_path() / DELASSUS_SCENES_FROM_LIBRARY);
  out.push_back(fs::read_symlink("/proc/self/exe", error).parent_path() / DELASSUS_SCENES_FROM_PROGRAM);
  return out;
}

/// The first of the known places that has an index of scenes; empty when none has.
fs::path scene_folder() {
  std::error_code error;
  std::vector<fs::path> places = installed_folders();
  places.insert(places.begin(), "models/scenes");
  places.push_back(DELASSUS_SCENES_SOURCE);
  for (const fs::path& place : places)
    if (fs::is_regular_file(place / "index.yaml", error)) return place.lexically_normal();
  return {};
}

/// Whether the first character of a file that is no blank (nor byte order mark) is `<`: XML, and no YAML of ours.
bool begins_with_an_element(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  for (char c = 0; stream.get(c);)
    if (std::string_view(" \t\r\n\xef\xbb\xbf").find(c) == std::string_view::npos) return c == '<';
  return false;
}

/// By what is in it, or by its name where nothing is.
bool is_robot_s(const std::string& file) {
  const std::string end = fs::path(file).extension().string();
  return begins_with_an_element(file) || end == ".urdf" || end == ".sdf" || end == ".xml";
}

/// Scenes of any size, by name:N.
struct Sized {
  std::string_view name, of;
  Scene (*make)(Index);
};
constexpr Sized sized[] = {{"swimmer", "links", swimmer}, {"stacks", "boxes", stacks}, {"wall", "boxes", wall}};

}  // namespace

std::vector<std::string> scene_names() {
  const fs::path folder = scene_folder();
  std::vector<std::string> out;
  if (folder.empty()) return out;
  const Yaml root = Yaml::open((folder / "index.yaml").string());
  root.keys({"scenes"});
  for (const Yaml& y : root.at("scenes").list("a list of stems")) out.push_back(y.text("a stem"));
  return out;
}

Scene open_scene(const std::string& name, const SceneOptions& options) {
  std::error_code error;
  const bool file = fs::is_regular_file(name, error);
  if (file && is_robot_s(name)) return load_robot(name, options);
  if (options.base) throw ModelError("", "--base", in_quotes(name) + " is no robot's file", "a robot's file; in scenes write base: in the robot's entry");
  if (options.armature) throw ModelError("", "--armature", in_quotes(name) + " is no robot's file", "a robot's file; in scenes write armature: in the robot's entry");
  for (const Sized& s : sized) {
    const std::string begins(s.name), of(s.of);
    if (name.rfind(begins + ":", 0) != 0) continue;
    const auto size = finite_number(std::string_view(name).substr(begins.size() + 1));
    if (!size || *size < 1 || *size > 1e9 || *size != std::floor(*size))
      throw ModelError("", "scene " + in_quotes(name), "has no number of " + of, begins + ":N with a whole number N >= 1; " + begins + ":10 has ten " + of);
    return s.make(static_cast<Index>(*size));
  }
  const bool path = name.find('/') != std::string::npos || fs::path(name).extension() == ".yaml";
  if (path || file) return load_scene(name, options);
  const fs::path folder = scene_folder(), stem = folder / (name + ".yaml");
  if (!name.empty() && !folder.empty() && fs::is_regular_file(stem, error)) return load_scene(stem.string(), options);
  std::string known = "a .yaml file, a robot's file, swimmer:N, stacks:N, wall:N";
  for (const std::string& s : scene_names()) known += ", " + s;
  throw ModelError("", "scene " + in_quotes(name), "does not exist", did_you_mean(name, scene_names()) + known + "; check the path");
}

}  // namespace delassus
