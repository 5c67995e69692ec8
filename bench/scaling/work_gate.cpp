// Gate on work: operations of the matrix-free operators grow with order 1.00 ± 0.01 on swimmers of 10 to 10⁵ links,
// by the counting scalar (no clock), and the operators at 10⁵ links stay below 1 GiB.
//
//   work_gate [OPERATOR LARGEST]     another operator, up to LARGEST links
//
// Exit code 0: so it is; 1: not.
#include <cstdio>
#include <cstdlib>

#include "bench/cell.h"
#include "bench/scaling/growth.h"
#include "bench/machine.h"
#include "models/swimmer.h"

namespace {

using namespace delassus;
using namespace delassus::bench;

constexpr double most_memory = 1024.0 * 1024.0 * 1024.0;

using Phase = std::int64_t Operations::*;

Operations operations_at(const OperatorRow& row, Index links) {
  const Scene scene = swimmer(links);
  return count_operations(row, problem_of(scene), scene.damping);
}

/// Orders of one phase over the ladder n, 2n, 4n, …; true when all are 1.00 ± 0.01. Only a new damping may be no work.
bool linear(const char* op, const char* phase, const std::vector<Operations>& all, const std::vector<Index>& n, Phase p) {
  std::vector<std::int64_t> f;
  for (const Operations& o : all) f.push_back(o.*p);
  if (p == &Operations::new_damping && no_work(f)) return true;
  const std::vector<double> order = orders(f);
  for (std::size_t i = 0; i < order.size(); ++i)
    if (const bool ok = is_linear(order[i]); !ok || i + 1 == order.size())
      std::printf("%-10s %-12s %7lld links %14lld operations  order %.4f  %s\n", op, phase, static_cast<long long>(n[i + 2]),
                  static_cast<long long>(f[i + 2]), order[i], ok ? "ok" : "TOO MUCH WORK");
  return grows_linearly(f);
}

/// smallest, 2 smallest, 4 smallest, … up to largest.
bool check_sizes(const char* name, Index smallest, Index largest) {
  const OperatorRow& row = find_operator(name);
  std::vector<Index> sizes;
  for (Index n = smallest; n <= largest; n *= 2) sizes.push_back(n);
  std::vector<Operations> f;
  for (const Index n : sizes) f.push_back(operations_at(row, n));
  bool good = linear(name, "update", f, sizes, &Operations::update);
  good = linear(name, "new damping", f, sizes, &Operations::new_damping) && good;
  if (row.applies) good = linear(name, "apply", f, sizes, &Operations::apply) && good;
  if (row.solves) good = linear(name, "solve", f, sizes, &Operations::solve) && good;
  return good;
}

/// One double-precision round at 10⁵ links; true when every report is ok.
bool largest_round(const char* name, Index largest) {
  const OperatorRow& row = find_operator(name);
  const Scene scene = swimmer(largest);
  const Cell cell = measure(row, problem_of(scene), scene.damping, {0, 0});
  std::printf("%-10s %lld links: update %.0f ms, operator %.0f MB, status %s %s\n", name, static_cast<long long>(largest),
              1e-3 * cell.time.update.lowest, 1e-6 * static_cast<double>(cell.bytes), cell.update_status.c_str(),
              cell.solve_status.c_str());
  return cell.update_status == "ok" && (cell.solve_status.empty() || cell.solve_status == "ok");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3) return check_sizes(argv[1], 10, std::atol(argv[2])) ? 0 : 1;
  constexpr Index largest = 100000;
  bool good = true;
  for (const char* op : {"aba_sweep", "lcaba"}) {
    good = check_sizes(op, 10, largest / 32) && good;       // 10 … 2560
    good = check_sizes(op, largest / 32, largest) && good;  // 3125 … 100000
    good = largest_round(op, largest) && good;
  }
  const double peak = static_cast<double>(peak_memory());
  const bool small = peak < most_memory;
  std::printf("peak memory %.0f MB of %.0f MB allowed  %s\n", 1e-6 * peak, 1e-6 * most_memory, small ? "ok" : "TOO MUCH MEMORY");
  return good && small ? 0 : 1;
}
