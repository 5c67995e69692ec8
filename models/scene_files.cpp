#include <filesystem>
#include <fstream>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "models/scene.h"
#include "models/swimmer.h"
#include "models/yaml.h"

namespace delassus {
namespace {

namespace fs = std::filesystem;

/// The first of the known places that has an index of scenes; empty when none has.
fs::path scene_folder() {
  std::error_code error;
  for (const char* place : {"models/scenes", DELASSUS_SCENES_SOURCE, DELASSUS_SCENES_INSTALLED})
    if (fs::is_regular_file(fs::path(place) / "index.yaml", error)) return place;
  return {};
}

/// Whether the first character of a file that is no blank (nor byte order mark) is `<`: XML, and no YAML of ours.
bool begins_with_an_element(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  for (char c = 0; stream.get(c);)
    if (std::string_view(" \t\r\n\xef\xbb\xbf").find(c) == std::string_view::npos) return c == '<';
  return false;
}

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
  if (file && begins_with_an_element(name)) return load_robot(name, options);
  if (options.base) throw ModelError("", "--base", in_quotes(name) + " is no robot's file", "a robot's file; in scenes write base: in the robot's entry");
  if (options.armature) throw ModelError("", "--armature", in_quotes(name) + " is no robot's file", "a robot's file; in scenes write armature: in the robot's entry");
  if (name.rfind("swimmer:", 0) == 0) {
    const auto links = finite_number(std::string_view(name).substr(8));
    if (!links || *links < 1 || *links > 1e9 || *links != std::floor(*links))
      throw ModelError("", "scene " + in_quotes(name), "has no number of links", "swimmer:N with a whole number N >= 1; swimmer:10 has ten links");
    return swimmer(static_cast<Index>(*links));
  }
  const bool path = name.find('/') != std::string::npos || fs::path(name).extension() == ".yaml";
  if (path || file) return load_scene(name, options);
  const fs::path folder = scene_folder(), stem = folder / (name + ".yaml");
  if (!name.empty() && !folder.empty() && fs::is_regular_file(stem, error)) return load_scene(stem.string(), options);
  std::string known = "a .yaml file, a robot's file, swimmer:N";
  for (const std::string& s : scene_names()) known += ", " + s;
  throw ModelError("", "scene " + in_quotes(name), "does not exist", did_you_mean(name, scene_names()) + known + "; check the path");
}

}  // namespace delassus
