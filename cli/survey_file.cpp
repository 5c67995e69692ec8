#include "algorithms/kit/test_scalars.h"
#include "cli/survey_file.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "algorithms/delassus.h"
#include "models/robot.h"
#include "property_tests/second_reading/mjcf_reading.h"
#include "property_tests/second_reading/second_reading.h"
#include "property_tests/laws/verdict.h"
#include "reference/sdf_witness.h"
#include "reference/sensitivity.h"
#include "reference/urdf_witness.h"

namespace delassus::cli {

namespace {

using reference::UrdfWitness;

std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string extension(const std::string& file) {
  std::string e = std::filesystem::path(file).extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return e;
}

/// Name of the first element of an XML text: "robot", "mujoco", "sdf", … or "".
std::string root_element(const std::string& text) {
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    if (text.compare(at, 4, "<!--") == 0) at = text.find("-->", at);
    else if (text.compare(at, 2, "<?") == 0 || text.compare(at, 2, "<!") == 0) at = text.find('>', at);
    else {
      const std::size_t end = text.find_first_of(" \t\r\n/>", at + 1);
      return text.substr(at + 1, (end == std::string::npos ? text.size() : end) - at - 1);
    }
    if (at == std::string::npos) break;
  }
  return {};
}

/// Collects errors of urdfdom.
class Said : public console_bridge::OutputHandler {
 public:
  Said() { console_bridge::useOutputHandler(this); }
  ~Said() override { console_bridge::restorePreviousOutputHandler(); }
  Said(const Said&) = delete;
  Said& operator=(const Said&) = delete;
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && said.empty()) said = text;
  }
  std::string said;
};

/// A message without what differs from file to file: names, numbers, lines, what is accepted.
std::string kind_of(const std::string& file, std::string why) {
  if (why.rfind(file + ": ", 0) == 0) why = why.substr(file.size() + 2);
  why = why.substr(0, why.find(" (accepted"));
  std::string out;
  for (std::size_t i = 0; i < why.size(); ++i) {
    const char c = why[i];
    const bool number = std::isdigit(static_cast<unsigned char>(c)) && (i == 0 || !std::isalnum(static_cast<unsigned char>(why[i - 1])));
    if (c == '"') {
      const std::size_t end = why.find('"', i + 1);
      if (end == std::string::npos) break;
      out += "\"…\"";
      i = end;
    } else if (number) {
      while (i + 1 < why.size() && (std::isalnum(static_cast<unsigned char>(why[i + 1])) || why[i + 1] == '.' || ((why[i + 1] == '-' || why[i + 1] == '+') && (why[i] == 'e' || why[i] == 'E')))) ++i;
      out += "#";
    } else {
      out += c;
    }
  }
  return out.substr(0, 160);
}

struct Loaded {
  Model model;
  Robot robot;
};

RobotOptions options_of(const std::string& file, RobotOptions::Base base, bool given, const SurveyOptions& o) {
  RobotOptions options;
  options.file = file, options.robot = "robot";
  options.base = base, options.base_given = given;
  options.strict = o.strict, options.armature_of_all = o.armature;
  return options;
}

Loaded load(const RobotOptions& options) {
  Loaded out;
  out.robot = add_robot(out.model, options);
  validate(out.model, options.file);
  return out;
}

/// A configuration in general position; the same for the same seed everywhere.
VectorX<double> pose(const Model& model, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const auto number = [&] { return 2 * std::ldexp(static_cast<double>(engine() >> 11), -53) - 1; };
  VectorX<double> q(model.q_size());
  for (Index k = 0; k < q.size(); ++k) q[k] = number();
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const JointType type = model.bodies[b].joint.type;
    if (type == JointType::revolute) q[model.first_q[b]] *= 3;
    if (type == JointType::floating) q.segment<4>(model.first_q[b] + 3).normalize();
    if (type == JointType::spherical) q.segment<4>(model.first_q[b]).normalize();
  }
  return q;
}

struct Ratios {
  double M = 0, J = 0, A = 0, apply = 0;
  Index rows = 0;   ///< of J, compared
};

void raise(double& largest, double ratio) { largest = std::max(largest, std::isnan(ratio) ? std::numeric_limits<double>::infinity() : ratio); }

