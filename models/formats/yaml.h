// A YAML node that knows where it stands, so that every complaint names file:line, key and what is accepted.
#pragma once

#include <yaml-cpp/yaml.h>

#include <initializer_list>
#include <string>
#include <vector>

#include "algorithms/errors/status.h"
#include "algorithms/kit/spatial.h"

namespace delassus {

class Yaml {
 public:
  /// Parses a file holding one mapping. @throws ModelError when it cannot be read or is no YAML.
  static Yaml open(const std::string& file);
  /// A mapping made by the program in place of a file.
  static Yaml of(const std::string& file, const YAML::Node& mapping) { return {file, "", mapping, 1}; }

  /// @throws ModelError; `accepted` may end with what to do, after a semicolon: else the page with all keys is named.
  [[noreturn]] void fail(const std::string& problem, const std::string& accepted) const;
  /// Where the node stands, as messages say it: `file:line` and `robots[0].joints.j`.
  [[nodiscard]] std::string file_and_line() const { return file_ + ":" + std::to_string(line_); }
  [[nodiscard]] std::string key() const { return path_.empty() ? "scene" : path_; }

  /// A mapping with these keys only, each at most once.
  void keys(std::initializer_list<const char*> accepted) const;
  [[nodiscard]] bool has(const char* key) const;
  /// The value of a key that must be there.
  [[nodiscard]] Yaml at(const char* key) const;
  /// Key and value pairs of a mapping with free keys, in the order of the file; duplicates are errors.
  [[nodiscard]] std::vector<std::pair<std::string, Yaml>> entries() const;
  [[nodiscard]] std::vector<Yaml> list(const std::string& accepted) const;
  [[nodiscard]] bool is_map() const { return node_.IsMap(); }
  [[nodiscard]] bool is_list() const { return node_.IsSequence(); }
  [[nodiscard]] bool is_scalar() const { return node_.IsScalar(); }

  [[nodiscard]] double number(const std::string& unit) const;                ///< finite
  [[nodiscard]] double non_negative(const std::string& unit) const;
  [[nodiscard]] double positive(const std::string& unit) const;
  [[nodiscard]] Index index() const;                                         ///< a whole number ≥ 0
  [[nodiscard]] bool boolean() const;                                        ///< true or false
  [[nodiscard]] std::string text(const std::string& accepted) const;         ///< not empty
  [[nodiscard]] std::vector<double> numbers(const std::string& unit) const;  ///< a list of any length
  [[nodiscard]] Vector3<double> vector3(const std::string& unit) const;
  [[nodiscard]] Vector3<double> direction() const;                           ///< a vector that is not 0, normalised
  [[nodiscard]] MatrixX<double> matrix(Index rows, Index columns, const std::string& unit) const;  ///< −1: any number
  /// {xyz: [m], rpy: [rad]}, both optional.
  [[nodiscard]] Pose<double> pose() const;

 private:
  Yaml(std::string file, std::string path, const YAML::Node& node, int line)
      : file_(std::move(file)), path_(std::move(path)), node_(node), line_(line) {}
  [[nodiscard]] Yaml child(const std::string& key, const YAML::Node& node) const;

  std::string file_, path_;
  YAML::Node node_;
  int line_;
};

}  // namespace delassus
