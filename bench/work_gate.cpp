// Gate on work: operations of the matrix-free operators grow with order 1.00 ± 0.01 on swimmers of 10 to 10⁵ links,
// by the counting scalar (no clock), and the operators at 10⁵ links stay below 1 GiB.
//
// order = log2((f(4n) − f(2n)) / (f(2n) − f(n))): constants cancel, so it is exact already at small n.
#include <cmath>
#include <cstdio>

#include "bench/cell.h"
#include "bench/machine.h"
#include "models/swimmer.h"

namespace {

using namespace delassus;
using namespace delassus::bench;

constexpr Index largest = 100000;
constexpr double most_memory = 1024.0 * 1024.0 * 1024.0;

using Phase = std::int64_t Operations::*;

Operations operations_at(const OperatorRow& row, Index links) {
  const Scene scene = swimmer(links);
  return count_operations(row, problem_of(scene), scene.damping);
}

/// Orders of one phase over the ladder n, 2n, 4n, …; true when all are 1.00 ± 0.01.
bool linear(const char* op, const char* phase, const std::vector<Operations>& f, const std::vector<Index>& n, Phase p) {
  bool good = true;
  for (std::size_t i = 0; i + 2 < f.size(); ++i) {
    if (f[i + 2].*p == 0) continue;  // no work at all
    const double upper = static_cast<double>(f[i + 2].*p - f[i + 1].*p), lower = static_cast<double>(f[i + 1].*p - f[i].*p);
    const double order = std::log2(upper / lower);
    const bool ok = std::fabs(order - 1) <= 0.01;
    good = good && ok;
    if (!ok || i + 3 == f.size())
      std::printf("%-10s %-12s %7lld links %14lld operations  order %.4f  %s\n", op, phase, static_cast<long long>(n[i + 2]),
                  static_cast<long long>(f[i + 2].*p), order, ok ? "ok" : "TOO MUCH WORK");
  }
  return good;
}

bool check_operator(const char* name) {
  const OperatorRow& row = find_operator(name);
  bool good = true;
  for (const Index smallest : {Index(10), largest / 32}) {  // 10 … 2560, then 3125 … 100000
    std::vector<Index> sizes;
    for (Index n = smallest; n <= (smallest == 10 ? largest / 32 : largest); n *= 2) sizes.push_back(n);
    std::vector<Operations> f;
    for (const Index n : sizes) f.push_back(operations_at(row, n));
    good = linear(name, "update", f, sizes, &Operations::update) && good;
    good = linear(name, "new damping", f, sizes, &Operations::new_damping) && good;
    if (row.applies) good = linear(name, "apply", f, sizes, &Operations::apply) && good;
    if (row.solves) good = linear(name, "solve", f, sizes, &Operations::solve) && good;
  }
  return good;
}

/// One double-precision round at 10⁵ links; true when every report is ok.
bool largest_round(const char* name) {
  const OperatorRow& row = find_operator(name);
  const Scene scene = swimmer(largest);
  const Cell cell = measure(row, problem_of(scene), scene.damping, {0, 0});
  std::printf("%-10s %lld links: update %.0f ms, operator %.0f MB, status %s %s\n", name, static_cast<long long>(largest),
              1e-3 * cell.time.update.lowest, 1e-6 * static_cast<double>(cell.bytes), cell.update_status.c_str(),
              cell.solve_status.c_str());
  return cell.update_status == "ok" && (cell.solve_status.empty() || cell.solve_status == "ok");
}

}  // namespace

int main() {
  bool good = true;
  for (const char* op : {"aba_sweep", "lcaba"}) {
    good = check_operator(op) && good;
    good = largest_round(op) && good;
  }
  const double peak = static_cast<double>(peak_memory());
  const bool small = peak < most_memory;
  std::printf("peak memory %.0f MB of %.0f MB allowed  %s\n", 1e-6 * peak, 1e-6 * most_memory, small ? "ok" : "TOO MUCH MEMORY");
  return good && small ? 0 : 1;
}
