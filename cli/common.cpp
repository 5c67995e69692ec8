#include "cli/common.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>

#include "algorithms/errors/message.h"
#include "property_tests/defects/defects.h"
#include "cli/program/options.h"

namespace delassus::cli {

void add_scene_options(options::Command& app, SceneOptions& options) {
  app.add_flag("--strict", options.strict, "what is only doubtful in a scene or a robot's file is an error");
  const std::map<std::string, RobotOptions::Base> bases{
      {"free", RobotOptions::Base::free}, {"fixed", RobotOptions::Base::fixed}, {"planar", RobotOptions::Base::planar}};
  app.add_option_function("--base", [&options, bases](const std::string& text) { options.base = bases.at(text); },
                                       "of a robot's file: free, fixed or planar (default: free; fixed when the root link is named world)")
      ->check(options::one_of({"free", "fixed", "planar"}));
  app.add_option("--armature", options.armature, "of a robot's file: of every joint to which the file gives none [kg m² or kg]")
      ->check(options::at_least(0, "kg m² or kg"));
}

namespace {

constexpr std::size_t most_of_a_kind = 5;

/// The first few of each kind, then how many more there are.
void print_warnings(const std::vector<Warning>& warnings) {
  std::map<std::string, std::size_t> counts;
  for (const Warning& w : warnings)
    if (++counts[w.kind] <= most_of_a_kind) std::fprintf(stderr, "warning: %s\n", w.text.c_str());
  for (const auto& [kind, n] : counts)
    if (n > most_of_a_kind) std::fprintf(stderr, "warning: %s: %zu more of this kind, %zu in all (--json lists them)\n", kind.c_str(), n - most_of_a_kind, n);
  if (!warnings.empty()) std::fprintf(stderr, "%zu warning%s; --strict makes them errors\n", warnings.size(), warnings.size() == 1 ? "" : "s");
}

}  // namespace

json warnings_json(const Scene& scene) {
  json out = json::array();
  for (const Warning& w : scene.warnings) out.push_back({{"kind", w.kind}, {"text", w.text}});
  return out;
}

Scene open(const std::string& name, const SceneOptions& options, const std::optional<double>& damping) {
  Scene scene = open_scene(name, options);
  print_warnings(scene.warnings);
  if (!damping) return scene;
  if (!(std::isfinite(*damping) && *damping >= 0))
    throw ModelError("", "--damping", number_text(*damping) + " 1/kg", "a finite number ≥ 0 [1/kg]; leave it away for the scene's own");
  scene.damping = Damping<double>::uniform(static_cast<Index>(scene.damping.diagonal.size()), *damping);
  return scene;
}

json damping_json(const Damping<double>& damping) {
  std::vector<double> d = damping.diagonal;
  for (const auto& block : damping.blocks)
    for (Index i = 0; i < block.R_inverse.rows(); ++i) d[static_cast<std::size_t>(block.row + i)] = block.R_inverse(i, i);
  const bool same = damping.blocks.empty() && std::all_of(d.begin(), d.end(), [&](double x) { return x == d.front(); });
  if (same && !d.empty()) return d.front();
  return d;
}

json damping_blocks_json(const Damping<double>& damping) {
  json blocks = json::array();
  for (const auto& block : damping.blocks) blocks.push_back({{"row", block.row}, {"R_inverse", matrix_json(block.R_inverse)}});
  return blocks;
}

json finite_json(double x) { return std::isfinite(x) ? json(x) : json(nullptr); }
json known_json(double x) { return x < 0 ? json(nullptr) : finite_json(x); }

json matrix_json(const MatrixX<double>& m) {
  json rows = json::array();
  for (Index i = 0; i < m.rows(); ++i) {
    json row = json::array();
    for (Index j = 0; j < m.cols(); ++j) row.push_back(m(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

json report_json(const Report& r) {
  const auto known = [](double x) { return x < 0 ? json(nullptr) : json(x); };
  return {{"status", name(r.status)}, {"where", r.where < 0 ? json(nullptr) : json(r.where)}, {"iterations", r.iterations},
          {"backward_error", known(r.backward_error)}, {"error_bound", known(r.error_bound)},
          {"error_estimate", known(r.error_estimate)}, {"rcond_estimate", known(r.rcond_estimate)},
          {"rung", r.rung.empty() ? json(nullptr) : json(r.rung)}, {"rungs_tried", r.rungs_tried}};
}

namespace {

/// Takes no value; remembers where the text stops being JSON, a number beyond double included.
struct Position : nlohmann::json_sax<json> {
  std::size_t at = 0;
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return true; }
  bool key(string_t&) override { return true; }
  bool end_object() override { return true; }
  bool start_array(std::size_t) override { return true; }
  bool end_array() override { return true; }
  bool parse_error(std::size_t position, const std::string&, const json::exception& e) override {
    overflow = dynamic_cast<const json::out_of_range*>(&e) != nullptr;
    at = position;
    return false;
  }
  bool overflow = false;
};

/// Names the entry at which a text stops being a JSON array of numbers, and what stands there.
[[noreturn]] void not_json(const std::string& file, const std::string& text, const std::string& accepted) {
  Position stop;
  (void)json::sax_parse(text, &stop);
  const std::size_t at = std::min(text.size(), stop.at == 0 ? text.size() : stop.at - 1);
  const std::size_t begin = at == 0 ? 0 : text.find_last_of(",[ \n\t", at - 1) + 1, end = text.find_first_of(",] \n\t", at);
  const std::string word = text.substr(begin, std::min<std::size_t>(end - begin, 40));
  const auto entry = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), ',');
  throw ModelError(file, "entry " + std::to_string(entry),
                   stop.overflow ? word + " is not a finite number" : at == text.size() ? "the array ends too early" : "'" + word + "' is no JSON", accepted);
}

}  // namespace

VectorX<double> read_vector(const std::string& file, Index size, const std::string& meaning) {
  const std::string accepted = "a JSON array of " + std::to_string(size) + " finite numbers, " + meaning + "; `delassus describe` counts the rows";
  std::ifstream stream(file);
  if (!stream) throw ModelError(file, "file", "cannot be read", accepted);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const json j = json::parse(text, nullptr, false);
  if (j.is_discarded()) not_json(file, text, accepted);
  if (!j.is_array()) throw ModelError(file, "JSON", std::string("is of type ") + j.type_name(), accepted);
  if (static_cast<Index>(j.size()) != size)
    throw ModelError(file, "array", "has " + std::to_string(j.size()) + " entries", accepted);
  VectorX<double> x(size);
  for (Index i = 0; i < size; ++i) {
    const json& entry = j[static_cast<std::size_t>(i)];
    if (!entry.is_number() || !std::isfinite(entry.get<double>()))
      throw ModelError(file, "entry " + std::to_string(i), entry.dump() + " is not a finite number", accepted);
    x[i] = entry.get<double>();
  }
  return x;
}

std::vector<const OperatorRow*> chosen_operators(const std::vector<std::string>& names, const std::string& defect) {
  std::vector<const OperatorRow*> rows;
  if (!defect.empty()) rows.push_back(&laws::find_defect(defect).op);
  else if (names.empty())
    for (const OperatorRow& row : operators()) rows.push_back(&row);
  for (const std::string& name : names) rows.push_back(&find_operator(name));
  return rows;
}

}  // namespace delassus::cli
