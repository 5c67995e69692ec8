#include "bench/peers/beside.h"

#include <cmath>
#include <cstdlib>

#include "algorithms/delassus.h"
#include "bench/json.h"
#include "bench/machine.h"

namespace delassus::bench {
namespace {

double load_now() {
  double now[1];
  return getloadavg(now, 1) == 1 ? now[0] : NAN;
}

}  // namespace

void Beside::begin(double seconds) {
  machine = this_machine();
  kernels = std::string(delassus::kernels());
  budget = seconds, load = load_now();
}

void Beside::end() { load_after = load_now(); }

std::string Beside::text() const {
  const Machine& m = machine;
  return m.processor + ", " + m.system + "; " + m.compiler + " " + m.flags + "; our kernels: " + kernels + "; revision " + m.revision + ", " + m.date +
         format("; load average %.1f at the start, %.1f at the end, on %d cores.\n", load, load_after, m.cores);
}

void write(nlohmann::json& j, const Beside& b) {
  j["machine"] = b.machine;
  j["machine"]["kernels"] = b.kernels, j["machine"]["load"] = {number(b.load), number(b.load_after)};
  j["budget_seconds"] = b.budget, j["interrupted"] = b.interrupted;
}

void read(const nlohmann::json& j, Beside& b) {
  const nlohmann::json& m = j.at("machine");
  b.machine = m;
  b.kernels = m.at("kernels");
  b.load = number_of(m.at("load").at(0)), b.load_after = number_of(m.at("load").at(1));
  b.budget = j.at("budget_seconds");
  b.interrupted = j.at("interrupted");
}

}  // namespace delassus::bench
