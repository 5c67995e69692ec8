// Options of a command line, for the program `delassus` and the programs of the tests. Numbers are read in one place:
// whoever gives anything else is told the option, the value, and what is accepted in which unit.
//
//   CLI::App app{"what it does"};
//   app.add_option("--damping", x, "R⁻¹ of every row [1/kg]")->check(options::at_least(0, "1/kg"));
//   return options::run(app, argc, argv, [&] { return …; });
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <CLI/CLI.hpp>

namespace delassus::options {

/// A finite number ≥ `least`, or > `least`. `unit` is empty for a ratio.
[[nodiscard]] CLI::Validator at_least(double least, const std::string& unit);
[[nodiscard]] CLI::Validator above(double least, const std::string& unit);
/// A whole number from `least` to 2⁶³ − 1.
[[nodiscard]] CLI::Validator whole(std::int64_t least);

/// One of several runs that share the work.
struct Shard {
  std::uint64_t number = 1, of = 1;   ///< 1 ≤ number ≤ of
};
/// --shard i/n.
void add_shard(CLI::App& app, Shard& shard);

/// Reads the command line and runs; returns the exit code: that of `program`, 0 after --help, 2 for wrong usage and for
/// any exception of `program`, both with a message on standard error.
[[nodiscard]] int run(CLI::App& app, int argc, char** argv, const std::function<int()>& program);

}  // namespace delassus::options
