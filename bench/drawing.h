// A picture of a scene as SVG: collision primitives, links, joints, contact points and loop closures.
#pragma once

#include <string>

#include "models/scene.h"

namespace delassus::bench {

/// An SVG element for the page (classes styled by its CSS, no ids). Cost O(bodies + constraints); meant for scenes
/// of up to some thousand bodies.
[[nodiscard]] std::string draw(const Scene& scene);

/// The marks of `draw` with their meaning, as an HTML fragment.
[[nodiscard]] std::string drawing_legend();

}  // namespace delassus::bench
