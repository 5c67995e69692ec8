#include "models/formats/yaml.h"

#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/message.h"
#include "models/robot.h"

namespace delassus {
namespace {

/// Where documents start, and what they hold first: an empty one a null.
class Documents : public YAML::EventHandler {
 public:
  std::vector<YAML::Mark> starts, contents;

  void OnDocumentStart(const YAML::Mark& m) override { starts.push_back(m); }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& m, YAML::anchor_t) override { hold(m); }
  void OnAlias(const YAML::Mark& m, YAML::anchor_t) override { hold(m); }
  void OnScalar(const YAML::Mark& m, const std::string&, YAML::anchor_t, const std::string&) override { hold(m); }
  void OnSequenceStart(const YAML::Mark& m, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override { hold(m); }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& m, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override { hold(m); }
  void OnMapEnd() override {}

 private:
  void hold(const YAML::Mark& m) {
    if (contents.size() < starts.size()) contents.push_back(m);
  }
};

/// Of the one document of a file. Before a comma at its start yaml-cpp finds empty documents without end, all in one place.
YAML::Node only_document(const std::string& file) {
  std::ifstream in(file);
  YAML::Parser parser(in);
  Documents found;
  while (found.starts.size() < 3 && parser.HandleNextDocument(found)) {}
  if (found.starts.size() < 2) return found.starts.empty() ? YAML::Node() : YAML::LoadFile(file);
  if (found.starts.size() > 2 && found.starts[1].pos == found.starts[2].pos) throw YAML::ParserException(found.starts[1], "nothing can begin with a comma");
  throw ModelError(file + ":" + std::to_string(found.contents.at(1).line + 1), "YAML", "a second document, after ---", "one document per file; put the second into a file of its own");
}

}  // namespace

Yaml Yaml::open(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw ModelError(file, "file", "cannot be read", "a scene file (.yaml); check the path");
  try {
    const Yaml root(file, "", only_document(file), 1);
    if (!root.is_map()) root.fail("the file holds no mapping", "keys of a scene: robots, boxes, ...; docs/scenes.md has them all");
    return root;
  } catch (const YAML::BadFile&) {
    throw ModelError(file, "file", "cannot be read", "a scene file (.yaml); check the path");
  } catch (const YAML::Exception& e) {
    throw ModelError(file + ":" + std::to_string(e.mark.line + 1), "YAML", "broken: " + e.msg.substr(0, 200),
                     "well-formed YAML; check brackets and indentation in this line and the one before");
  }
}

void Yaml::fail(const std::string& problem, const std::string& accepted) const {
  const bool advised = accepted.find("; ") != std::string::npos;
  throw ModelError(file_and_line(), key(), problem, accepted + (advised ? "" : "; docs/scenes.md has every key with its unit"));
}

Yaml Yaml::child(const std::string& key, const YAML::Node& node) const {
  const int line = node.Mark().line >= 0 ? node.Mark().line + 1 : line_;
  return {file_, path_.empty() ? key : path_ + "." + key, node, line};
}

std::vector<std::pair<std::string, Yaml>> Yaml::entries() const {
  if (!node_.IsMap()) fail("is no mapping", "{key: value, ...}");
  std::vector<std::pair<std::string, Yaml>> out;
  std::set<std::string> seen;
  for (const auto& pair : node_) {
    const YAML::Node key = pair.first;
    if (!key.IsScalar()) fail("a key is no text", "{key: value, ...}");
    const std::string name = key.Scalar();
    std::string shown = in_quotes(name);
    if (shown.size() == name.size() + 2) shown = name;
    Yaml value = child(shown, pair.second);
    if (!seen.insert(name).second) value.fail("the key appears twice", "each key once; take one of them out");
    out.emplace_back(name, std::move(value));
  }
  return out;
}

void Yaml::keys(std::initializer_list<const char*> accepted) const {
  std::string all;
  for (const char* k : accepted) all += (all.empty() ? "" : ", ") + std::string(k);
  if (!node_.IsMap()) fail("is no mapping", "a mapping with the keys " + all);
  for (const auto& [name, value] : entries()) {
    bool known = false;
    for (const char* k : accepted) known = known || name == k;
    if (!known) value.fail("unknown key", did_you_mean(name, accepted) + all);
  }
}

bool Yaml::has(const char* key) const { return node_.IsMap() && node_[key].IsDefined(); }

Yaml Yaml::at(const char* key) const {
  if (!has(key)) fail("key " + std::string(key) + " is missing", std::string(key) + ": ...; give it a value");
  return child(key, node_[key]);
}

std::vector<Yaml> Yaml::list(const std::string& accepted) const {
  if (!node_.IsSequence()) fail("is no list", accepted);
  std::vector<Yaml> out;
  for (std::size_t i = 0; i < node_.size(); ++i) {
    Yaml item = child("", node_[i]);
    item.path_ = path_ + "[" + std::to_string(i) + "]";
    out.push_back(std::move(item));
  }
  return out;
}

double Yaml::number(const std::string& unit) const {
  const std::string accepted = "a finite number" + unit;
  if (!node_.IsScalar()) fail("is no number", accepted);
  const auto value = finite_number(node_.Scalar());
  if (value) return *value;
  const NotANumber why = not_a_number(node_.Scalar());
  fail(in_quotes(node_.Scalar()) + " " + why.problem, accepted + "; " + why.advice);
}

double Yaml::non_negative(const std::string& unit) const {
  const double x = number(" >= 0" + unit);
  if (x < 0) fail(in_quotes(node_.Scalar()) + " is negative", "a number >= 0" + unit + "; 0 for none");
  return x;
}

double Yaml::positive(const std::string& unit) const {
  const double x = number(" > 0" + unit);
  if (!(x > 0)) fail(in_quotes(node_.Scalar()) + " is not positive", "a number > 0" + unit + "; check sign and unit");
  return x;
}

Index Yaml::index() const {
  const double x = number(" (whole, >= 0)");
  if (x < 0 || x != std::floor(x) || x > 1e15) fail(in_quotes(node_.Scalar()) + " is no index", "a whole number >= 0; count from 0");
  return static_cast<Index>(x);
}

bool Yaml::boolean() const {
  if (node_.IsScalar() && node_.Scalar() == "true") return true;
  if (node_.IsScalar() && node_.Scalar() == "false") return false;
  fail((node_.IsScalar() ? in_quotes(node_.Scalar()) : "a list or mapping") + " is neither true nor false", "true, false; without quotes");
}

std::string Yaml::text(const std::string& accepted) const {
  if (!node_.IsScalar() || node_.Scalar().empty()) fail("is no text", accepted);
  return node_.Scalar();
}

std::vector<double> Yaml::numbers(const std::string& unit) const {
  std::vector<double> out;
  for (const Yaml& item : list("a list of numbers" + unit)) out.push_back(item.number(unit));
  return out;
}

Vector3<double> Yaml::vector3(const std::string& unit) const {
  const std::vector<double> v = numbers(unit);
  if (v.size() != 3) fail("has " + std::to_string(v.size()) + " entries", "3 numbers" + unit + "; x, y and z");
  return {v[0], v[1], v[2]};
}

Vector3<double> Yaml::direction() const {
  const Vector3<double> v = vector3("");
  if (v.stableNorm() == 0) fail("(" + numbers_text(v) + ") has no direction", "3 numbers, not all 0; any length will do");
  return v.stableNormalized();
}

MatrixX<double> Yaml::matrix(Index rows, Index columns, const std::string& unit) const {
  const std::string accepted = "a list of " + (rows < 0 ? std::string("1 to 6") : std::to_string(rows)) + " rows of " + std::to_string(columns) + " numbers" + unit;
  const std::vector<Yaml> items = list(accepted);
  if (items.empty() || (rows >= 0 && static_cast<Index>(items.size()) != rows)) fail("has " + std::to_string(items.size()) + " rows", accepted);
  MatrixX<double> out(static_cast<Index>(items.size()), columns);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::vector<double> v = items[i].numbers(unit);
    if (static_cast<Index>(v.size()) != columns) items[i].fail("has " + std::to_string(v.size()) + " entries", accepted);
    for (Index j = 0; j < columns; ++j) out(static_cast<Index>(i), j) = v[static_cast<std::size_t>(j)];
  }
  return out;
}

Pose<double> Yaml::pose() const {
  keys({"xyz", "rpy"});
  Pose<double> out;
  if (has("xyz")) out.translation = at("xyz").vector3(" [m]");
  if (has("rpy")) out.rotation = rotation_rpy(at("rpy").vector3(" [rad]"));
  return out;
}

}  // namespace delassus
