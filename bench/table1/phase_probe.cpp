// What cache_lines.h runs under valgrind: asks an operator on a scene once for each use, counted alone.
//   phase_probe SCENE OPERATOR/USE…       uses: first_apply, first_solve, apply, solve, new_damping, …  (uses.h)
// Prints the kernels and the compiler it was built with. Without valgrind it counts nothing.
#include <cstdio>
#include <cstring>

#include "bench/table1/uses.h"
#include "models/scene.h"

#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#else
#error "phase_probe needs valgrind/callgrind.h (Debian package valgrind)"
#endif

#ifdef __clang__
constexpr const char* compiler_name = "clang";
constexpr int compiler_major = __clang_major__, compiler_minor = __clang_minor__;
#else
constexpr const char* compiler_name = "g++";
constexpr int compiler_major = __GNUC__, compiler_minor = __GNUC_MINOR__;
#endif

int main(int argc, char** argv) {
  using namespace delassus;
  if (argc < 2) return std::fprintf(stderr, "usage: phase_probe SCENE OPERATOR/USE…\n"), 2;
  try {
    const Scene scene = open_scene(argv[1]);
    const Problem<double> problem = problem_of(scene);
    const MatrixX<double> x = bench::sample_vector(problem.structure->rows);
    std::printf("%s, %s %d.%d\n", std::string(kernels()).c_str(), compiler_name, compiler_major, compiler_minor);
    for (int k = 2; k < argc; ++k) {
      const char* const slash = std::strchr(argv[k], '/');
      if (slash == nullptr) throw std::runtime_error(std::string("no / in ") + argv[k]);
      bench::Asked asked(find_operator(std::string(argv[k], static_cast<std::size_t>(slash - argv[k]))), problem, scene.damping, x);
      std::size_t u = 0;
      while (u < bench::use_count && std::strcmp(bench::name(bench::use(u)), slash + 1) != 0) ++u;
      if (u == bench::use_count) throw std::runtime_error(std::string("no use ") + (slash + 1));
      if (!asked.why_not(bench::use(u)).empty()) throw std::runtime_error(argv[k] + (": " + asked.why_not(bench::use(u))));
      asked.ask(bench::use(u));  // whatever is made on first use exists
      CALLGRIND_START_INSTRUMENTATION;
      asked.ask(bench::use(u));
      CALLGRIND_DUMP_STATS_AT(argv[k]);
      CALLGRIND_STOP_INSTRUMENTATION;
    }
  } catch (const std::exception& e) {
    return std::fprintf(stderr, "phase_probe: %s\n", e.what()), 1;
  }
  return 0;
}