/// A0 of an operator, column by column, against the definition.
void judge_operator(const Problem<double>& problem, const Damping<double>& none, const reference::Sensitivity& sensitivity, double& largest) {
  const Index m = problem.structure->rows;
  const auto op = find_operator("aba_sweep").make<double>();
  op->analyze(problem.structure);
  static_cast<void>(op->update(problem, none));
  Workspace<double> workspace(op->workspace(m));
  MatrixX<double> A(m, m);
  if (!op->apply(MatrixX<double>::Identity(m, m), A, workspace).ok()) return raise(largest, std::numeric_limits<double>::infinity());
  const MatrixX<Quad> error = A.cast<Quad>() - sensitivity.matrices().A0;
  for (Index j = 0; j < m; ++j) {
    const VectorX<double> bound = sensitivity.apply_sensitivity(VectorX<double>::Unit(m, j));
    raise(largest, laws::judge(error.col(j), bound.cast<Quad>(), unit_roundoff<double>, "apply").ratio);
  }
}

/// `second` is null for a file that has no second reading here: then the operator is held against the definition alone.
void compare(Loaded& loaded, SecondReading* second, const SurveyOptions& o, Ratios& out) {
  if (second != nullptr) second->add_welds(loaded.model, loaded.robot);
  if (loaded.model.dofs() == 0) return;
  for (int k = 0; k < o.poses; ++k) {
    VectorX<double> q = pose(loaded.model, static_cast<std::uint64_t>(k) + 1);
    const reference::WitnessMatrices theirs = second == nullptr ? reference::WitnessMatrices() : second->matrices(loaded.model, loaded.robot, q);
    const Problem<double> problem = kinematics<double>(loaded.model, q);
    const Damping<double> none = Damping<double>::uniform(problem.structure->rows, 0);
    const reference::Sensitivity sensitivity(problem, none);
    const reference::Dense<Quad>& ours = sensitivity.matrices();
    if (problem.structure->rows > 0) judge_operator(problem, none, sensitivity, out.apply);
    if (second == nullptr) continue;
    raise(out.M, worst_ratio(ours.M, theirs.M, theirs.M_bound));
    raise(out.J, worst_ratio(ours.J, theirs.J, theirs.J_bound));
    if (theirs.regular) raise(out.A, worst_ratio(ours.A0, theirs.A0, theirs.A_bound));
    out.rows = theirs.J.rows();
  }
}

json number_json(double x) { return std::isfinite(x) ? json(x) : json("infinity"); }

/// Mass of all links that something moves.
double moved_mass(const UrdfWitness& w, bool base_moves) {
  double mass = 0;
  std::vector<char> moved(w.links.size());
  for (const Index i : w.order) {
    const auto k = static_cast<std::size_t>(i);
    const Index j = w.links[k].joint;
    moved[k] = j < 0 ? base_moves : moved[static_cast<std::size_t>(w.joints[static_cast<std::size_t>(j)].parent)] || w.joints[static_cast<std::size_t>(j)].kind != UrdfWitness::Kind::fixed;
    if (moved[k]) mass += w.links[k].mass;
  }
  return mass;
}

/// The second reading of a robot that loaded; null, with the reason in `not_compared`, where there is none.
std::unique_ptr<SecondReading> second_of(const RobotOptions& options, json& j) {
  try {
    std::unique_ptr<SecondReading> out = second_reading(options);
    if (out == nullptr) j["not_compared"] = "this build is without MuJoCo";
    else j["moving"] = out->moves() ? 1 : 0;
    return out;
  } catch (const reference::NotServed& e) {
    j["not_compared"] = e.what();
    return nullptr;
  }
}

void loaded_json(Loaded& loaded, const RobotOptions& options, const UrdfWitness* witness, const SurveyOptions& o, json& j) {
  j["state"] = "loads";
  j["bodies"] = loaded.model.bodies.size();
  j["dof"] = loaded.model.dofs();
  double mass = 0;
  for (const Body& b : loaded.model.bodies) mass += b.mass;
  j["mass"] = mass;
  j["warnings"] = json::array();
  for (const Warning& w : loaded.robot.warnings) j["warnings"].push_back({{"kind", w.kind}, {"text", w.text}});
  j["notes"] = loaded.robot.notes;
  Ratios r;
  try {
    if (witness != nullptr) {
      const double theirs = moved_mass(*witness, !loaded.robot.root_joint.empty());
      if (std::fabs(mass - theirs) > laws::pass_below * unit_roundoff<double> * theirs * static_cast<double>(witness->links.size()))
        throw std::runtime_error(json(mass).dump() + " kg in the model, " + json(theirs).dump() + " kg in the file");
    }
    if (o.poses == 0) return;
    const std::unique_ptr<SecondReading> second = second_of(options, j);
    compare(loaded, second.get(), o, r);
    j["ratios"] = {{"apply", number_json(r.apply)}};
    if (second != nullptr) j["ratios"].update({{"M", number_json(r.M)}, {"J", number_json(r.J)}, {"A", number_json(r.A)}}), j["rows"] = r.rows;
    if (std::max({r.M, r.J, r.A, r.apply}) >= laws::pass_below) j["differs"] = "ratio " + json(number_json(std::max({r.M, r.J, r.A, r.apply}))).dump();
  } catch (const std::exception& e) {
    j["differs"] = e.what();
  }
}

