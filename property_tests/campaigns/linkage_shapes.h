// Linkages of known mobility, their joints placed in Quad: planar ones, and ones that move only by their proportions.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "algorithms/kit/spatial.h"
#include "algorithms/kit/test_scalars.h"
#include "generators/random.h"

namespace delassus::laws {

/// A revolute joint, or a prismatic one, between two links (ground: −1). World axes.
struct LinkageJoint {
  Index a, b;
  Vector3<Quad> axis, point;   ///< unit axis; a point on it [m]
  bool slides = false;
};

struct Linkage {
  Index links = 0, mobility = 0;
  std::vector<LinkageJoint> joints;   ///< the first `mobility` are the drivers, on the ground
};

struct LinkageShape {
  std::string_view name;
  Linkage (*at)(generators::Random&);   ///< at a random configuration
};

[[nodiscard]] const std::vector<LinkageShape>& linkage_shapes();

}  // namespace delassus::laws
