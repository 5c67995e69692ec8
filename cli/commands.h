// The subcommands of the program `delassus`. Each `add_…` declares its options on the given app and stores in `run`
// what to do when it was chosen; the value returned there is the exit code of the program.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace delassus::cli {

/// Exit codes of the program (main.cpp turns ModelError and wrong usage into bad_input).
enum Exit : int { good = 0, law_broken = 1, bad_input = 2, slower = 3 };

using Run = std::function<int()>;

void add_list(CLI::App& app, Run& run);
void add_describe(CLI::App& app, Run& run);
void add_check(CLI::App& app, Run& run);
void add_apply(CLI::App& app, Run& run);
void add_export(CLI::App& app, Run& run);
void add_accuracy(CLI::App& app, Run& run);
void add_bench(CLI::App& app, Run& run);
void add_report(CLI::App& app, Run& run);
void add_survey(CLI::App& app, Run& run);
void add_stress(CLI::App& app, Run& run);
void add_replay(CLI::App& app, Run& run);

}  // namespace delassus::cli
