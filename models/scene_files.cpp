#include <filesystem>

#include "models/message.h"
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

Scene open_scene(const std::string& name) {
  if (name.rfind("swimmer:", 0) == 0) {
    const auto links = finite_number(std::string_view(name).substr(8));
    if (!links || *links < 1 || *links > 1e9 || *links != std::floor(*links))
      throw ModelError("scene", in_quotes(name), "has no number of links", "swimmer:N with a whole number N >= 1");
    return swimmer(static_cast<Index>(*links));
  }
  std::error_code error;
  const bool path = name.find('/') != std::string::npos || fs::path(name).extension() == ".yaml";
  if (path || fs::is_regular_file(name, error)) return load_scene(name);
  const fs::path folder = scene_folder(), file = folder / (name + ".yaml");
  if (!name.empty() && !folder.empty() && fs::is_regular_file(file, error)) return load_scene(file.string());
  std::string known = "a .yaml file, swimmer:N";
  for (const std::string& s : scene_names()) known += ", " + s;
  throw ModelError("scene", in_quotes(name), "does not exist", known);
}

}  // namespace delassus
