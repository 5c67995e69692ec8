// The subcommands of the program `delassus`. Each `add_…` declares its options on the given app and stores in `run`
// what to do when it was chosen; the value returned there is the exit code of the program.
#pragma once

#include <functional>

namespace delassus::options {
class Command;
}

namespace delassus::cli {

/// Exit codes of the program (main.cpp turns ModelError and wrong usage into bad_input).
enum Exit : int { good = 0, law_broken = 1, bad_input = 2, slower = 3, stopped_early = 130 };

using Run = std::function<int()>;

void add_list(options::Command& app, Run& run);
void add_describe(options::Command& app, Run& run);
void add_check(options::Command& app, Run& run);
void add_apply(options::Command& app, Run& run);
void add_dynamics(options::Command& app, Run& run);
void add_export(options::Command& app, Run& run);
void add_accuracy(options::Command& app, Run& run);
void add_bench(options::Command& app, Run& run);
void add_report(options::Command& app, Run& run);
void add_survey(options::Command& app, Run& run);
void add_simulate(options::Command& app, Run& run);
void add_stress(options::Command& app, Run& run);
void add_replay(options::Command& app, Run& run);

}  // namespace delassus::cli
