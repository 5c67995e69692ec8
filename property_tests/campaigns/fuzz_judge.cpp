#include "algorithms/kit/test_scalars.h"
#include "property_tests/campaigns/fuzz_judge.h"

#include <tinyxml2.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>

#include <nlohmann/json.hpp>

#include "generators/build.h"
#include "generators/spec.h"
#include "models/scene.h"
#include "property_tests/second_reading/second_reading.h"
#include "reference/definition.h"
#include "reference/sdf_witness.h"
#include "reference/urdf_witness.h"

namespace delassus {
namespace {

using nlohmann::json;
using reference::UrdfMatrices;
using reference::UrdfWitness;

std::string words(const std::vector<Warning>& warnings, const std::vector<std::string>& notes) {
  std::string out;
  for (const Warning& w : warnings) out += w.text + "\n";
  for (const std::string& n : notes) out += n + "\n";
  return out;
}

VectorX<double> pose(const Model& model) {
  VectorX<double> q = neutral(model);
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    if (model.bodies[b].joint.type != JointType::floating)
      for (Index k = model.first_q[b]; k < model.first_q[b + 1]; ++k) q[k] = 0.3 + 0.1 * static_cast<double>(k % 7);
  return q;
}

double mass_of(const Model& model) {
  double mass = 0;
  for (const Body& b : model.bodies) mass += b.mass;
  return mass;
}

/// The largest number of the text. Beyond 1e6 the pivots of M are too far apart for the witness to tell regular from not.
double largest(const UrdfWitness& w) {
  double out = 0;
  for (const UrdfWitness::Link& l : w.links) {
    out = std::max(out, std::fabs(l.mass));
    for (const double x : l.com) out = std::max(out, std::fabs(x));
    for (const double x : l.inertia) out = std::max(out, std::fabs(x));
  }
  for (const UrdfWitness::Joint& j : w.joints)
    for (const double x : j.xyz) out = std::max(out, std::fabs(x));
  return out;
}

/// What is wrong with a model that loaded, or "".
std::string differs(const std::string& file, Model& model, const Robot& robot, bool fixed) {
  const bool warned = !robot.warnings.empty(), noted = warned || !robot.notes.empty();
  try {
    const UrdfWitness w = reference::read_urdf_witness(file);
    if (!w.doubtful.empty() && !noted) return "nothing is said of " + w.doubtful.front();
    if (!fixed && std::fabs(mass_of(model) - w.total_mass()) > 30 * unit_roundoff<double> * static_cast<double>(w.links.size()) * w.total_mass() && !warned)
      return std::to_string(mass_of(model)) + " kg in the model, " + std::to_string(w.total_mass()) + " kg in the text";
    if (largest(w) > 1e12) return {};  // the witness computes from the world's origin
    const std::vector<Index> leaves = w.leaves();
    for (const Index i : leaves) {
      Constraint c;
      c.kind = Constraint::Kind::weld;
      c.a = robot.links.at(w.links[static_cast<std::size_t>(i)].name);
      model.constraints.push_back(c);
    }
    const VectorX<double> q = pose(model);
    const UrdfMatrices theirs = reference::urdf_matrices(w, model, robot.name, q, leaves);
    if (!theirs.regular && largest(w) < 1e6) return "M is singular or indefinite, and the model loads";
    const Problem<Quad> problem = kinematics<double>(model, q).cast<Quad>();
    const double M = worst_ratio(reference::mass_matrix(problem), theirs.M, theirs.M_bound);
    const double J = worst_ratio(reference::constraint_jacobian(problem), theirs.J, theirs.J_bound);
    if (!(M < 30 && J < 30) && !warned) return "M at ratio " + std::to_string(M) + ", J at ratio " + std::to_string(J);
  } catch (const std::exception& e) {
    if (std::string(e.what()).find("no robot") != std::string::npos) return {};  // another format's root element
    if (!warned) return std::string("loads, though: ") + e.what();
  }
  return {};
}

FuzzVerdict judge_urdf(const std::string& file, bool fixed) {
  RobotOptions options;
  options.file = file, options.robot = "r", options.base_given = true;
  options.base = fixed ? RobotOptions::Base::fixed : RobotOptions::Base::free;
  Model model;
  const Robot robot = add_robot(model, options);
  validate(model, file);
  return {true, words(robot.warnings, robot.notes), differs(file, model, robot, fixed)};
}

/// A number of an MJCF text that is none, or "": MuJoCo may take its beginning.
std::string no_number(const tinyxml2::XMLElement* e) {
  static const std::set<std::string> names{"pos", "quat", "euler", "axisangle", "xyaxes", "zaxis", "mass", "diaginertia", "fullinertia", "axis", "armature",
                                           "damping", "frictionloss", "ref", "anchor", "relpose", "polycoef", "density", "size", "range"};
  for (; e != nullptr; e = e->NextSiblingElement()) {
    for (const tinyxml2::XMLAttribute* a = e->FirstAttribute(); a != nullptr; a = a->Next()) {
      if (names.count(a->Name()) == 0) continue;
      std::istringstream words(a->Value());
      for (std::string word; words >> word;) {
        char* end = nullptr;
        static_cast<void>(std::strtod(word.c_str(), &end));
        if (word.find_first_not_of("0123456789+-.eE") != std::string::npos || *end != '\0') return std::string(a->Name()) + " '" + a->Value() + "' is taken for numbers";
      }
    }
    if (const std::string found = no_number(e->FirstChildElement()); !found.empty()) return found;
  }
  return {};
}

/// The largest length or moment of the model: beyond 1e12 rounding hides what is compared.
double largest(const Model& model) {
  double out = 0;
  for (const Body& b : model.bodies)
    out = std::max({out, b.joint.placement.translation.cwiseAbs().maxCoeff(), b.com.cwiseAbs().maxCoeff(), b.inertia.cwiseAbs().maxCoeff(), b.mass});
  return out;
}

/// What is wrong with an MJCF or SDF that loaded, or "".
std::string differs_from_second(const RobotOptions& options, Model& model, const Robot& robot) {
  const bool warned = !robot.warnings.empty(), noted = warned || !robot.notes.empty();
  try {
    const std::unique_ptr<SecondReading> second = second_reading(options);
    if (second == nullptr) return {};
    if (!second->doubtful().empty() && !noted) return "nothing is said of " + second->doubtful().front();
    tinyxml2::XMLDocument document;
    if (document.LoadFile(options.file.c_str()) != tinyxml2::XML_SUCCESS) return "loads, though it is no XML";
    if (const std::string found = std::string(document.RootElement()->Name()) == "mujoco" ? no_number(document.RootElement()) : ""; !found.empty() && !warned) return found;
    if (largest(model) > 1e12 || model.dofs() == 0) return {};
    second->add_welds(model, robot);
    VectorX<double> q = pose(model);
    const reference::WitnessMatrices theirs = second->matrices(model, robot, q);
    const Problem<Quad> ours = kinematics<double>(model, q).cast<Quad>();
    const double M = worst_ratio(reference::mass_matrix(ours), theirs.M, theirs.M_bound);
    const double J = worst_ratio(reference::constraint_jacobian(ours), theirs.J, theirs.J_bound);
    if (!(M < 30 && J < 30) && !warned) return "M at ratio " + std::to_string(M) + ", J at ratio " + std::to_string(J);
  } catch (const reference::NotServed&) {
  } catch (const std::exception& e) {
    if (!warned) return std::string("loads, though: ") + e.what();
  }
  return {};
}

FuzzVerdict judge_robot(const std::string& file) {
  RobotOptions options;
  options.file = file, options.robot = "r";
  Model model;
  const Robot robot = add_robot(model, options);
  validate(model, file);
  return {true, words(robot.warnings, robot.notes), differs_from_second(options, model, robot)};
}

FuzzVerdict judge_scene(const std::string& file, const std::string& text) {
  const Scene scene = load_scene(file);
  FuzzVerdict out{true, words(scene.warnings, scene.notes), {}};
  double said = 0, held = 0;
  try {
    for (const YAML::Node& box : YAML::Load(text)["boxes"]) {
      const std::string mass = box["mass"].as<std::string>();
      char* end = nullptr;
      said += std::strtod(mass.c_str(), &end);
      if (std::string_view(end).find_first_not_of(" \t\r\n") != std::string_view::npos) out.finding = "mass '" + mass + "' is taken for a number";  // a carriage return alone is a line break of YAML
    }
  } catch (const YAML::Exception& e) {
    out.finding = std::string("loads, though: ") + e.what();
    return out;
  }
  for (const Body& b : scene.model.bodies)
    if (b.name.find('/') == std::string::npos) held += b.mass;
  if (!(std::fabs(said - held) <= 1e-12 * std::fabs(said))) out.finding = "boxes of " + std::to_string(held) + " kg, " + std::to_string(said) + " kg in the text";
  return out;
}

/// The first entry of `said` that is not in `held`, or "".
std::string dropped(const json& said, const json& held, const std::string& at) {
  if (said.is_object()) {
    for (const auto& [key, value] : said.items()) {
      if (!held.is_object() || !held.contains(key)) return at + "/" + key;
      if (const std::string found = dropped(value, held[key], at + "/" + key); !found.empty()) return found;
    }
    return {};
  }
  if (said.is_array() && held.is_array() && said.size() == held.size()) {
    for (std::size_t i = 0; i < said.size(); ++i)
      if (const std::string found = dropped(said[i], held[i], at + "/" + std::to_string(i)); !found.empty()) return found;
    return {};
  }
  return said == held ? std::string() : at;
}

FuzzVerdict judge_spec(const std::string& file, const std::string& text) {
  const generators::Spec spec = generators::from_json(text, file);
  FuzzVerdict out{true, {}, {}};
  const std::string lost = dropped(json::parse(text, nullptr, false), json::parse(generators::to_json(spec)), "");
  if (!lost.empty()) out.finding = "the spec does not hold " + lost + " of the text";
  return out;
}

FuzzVerdict judged(const FuzzText& text, const std::string& file, std::uint64_t seed) {
  if (text.format == "urdf") return judge_urdf(file, seed % 2 == 1);
  if (text.format == "yaml") return judge_scene(file, text.text);
  if (text.format == "json") return judge_spec(file, text.text);
  return judge_robot(file);
}

}  // namespace

FuzzVerdict judge_text(const FuzzText& text, const std::string& folder, std::uint64_t seed) {
  const std::string file = folder + "/case." + text.format;
  std::ofstream(file, std::ios::binary) << text.text;
  try {
    return judged(text, file, seed);
  } catch (const ModelError& e) {
    FuzzVerdict out{false, e.what(), {}};
    if (out.message.find("case.") == std::string::npos && out.message.find("fuzz.urdf") == std::string::npos) out.finding = "the refusal names no file: " + out.message;
    return out;
  } catch (const std::exception& e) {
    return {false, e.what(), std::string("no ModelError: ") + e.what()};
  }
}

void prepare_fuzz_folder(const std::string& folder) {
  std::ofstream(folder + "/fuzz.urdf", std::ios::binary) << fuzz_texts().front().text;
}

}  // namespace delassus
