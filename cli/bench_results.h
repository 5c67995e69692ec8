// `delassus bench --table1`, `--peers`, `--simulation`, `--swimmers`, `--ladders`, `--solvers`, `--choose` and `--compare`: results measured, or printed from files of results.
#pragma once

#include <string>
#include <vector>

namespace delassus::cli {

struct Table1Options {
  std::vector<std::string> scenes, ops;
  std::string from, probe;   ///< results to print instead of measuring; a phase_probe to count cache lines with
  double budget = 0.03;
  bool as_json = false;
};
struct PeersOptions {
  std::vector<std::string> scenes;
  std::string from;          ///< results to print instead of measuring
  double budget = 0.02;
  bool as_json = false;
};
struct SimulationOptions {
  std::vector<std::string> scenes;
  std::string from;          ///< results to print instead of measuring
  double budget = 1;
  bool as_json = false;
};
struct SwimmersOptions {
  std::string from, pictures;   ///< results to print instead of measuring; a directory for the pictures
  double budget = 0.02, longest = 1, gigabytes = 1;
  std::int64_t largest = 100000;
  bool as_json = false;
};

struct LaddersOptions {
  std::vector<std::string> ladders, ops;   ///< empty: all
  std::string from, pictures;              ///< results to print instead of measuring; a directory for the pictures
  double operations = 5e8, gigabytes = 1;
  bool as_json = false;
};

struct SolversOptions {
  std::vector<std::string> solvers;      ///< empty: all
  std::string from, problems, pictures;  ///< results to print instead of measuring; a folder of problems besides; a directory for the pictures
  std::int64_t seeds = 2, iterations = 10000;
  bool as_json = false;
};
struct ChooseOptions {
  std::vector<std::string> scenes, ops;
  double budget = 0.02;
  bool calibrate = false;   ///< print the table of kernels instead
};

// They return the exit code.
[[nodiscard]] int run_table1(const Table1Options& o);
[[nodiscard]] int run_peers(const PeersOptions& o);
[[nodiscard]] int run_simulation(const SimulationOptions& o);
[[nodiscard]] int run_swimmers(const SwimmersOptions& o);
[[nodiscard]] int run_ladders(const LaddersOptions& o);
[[nodiscard]] int run_solvers(const SolversOptions& o);
[[nodiscard]] int run_choose(const ChooseOptions& o);
[[nodiscard]] int run_compare(const std::vector<std::string>& files, double slack, bool as_json);

}  // namespace delassus::cli
