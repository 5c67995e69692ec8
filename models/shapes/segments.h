// Closest points of two segments: where round shapes and edges meet.
#pragma once

#include <utility>

#include "algorithms/kit/spatial.h"

namespace delassus {

/// (s, t) in [−1, 1]² with p + s u and q + t v closest to each other. Segments within 1e-9 rad of each other count as parallel: of their pairs
/// the one nearest the middle of the first. A segment of length 0 is a point. Error: rounding of their lengths and distance over the sine of the angle.
[[nodiscard]] std::pair<double, double> closest_on_segments(const Vector3<double>& p, const Vector3<double>& u, const Vector3<double>& q, const Vector3<double>& v);

}  // namespace delassus
