#include "cli/interrupt.h"

#include <atomic>
#include <csignal>
#include <cstdio>

#include "cli/commands.h"

namespace delassus::cli {

namespace {

std::atomic<bool> stopped = false;

}  // namespace

void keep_on_interrupt() {
  std::signal(SIGINT, [](int) {
    stopped = true;
    std::signal(SIGINT, SIG_DFL);
  });
}

bool interrupted() { return stopped; }

int end_of_run(int code, const char* left_out) {
  if (!interrupted()) return code;
  std::fprintf(stderr, "interrupted: %s\n", left_out);
  return code == good ? stopped_early : code;
}

}  // namespace delassus::cli
