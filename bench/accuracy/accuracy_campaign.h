// Every scene and every family measured: what the picture of accuracy against time is made of.
#pragma once

#include "bench/accuracy/accuracy.h"

namespace delassus::accuracy {

struct Campaign {
  std::vector<Table> here;       ///< scenes where their files put them, timed
  std::vector<Table> away;       ///< scenes 1000 km away, not timed
  std::vector<Table> families;   ///< middle sizes at their own damping, not timed
  std::vector<std::string> left_out;   ///< `name: why`
};

struct CampaignOptions {
  std::vector<std::string> scenes;   ///< empty: every scene that comes with the library
  std::vector<Rung> rungs;
  Options timed;                     ///< of `here`; `away` is measured at its dampings up to 1e-2
  bool with_away = true;
  double seconds = 1200;             ///< what has not begun by then is left out
  bool with_families = true;
};

/// `progress` is called with a line of text per table. @throws ModelError for an unknown scene.
[[nodiscard]] Campaign run_campaign(const CampaignOptions& options, const std::function<void(const std::string&)>& progress);

}  // namespace delassus::accuracy
