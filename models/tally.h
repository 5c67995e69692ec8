// Notes of one kind, told in one sentence however many elements they are about.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "models/robot.h"

namespace delassus {

class Tally {
 public:
  /// `what` is the same for all of a kind.
  void add(const std::string& what, const std::string& element) {
    for (auto& [known, elements] : kinds_)
      if (known == what) return elements.push_back(element);
    kinds_.push_back({what, {element}});
  }

  /// `file: what: a, b, c (17 in all)`, a note per kind in the order of their first element.
  void report(const std::string& file, Findings& findings) const {
    constexpr std::size_t listed = 5;
    for (const auto& [what, elements] : kinds_) {
      std::string text;
      for (std::size_t i = 0; i < elements.size() && i < listed; ++i) text += (i ? ", " : "") + elements[i];
      findings.note(file + ": " + what + ": " + text + (elements.size() > listed ? ", ... (" + std::to_string(elements.size()) + " in all)" : ""));
    }
  }

 private:
  std::vector<std::pair<std::string, std::vector<std::string>>> kinds_;
};

}  // namespace delassus
