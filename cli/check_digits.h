// `delassus check --digits`: how many digits each link costs.
#pragma once

#include <optional>
#include <string>

#include "models/scene.h"

namespace delassus::cli {

struct DigitsOptions {
  std::string scene, family;        ///< one of them
  Index n = 0;                      ///< size of the family's problem; 0: its middle size
  std::uint64_t seed = 1;           ///< of the roundings and of x
  std::optional<double> damping;    ///< [1/kg]; without: the problem's own
  std::string op;                   ///< aba_sweep or lcaba
  std::string picture;              ///< file to write; empty: none
  bool as_json = false;
  SceneOptions opening;             ///< how the scene is opened
};

/// Prints the digits; returns the exit code. @throws ModelError for what cannot be opened, measured or written.
int check_digits(const DigitsOptions& options);

}  // namespace delassus::cli
