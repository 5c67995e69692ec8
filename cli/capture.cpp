#include "cli/capture.h"

#include <filesystem>
#include <fstream>

#include "algorithms/errors/message.h"
#include "simulation/problem_file.h"

namespace delassus::cli {

namespace {

constexpr const char* accepted = "a folder, or the name of one that can be made; files are SCENE_step_N_K.dat";

std::string stem(const std::string& scene) {
  std::string out = std::filesystem::path(scene).stem().string();
  for (char& c : out)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-') c = '_';
  return out.empty() ? "scene" : out;
}

}  // namespace

void check_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder)) throw ModelError(folder, "--capture", "is no folder and cannot be made", accepted);
}

std::vector<std::string> capture(const std::string& folder, const Scene& scene, const simulation::Simulation<double>& s, bool all) {
  std::vector<std::string> out;
  // A step that ended well is counted in the state already.
  const auto step = s.state().steps + (s.last().ok() ? 0 : 1);
  int k = 0;
  s.plan().path->problems([&](const simulation::ContactProblem<double>& problem, bool solved) {
    ++k;
    if (!all && solved) return;
    const std::string file = (std::filesystem::path(folder) / (stem(scene.name) + "_step_" + std::to_string(step) + "_" + std::to_string(k) + (solved ? "" : "_unsolved") + ".dat")).string();
    std::ofstream to(file);
    to << simulation::contact_problem_text(problem);
    if (!to.flush()) throw ModelError(file, "--capture", "cannot be written", accepted);
    out.push_back(file);
  });
  return out;
}

}  // namespace delassus::cli
