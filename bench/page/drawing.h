// A picture of a scene as SVG: collision primitives, links, joints, contact points and loop closures.
#pragma once

#include <string>
#include <vector>

#include "models/scene.h"

namespace delassus::bench {

/// What a picture says of one body beyond its shape.
struct BodyMark {
  std::string style;  ///< a further class of its surfaces and its link
  std::string label;  ///< a few characters in a disc beside it; empty: none
};

/// What a picture carries beyond the scene.
struct Annotation {
  std::vector<BodyMark> bodies;  ///< one per body, or none
  std::string header;            ///< SVG (style, defs, title, legend), drawn at y from −header_height to 0
  double header_height = 0;      ///< [user units; the picture is `picture_width` wide]
};
inline constexpr double picture_width = 480;

/// An SVG element for the page (classes styled by its CSS, no ids), or with a header that brings the style a picture of
/// its own. Cost O(bodies + constraints + labels²); meant for scenes of up to some thousand bodies, some dozen labels.
[[nodiscard]] std::string draw(const Scene& scene, const Annotation& annotation = {});

/// The marks of `draw` with their meaning, as an HTML fragment.
[[nodiscard]] std::string drawing_legend();

}  // namespace delassus::bench
