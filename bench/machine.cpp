#include "bench/machine.h"

#include <sys/resource.h>
#include <sys/utsname.h>

#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "bench/text.h"
#include "delassus_revision.h"  // written by the build: DELASSUS_REVISION, DELASSUS_FLAGS

namespace delassus::bench {

namespace {

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

std::string operating_system() {
  std::string distribution;
  std::ifstream file("/etc/os-release");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("PRETTY_NAME=\"", 0) == 0) distribution = line.substr(13, line.size() - 14);
  utsname u{};
  uname(&u);
  return distribution.empty() ? std::string(u.sysname) : distribution;
}

std::string compiler() {
#if defined(__clang__)
  return "clang " + std::to_string(__clang_major__) + "." + std::to_string(__clang_minor__);
#else
  return "g++ " + std::to_string(__GNUC__) + "." + std::to_string(__GNUC_MINOR__);
#endif
}

std::string now() {
  const std::time_t t = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&t, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &utc);
  return text;
}

}  // namespace

Machine this_machine() {
  return {processor(), operating_system(), compiler(), DELASSUS_FLAGS, DELASSUS_REVISION, now(),
          static_cast<int>(std::thread::hardware_concurrency())};
}

std::int64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024 * static_cast<std::int64_t>(usage.ru_maxrss);
}

void to_json(nlohmann::json& j, const Machine& m) {
  j = {{"processor", m.processor}, {"cores", m.cores}, {"system", m.system}, {"compiler", m.compiler}, {"flags", m.flags}, {"revision", m.revision}, {"date", m.date}};
}

void from_json(const nlohmann::json& j, Machine& m) {
  m = {j.at("processor"), j.at("system"), j.at("compiler"), j.at("flags"), j.at("revision"), j.at("date"), j.at("cores")};
}

}  // namespace delassus::bench
