// A page that plays a recording: one file, nothing else needed. Bodies by their shapes and as a skeleton, contact forces, energies,
// rows and residuals over time.
#pragma once

#include <string>
#include <vector>

#include "simulation/observe.h"
#include "simulation/step.h"

namespace delassus::cli {

/// A picture of a moment.
struct Frame3D {
  double time = 0;
  std::vector<double> poses;   ///< per body: position, quaternion w x y z
  std::vector<double> forces;  ///< per contact: point, force [N]
  double kinetic = 0, potential = 0, residual = 0, drift = 0;
  Index rows = 0;
  int iterations = 0;
};

[[nodiscard]] Frame3D frame_of(const Scene& scene, const simulation::Simulation<double>& s, const simulation::Observed<double>& o);
/// Writes the page. @throws ModelError when it cannot be written.
void write_page(const std::string& file, const Scene& scene, double step, const std::vector<Frame3D>& frames);

}  // namespace delassus::cli
