// Ctrl-C keeps what was computed: the first one asks the work to end, the second ends the program.
#pragma once

namespace delassus::cli {

/// From here on the first SIGINT only makes interrupted() true.
void keep_on_interrupt();
[[nodiscard]] bool interrupted();

/// `code` when something is broken, otherwise 130 after an interruption, said on standard error with what it `left_out`.
[[nodiscard]] int end_of_run(int code, const char* left_out);

}  // namespace delassus::cli
