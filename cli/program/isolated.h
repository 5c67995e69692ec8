// Work in a child process with a time limit, so that a crash or a hang is a finding and not the end of the run.
#pragma once

#include <functional>
#include <string>

namespace delassus {

struct Outcome {
  enum class End : std::uint8_t { returned, crashed, timed_out } end = End::returned;
  int signal = 0;       ///< that ended it; 0: it exited by itself, though not as agreed
  std::string result;   ///< what the work returned, or had handed over through `progress` before its end
  std::string said;     ///< the last it wrote to standard output and error, at most 4 kB
};

/// What the work calls to hand over a part of its result early (what comes before a crash is then known).
using Progress = std::function<void(const std::string&)>;

/// Runs `work` in a child. An exception of the work counts as a crash, its text is in `said`.
/// @throws std::runtime_error when no process can be had. The child inherits signals: Ctrl-C ends it too.
[[nodiscard]] Outcome isolated(const std::function<std::string(const Progress&)>& work, double seconds);

/// "returned", "signal 11 (Segmentation fault)", "no answer within the time limit".
[[nodiscard]] std::string describe(const Outcome& outcome);

}  // namespace delassus