/// "" or why the library that defines the format does not read the file either: MuJoCo is asked again, without our reader;
/// libsdformat's words are in the refusal. What is no XML, or no robot, the second reading of SDF says.
std::string library_says(const std::string& file, const std::string& why) {
  if (why.find(": libsdformat: ") != std::string::npos) return "libsdformat does not read it";
  try {
    if (const std::string says = mujoco_refuses(file); !says.empty()) return "MuJoCo does not read it";
    if (extension(file) == ".sdf") static_cast<void>(reference::read_sdf_witness(file));
  } catch (const reference::NotServed&) {
  } catch (const std::exception& e) {
    return std::string("the second reading finds: ") + e.what();
  }
  return {};
}

/// Why a refusal is right without a look at the message, or null.
json right(const std::string& file, const json& j) {
  if (j.contains("urdfdom") && j["urdfdom"].is_string()) return "urdfdom does not read it";
  if (j.contains("urdfdom") && j["urdfdom"].is_object()) return "urdfdom drops a part of it: " + j["urdfdom"]["dropped"].get<std::string>().substr(0, 80);
  if (j.contains("regular") && !j["regular"]["free"].get<bool>() && !j["regular"]["fixed"].get<bool>()) return "M is singular or indefinite";
  if (j.contains("urdfdom")) return nullptr;
  if (const std::string says = library_says(file, j["why"].get<std::string>()); !says.empty()) return says;
  return nullptr;
}

}  // namespace

json urdfdom_says(const std::string& file) {
  const std::string text = bytes_of(file);
  if (text.find('<') == std::string::npos) return "no XML";
  Said listener;
  try {
    if (urdf::parseURDF(text)) return listener.said.empty() ? json(nullptr) : json{{"dropped", listener.said}};
  } catch (const std::exception& e) {
    return std::string(e.what());
  }
  return listener.said.empty() ? "no model" : listener.said;
}

bool is_robot_file(const std::string& file) {
  const std::string e = extension(file);
  if (e == ".urdf") return true;
  if (e != ".xml" && e != ".sdf") return false;
  const std::string root = root_element(bytes_of(file));
  return e == ".xml" ? root == "mujoco" : root == "sdf";
}

json survey_file(const std::string& file, const json& urdfdom, const SurveyOptions& o) {
  json j = {{"file", file}};
  std::optional<UrdfWitness> witness;
  if (extension(file) == ".urdf") {
    j["urdfdom"] = urdfdom;
    j["witness"] = nullptr;
    try {
      witness = reference::read_urdf_witness(file);
      j["moving"] = witness->moving();
      j["regular"] = {{"free", reference::urdf_regular(*witness, true)}, {"fixed", reference::urdf_regular(*witness, false)}};
    } catch (const std::exception& e) {
      j["witness"] = e.what();
    }
  }
  const auto attempt = [&](RobotOptions::Base base, bool given) {
    try {
      const RobotOptions options = options_of(file, base, given, o);
      Loaded loaded = load(options);
      j["base"] = loaded.robot.root_joint.empty() ? "fixed" : "free";
      loaded_json(loaded, options, witness ? &*witness : nullptr, o, j);
      return true;
    } catch (const ModelError& e) {
      j["state"] = "refused";
      if (!j.contains("why")) j["why"] = e.what(), j["kind"] = kind_of(file, e.what());
    } catch (const std::exception& e) {
      j["state"] = "refused";
      j["why"] = j["kind"] = std::string("internal error: ") + e.what();
      j["differs"] = e.what();
    }
    return false;
  };
  const bool free = o.base != "fixed" && attempt(RobotOptions::Base::free, o.base == "free");
  if (!free && o.base != "free" && attempt(RobotOptions::Base::fixed, true) && o.base == "auto") j["free_base"] = j["kind"];
  if (j["state"] == "refused") j["right"] = right(file, j);
  return j;
}

}  // namespace delassus::cli
