// settling [--markdown]: what a step of boxes that settle costs per contact, from 10² to 10⁴ of them.
#include <sys/resource.h>

#include <cstdio>
#include <cstring>

#include "property_tests/campaigns/settling.h"

namespace delassus::laws {
std::int64_t (*allocation_count)() = nullptr;
}

int main(int argc, char** argv) {
  using namespace delassus;
  if (argc > 2 || (argc == 2 && std::strcmp(argv[1], "--markdown") != 0)) {
    std::printf("settling [--markdown]\nTimes steps of the scenes stacks:N and wall:N, N = 100, 1000, 10000: stacks until they stand, walls while they land. Minutes; --help prints this.\nExit code 1 when a step does not end well.\n");
    return argc == 2 && std::strcmp(argv[1], "--help") == 0 ? 0 : 2;
  }
  const auto clock = [] {
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + 1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
  };
  std::printf("| scene | contacts | islands | iterations of an island | processor time a step and contact |\n|---|---|---|---|---|\n");
  for (const bool stacked : {true, false})
    for (const Index boxes : {100, 1000, 10000}) {
      const Scene scene = stacked ? stacks(boxes) : wall(boxes);
      const int steps = stacked ? 100 : 40;
      const Settling s = settle(scene, steps, stacked ? 1e-10 : 1e-8, clock);
      if (!s.wrong.empty()) {
        std::fprintf(stderr, "settling: %s: %s\n", scene.name.c_str(), s.wrong.c_str());
        return 1;
      }
      std::printf("| `%s` | %lld | %lld | %.1f | %.1f µs |\n", scene.name.c_str(), static_cast<long long>(s.last_contacts), static_cast<long long>(s.islands),
                  s.iterations_at_end, 1e6 * s.seconds / static_cast<double>(s.contacts));
      std::fflush(stdout);
    }
}
