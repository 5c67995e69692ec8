// The libraries that read robots print through globals; whoever listens holds this meanwhile.
#pragma once

#include <mutex>

namespace delassus {

[[nodiscard]] inline std::mutex& library_console() {
  static std::mutex one_at_a_time;
  return one_at_a_time;
}

}  // namespace delassus
