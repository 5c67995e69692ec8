#include "generators/spec.h"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "algorithms/errors/closest.h"
#include "algorithms/errors/status.h"

namespace delassus::generators {
namespace {

using nlohmann::json;

constexpr std::array joint_names{"revolute", "prismatic", "cylindrical", "universal",
                                 "planar",   "spherical", "floating",    "generic"};
constexpr std::array constraint_names{"point", "weld", "hinge", "distance", "plane", "contact", "generic"};
constexpr std::array damping_names{"zero", "rows", "block"};

/// Reads one JSON object and names the file and element in every error.
class Reader {
 public:
  Reader(const json& object, std::string file, std::string element)
      : object_(object), file_(std::move(file)), element_(std::move(element)) {
    if (!object_.is_object()) fail("is not an object", "a JSON object");
  }

  template <class T> T get(const char* key, const char* accepted) const {
    if (!object_.contains(key)) fail(std::string("has no ") + key, accepted);
    return convert<T>(object_[key], key, accepted);
  }
  template <class T> std::optional<T> optional(const char* key, const char* accepted) const {
    if (!object_.contains(key) || object_[key].is_null()) return std::nullopt;
    return convert<T>(object_[key], key, accepted);
  }
  template <class E, std::size_t N> E choice(const char* key, const std::array<const char*, N>& names) const {
    std::string accepted;
    for (const char* n : names) accepted += (accepted.empty() ? "" : ", ") + std::string(n);
    const auto text = get<std::string>(key, accepted.c_str());
    for (std::size_t k = 0; k < N; ++k)
      if (text == names[k]) return static_cast<E>(k);
    fail(std::string(key) + " is " + text, accepted);
  }
  [[nodiscard]] Reader child(const char* key) const { return {get<json>(key, "an object"), file_, element_ + "." + key}; }
  /// Calls each(reader) for the elements of an array; no array: none.
  template <class F> void for_each(const char* key, F each) const {
    if (!object_.contains(key)) return;
    if (!object_[key].is_array()) fail(std::string(key) + " is not an array", "an array of objects");
    std::size_t k = 0;
    for (const json& x : object_[key])
      each(Reader(x, file_, element_ + "." + key + "[" + std::to_string(k++) + "]"));
  }

 private:
  template <class T> T convert(const json& value, const char* key, const char* accepted) const {
    try {
      if (!holds<T>(value)) fail(std::string(key) + " is " + value.dump(), accepted);
      const T out = value.get<T>();
      if (json(out) != value) fail(std::string(key) + " is " + value.dump(), accepted);  // 1.5 or a fourth entry would be dropped
      return out;
    } catch (const json::exception&) {
      fail(std::string(key) + " is " + value.dump(), accepted);
    }
  }
  [[noreturn]] void fail(const std::string& problem, const std::string& accepted) const {
    throw ModelError(file_, element_, problem, accepted + "; specs are written by `delassus stress`");
  }

  /// Whether the numbers of a value are whole and in the range of T: the library converts others as C++ does, or not at all.
  template <class T> static bool holds(const json& value) {
    if constexpr (std::is_integral_v<T>) {
      if (value.is_number_unsigned()) return std::in_range<T>(value.get<std::uint64_t>());
      return value.is_number_integer() && std::in_range<T>(value.get<std::int64_t>());
    } else if constexpr (requires { requires std::is_integral_v<typename T::value_type>; } && !std::is_same_v<T, std::string>) {
      return value.is_array() && std::all_of(value.begin(), value.end(), holds<typename T::value_type>);
    }
    return true;
  }

