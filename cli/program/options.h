// Options of a command line, for the program `delassus` and the programs of the tests. Numbers are read in one place:
// whoever gives anything else is told the option, the value, and what is accepted in which unit. CLI11 does the work, in
// options.cpp alone: it takes long to compile.
//
//   options::Command app{"what it does"};
//   app.add_option("--damping", x, "R⁻¹ of every row [1/kg]")->check(options::at_least(0, "1/kg"));
//   return options::run(app, argc, argv, [&] { return …; });
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace delassus::options {

/// What is wrong with the text of an option; empty: nothing.
using Check = std::function<std::string(const std::string& text)>;

/// A finite number ≥ `least`, or > `least`. `unit` is empty for a ratio.
[[nodiscard]] Check at_least(double least, const std::string& unit);
/// Any finite number.
[[nodiscard]] Check any_number(const std::string& unit);
/// At least `least`, or inf.
[[nodiscard]] Check at_least_or_inf(double least, const std::string& unit);
[[nodiscard]] Check above(double least, const std::string& unit);
/// A number above 0 of seconds, or one with s, m or h behind it: 60, 60s, 10m, 2h.
[[nodiscard]] Check duration();
/// What such a text is in seconds, NaN for any other.
[[nodiscard]] double seconds_of(const std::string& text);
/// A whole number from `least` to 2⁶³ − 1.
[[nodiscard]] Check whole(std::int64_t least);
[[nodiscard]] Check one_of(const std::vector<std::string>& words);
[[nodiscard]] Check existing_file();
[[nodiscard]] Check existing_directory();

/// An option or a flag, to be described further.
class Option {
 public:
  explicit Option(void* option) : option_(option) {}
  Option* check(const Check& good);
  Option* required();
  Option* needs(const Option* other);
  Option* excludes(const Option* other);
  Option* capture_default_str();            ///< --help shows the default
  [[nodiscard]] std::size_t count() const;  ///< how often it was given

 private:
  void* option_;  // of CLI11
};

/// A program or one of its subcommands. The variables named in it must outlive it.
class Command {
 public:
  explicit Command(const std::string& what);
  ~Command();
  Command(Command&&) noexcept;
  Command& operator=(Command&&) = delete;

  Command* add_subcommand(const std::string& name, const std::string& what);
  /// A value, an optional one, or a list: the option may be repeated then, and take several.
  Option* add_option(const std::string& name, std::string& value, const std::string& help);
  Option* add_option(const std::string& name, double& value, const std::string& help);
  Option* add_option(const std::string& name, std::int64_t& value, const std::string& help);
  Option* add_option(const std::string& name, std::uint64_t& value, const std::string& help);
  Option* add_option(const std::string& name, std::optional<double>& value, const std::string& help);
  Option* add_option(const std::string& name, std::optional<std::uint64_t>& value, const std::string& help);
  Option* add_option(const std::string& name, std::optional<std::string>& value, const std::string& help);
  Option* add_option(const std::string& name, std::vector<std::string>& values, const std::string& help);
  Option* add_option(const std::string& name, std::vector<double>& values, const std::string& help);
  Option* add_flag(const std::string& name, bool& value, const std::string& help);
  /// What is called with the text of an option; it may throw std::invalid_argument with what is wrong.
  Option* add_option_function(const std::string& name, const std::function<void(const std::string&)>& take, const std::string& help);
  void footer(const std::string& text);
  void callback(const std::function<void()>& chosen);  ///< called when this subcommand was given
  void require_subcommand();
  [[nodiscard]] std::vector<std::string> subcommands() const;

  /// Reads a command line: no value when the program may go on, else its exit code: 0 after --help, 2 with `error` set.
  [[nodiscard]] std::optional<int> parse(int argc, char** argv, std::string& error);

 private:
  struct Parts;
  explicit Command(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// One of several runs that share the work.
struct Shard {
  std::uint64_t number = 1, of = 1;   ///< 1 ≤ number ≤ of
};
/// --shard i/n.
void add_shard(Command& app, Shard& shard);

/// Reads the command line and runs; returns the exit code: that of `program`, 0 after --help, 2 for wrong usage and for
/// any exception of `program`, both with a message on standard error.
[[nodiscard]] int run(Command& app, int argc, char** argv, const std::function<int()>& program);

}  // namespace delassus::options
