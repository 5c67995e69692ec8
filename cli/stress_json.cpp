#include "cli/stress_json.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "algorithms/errors/status.h"
#include "generators/classes.h"

namespace delassus::cli {

namespace {

/// An element of a JSON object, or a ModelError that names it.
template <class T> T get(const json& j, const char* key, const std::string& file, const char* accepted) {
  if (!j.is_object() || !j.contains(key)) throw ModelError(file, key, "is missing", std::string(accepted) + "; a file as `delassus stress` writes it");
  try {
    return j[key].get<T>();
  } catch (const json::exception&) {
    throw ModelError(file, key, "is " + j[key].dump(), std::string(accepted) + "; a file as `delassus stress` writes it");
  }
}

constexpr const char* count = "a non-negative integer";
constexpr const char* any_text = "text";

}  // namespace

std::string read_text(const std::string& file) {
  std::ifstream in(file);
  std::ostringstream all;
  if (in) all << in.rdbuf();
  if (!in) throw ModelError(file, "file", "cannot be read", "a readable file; check the path");
  return all.str();
}

void write_text(const std::string& file, const std::string& content) {
  std::ofstream out(file);
  out << content << '\n';
  if (!out.flush()) throw ModelError(file, "file", "cannot be written", "a path in an existing, writable folder; make the folder first");
}

json failure_json(const laws::Failure& f) {
  return {{"law", f.law}, {"operator", f.op}, {"ratio", std::isfinite(f.ratio) ? json(f.ratio) : json("infinity")},
          {"note", f.note}, {"seed", f.seed}, {"found_bodies", f.found_bodies}, {"tried", f.tried},
          {"spec", json::parse(generators::to_json(f.spec))}};
}

laws::Failure read_failure(const json& j, const std::string& file) {
  laws::Failure f;
  f.law = get<std::string>(j, "law", file, "the name of a law");
  f.op = get<std::string>(j, "operator", file, "the name of an operator");
  const auto ratio = get<json>(j, "ratio", file, "a number or \"infinity\"");
  f.ratio = ratio.is_number() ? ratio.get<double>() : std::numeric_limits<double>::infinity();
  f.note = get<std::string>(j, "note", file, any_text);
  f.seed = get<std::uint64_t>(j, "seed", file, count);
  f.found_bodies = get<std::size_t>(j, "found_bodies", file, count);
  f.tried = get<int>(j, "tried", file, count);
  f.spec = generators::from_json(get<json>(j, "spec", file, "a spec").dump(), file);
  return f;
}

json found_json(const laws::Found& f) {
  json out = {{"seed", f.seed}, {"shard", f.shard}, {"shards", f.shards}, {"problems", f.problems}, {"checks", f.checks},
              {"skipped", f.skipped}, {"seconds", f.seconds}, {"classes", json::object()}, {"failures", json::array()}};
  for (std::size_t k = 0; k < f.classes.size(); ++k)
    out["classes"][std::string(generators::classes()[k].name)] = f.classes[k];
  for (const laws::Failure& x : f.failures) out["failures"].push_back(failure_json(x));
  return out;
}

laws::Found read_found(const json& j, const std::string& file) {
  laws::Found f;
  f.seed = get<std::uint64_t>(j, "seed", file, count);
  f.shard = get<int>(j, "shard", file, count);
  f.shards = get<int>(j, "shards", file, count);
  f.problems = get<std::int64_t>(j, "problems", file, count);
  f.checks = get<std::int64_t>(j, "checks", file, count);
  f.skipped = get<std::int64_t>(j, "skipped", file, count);
  f.seconds = get<double>(j, "seconds", file, "seconds");
  const auto classes = get<json>(j, "classes", file, "an object of counts");
  for (const auto& row : generators::classes())
    f.classes.push_back(get<std::int64_t>(classes, std::string(row.name).c_str(), file, count));
  for (const json& x : get<json>(j, "failures", file, "an array")) f.failures.push_back(read_failure(x, file));
  return f;
}

}  // namespace delassus::cli