  json object_;
  std::string file_, element_;
};

template <class T> json optional_json(const std::optional<T>& x) { return x ? json(*x) : json(nullptr); }

json write(const DampingSpec& d) {
  return {{"kind", damping_names[static_cast<std::size_t>(d.kind)]}, {"low", d.low}, {"high", d.high}, {"seed", d.seed}};
}

json write(const BodySpec& b) {
  return {{"parent", b.parent}, {"joint", joint_names[static_cast<std::size_t>(b.joint)]}, {"dof", b.dof},
          {"axis", b.axis}, {"offset", b.offset}, {"bend_decade", optional_json(b.bend_decade)},
          {"mass_decade", optional_json(b.mass_decade)}, {"length_decade", b.length_decade},
          {"armature_decade", optional_json(b.armature_decade)}, {"seed", b.seed}};
}

json write(const LinkConstraintSpec& c) {
  json j{{"kind", constraint_names[static_cast<std::size_t>(c.kind)]}, {"rows", c.rows}, {"bodies", c.bodies},
         {"seed", c.seed}, {"damping", write(c.damping)}};
  if (c.at) j["at"] = *c.at;
  if (c.axis) j["axis"] = *c.axis;
  return j;
}

json write(const JointConstraintSpec& c) {
  return {{"body", c.body}, {"rows", c.rows}, {"seed", c.seed}, {"damping", write(c.damping)}};
}

constexpr const char* an_integer = "an integer";
constexpr const char* seed_text = "a non-negative integer";
constexpr const char* triple = "three integers";
constexpr const char* a_decade = "an integer decade, or null";

DampingSpec read_damping(const Reader& r) {
  DampingSpec d;
  d.kind = r.choice<DampingKind>("kind", damping_names);
  d.low = r.get<int>("low", an_integer);
  d.high = r.get<int>("high", an_integer);
  d.seed = r.get<std::uint64_t>("seed", seed_text);
  return d;
}

BodySpec read_body(const Reader& r) {
  BodySpec b;
  b.parent = r.get<Index>("parent", "-1 or an earlier body");
  b.joint = r.choice<JointKind>("joint", joint_names);
  b.dof = r.get<Index>("dof", "0 to 6");
  b.axis = r.get<std::array<int, 3>>("axis", triple);
  b.offset = r.get<std::array<int, 3>>("offset", triple);
  b.bend_decade = r.optional<int>("bend_decade", a_decade);
  b.mass_decade = r.optional<int>("mass_decade", a_decade);
  b.length_decade = r.get<int>("length_decade", an_integer);
  b.armature_decade = r.optional<int>("armature_decade", a_decade);
  b.seed = r.get<std::uint64_t>("seed", seed_text);
  return b;
}

LinkConstraintSpec read_link(const Reader& r) {
  LinkConstraintSpec c;
  c.kind = r.choice<ConstraintKind>("kind", constraint_names);
  c.rows = r.get<Index>("rows", an_integer);
  c.bodies = r.get<std::vector<Index>>("bodies", "a list of bodies");
  c.seed = r.get<std::uint64_t>("seed", seed_text);
  c.damping = read_damping(r.child("damping"));
  c.at = r.optional<std::array<int, 3>>("at", triple);
  c.axis = r.optional<std::array<int, 3>>("axis", triple);
  return c;
}

JointConstraintSpec read_joint(const Reader& r) {
  JointConstraintSpec c;
  c.body = r.get<Index>("body", "a body");
  c.rows = r.get<Index>("rows", an_integer);
  c.seed = r.get<std::uint64_t>("seed", seed_text);
  c.damping = read_damping(r.child("damping"));
  return c;
}

/// Every key of `said` must be one that is written.
void check_keys(const json& said, const json& written, const std::string& file, const std::string& element) {
  if (said.is_array() && written.is_array())
    for (std::size_t i = 0; i < std::min(said.size(), written.size()); ++i)
      check_keys(said[i], written[i], file, element + "[" + std::to_string(i) + "]");
  if (!said.is_object() || !written.is_object()) return;
  for (const auto& [key, value] : said.items()) {
    if (!written.contains(key)) {
      std::string accepted;
      std::vector<std::string> names;
      for (const auto& [known, ignored] : written.items()) names.push_back(known), accepted.append(accepted.empty() ? "" : ", ").append(known);
      throw ModelError(file, element, "has the unknown key \"" + key + "\"", did_you_mean(key, names) + accepted + "; take it out");
    }
    check_keys(value, written[key], file, element + "." + key);
  }
}

}  // namespace

Index dof_count(const BodySpec& b) {
  switch (b.joint) {
    case JointKind::revolute:
    case JointKind::prismatic: return 1;
    case JointKind::cylindrical:
    case JointKind::universal: return 2;
    case JointKind::planar:
    case JointKind::spherical: return 3;
    case JointKind::floating: return 6;
    case JointKind::generic: return b.dof;
  }
  return 0;
}

std::string to_json(const Spec& spec) {
  json j{{"family", spec.family}, {"seed", spec.seed}, {"bodies", json::array()}, {"links", json::array()},
         {"joints", json::array()}};
  for (const BodySpec& b : spec.bodies) j["bodies"].push_back(write(b));
  for (const LinkConstraintSpec& c : spec.links) j["links"].push_back(write(c));
  for (const JointConstraintSpec& c : spec.joints) j["joints"].push_back(write(c));
  if (spec.turn) j["turn"] = *spec.turn;
  return j.dump(1);
}

namespace {

/// Where the text stops being JSON; numbers beyond double are such a place.
[[noreturn]] void not_json(const std::string& text, const std::string& file) {
  std::string why = "is not JSON";
  try {
    const json parsed = json::parse(text);
  } catch (const json::exception& e) {
    why += std::string(": ") + e.what();
  }
  throw ModelError(file, "document", why, "one JSON object, numbers in the range of double; write it as `delassus stress` does");
}

}  // namespace

Spec from_json(const std::string& text, const std::string& file) {
  const json j = json::parse(text, nullptr, false);
  if (j.is_discarded()) not_json(text, file);
  const Reader r(j, file, "spec");
  Spec spec;
  spec.family = r.get<std::string>("family", "a name");
  spec.seed = r.get<std::uint64_t>("seed", seed_text);
  spec.turn = r.optional<std::uint64_t>("turn", seed_text);
  r.for_each("bodies", [&](const Reader& x) { spec.bodies.push_back(read_body(x)); });
  r.for_each("links", [&](const Reader& x) { spec.links.push_back(read_link(x)); });
  r.for_each("joints", [&](const Reader& x) { spec.joints.push_back(read_joint(x)); });
  check_keys(j, json::parse(to_json(spec)), file, "spec");
  return spec;
}

}  // namespace delassus::generators
