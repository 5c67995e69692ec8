// Scratch files of the tests: a folder per process, since tests run side by side.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

namespace delassus::test {

/// A path of this name in the process's own folder, which goes when the process ends.
inline std::filesystem::path temporary(const std::string& name) {
  struct Folder {
    std::filesystem::path path = std::filesystem::temp_directory_path() / ("delassus-test-" + std::to_string(getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
  };
  static const Folder folder;
  return folder.path / name;
}

}  // namespace delassus::test
