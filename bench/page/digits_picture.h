// The mechanism of a scene with every link filled by the digits it keeps: light to dark and hatched, so that it reads
// without colour, and with the number beside it.
#pragma once

#include <string>
#include <vector>

#include "models/scene.h"

namespace delassus::bench {

/// One view of the scene: digits kept, one number per body.
struct DigitsPanel {
  std::string title;
  std::vector<double> digits;
};

/// An SVG picture that stands alone: the panels one below the other. Numbers beside the links for up to 40 bodies.
[[nodiscard]] std::string digits_picture(const Scene& scene, const std::vector<DigitsPanel>& panels, const std::string& title);

}  // namespace delassus::bench
