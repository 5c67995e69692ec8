#include "algorithms/kit/test_scalars.h"
#include "property_tests/campaigns/linkage_shapes.h"

#include <cmath>

namespace delassus::laws {
namespace {

using Q3 = Vector3<Quad>;
using generators::Random;

Quad between(Random& r, double low, double high) { return {low + (high - low) * static_cast<double>(r.integer(0, 1 << 20)) / (1 << 20)}; }

Q3 at(const Quad& x, const Quad& y, const Quad& z = 0) { return {x, y, z}; }
Quad length(const Q3& x) { return sqrt(x.dot(x)); }
const Q3 x_axis = at(1, 0), y_axis = at(0, 1), z_axis = at(0, 0, 1);

/// The point left of the line from a to b, at distances ra and rb. Planar.
Q3 meet(const Q3& a, const Q3& b, const Quad& ra, const Quad& rb) {
  const Q3 d = b - a;
  const Quad l = length(d), along = (l * l + ra * ra - rb * rb) / (l * Quad(2)), off = sqrt(ra * ra - along * along);
  return a + d * (along / l) + at(-d[1], d[0]) * (off / l);
}

LinkageJoint hinge(Index a, Index b, const Q3& point, const Q3& axis = z_axis) { return {a, b, axis, point}; }
Q3 crank_end(Random& r, double radius) {
  const Quad angle = between(r, -3, 3);
  return at(cos(angle), sin(angle)) * Quad(radius);
}

Linkage four_bar(Random& r) {
  const Q3 A = at(0, 0), B = crank_end(r, 0.3), D = at(1, 0), C = meet(B, D, 0.8, 0.6);
  return {3, 1, {hinge(-1, 0, A), hinge(0, 1, B), hinge(-1, 2, D), hinge(1, 2, C)}};
}

Linkage slider_crank(Random& r) {
  const Q3 A = at(0, 0), B = crank_end(r, 0.3), P = at(B[0] + sqrt(Quad(0.81) - B[1] * B[1]), 0);
  Linkage l{3, 1, {hinge(-1, 0, A), hinge(0, 1, B), hinge(1, 2, P), {-1, 2, x_axis, P, true}}};
  return l;
}

/// T. Jansen's leg with his eleven lengths.
Linkage jansen(Random& r) {
  const Q3 O = at(0, 0), A = crank_end(r, 0.15), G = at(-0.38, -0.078);
  const Q3 B = meet(G, A, 0.415, 0.5), D = meet(A, G, 0.619, 0.393), C = meet(G, B, 0.401, 0.558);
  const Q3 E = meet(D, C, 0.367, 0.394);
  return {7, 1, {hinge(-1, 0, O), hinge(0, 1, A), hinge(0, 2, A), hinge(1, 3, B), hinge(-1, 3, G), hinge(-1, 4, G),
                 hinge(3, 5, C), hinge(4, 2, D), hinge(4, 6, D), hinge(5, 6, E)}};
}

/// Lengths a b a b, twists α β α β with a sin β = b sin α; joint angles with tan θ₁/2 tan θ₂/2 = sin((β+α)/2) / sin((β−α)/2).
Linkage bennett(Random& r) {
  const Quad alpha = between(r, 0.3, 0.6), a(0.5), b(0.8), sb = sin(alpha) * b / a, cb = sqrt(Quad(1) - sb * sb);
  const Quad sa = sin(alpha), ca = cos(alpha);
  const auto half_sine = [](const Quad& c) { return sqrt((Quad(1) - c) / Quad(2)); };
  const Quad ratio = half_sine(cb * ca - sb * sa) / half_sine(cb * ca + sb * sa);
  const Quad t1 = between(r, 0.4, 2), t2 = ratio / t1;
  Linkage l{3, 1, {}};
  Q3 x = x_axis, z = z_axis, p = at(0, 0);
  for (Index k = 0; k < 4; ++k) {
    l.joints.push_back(hinge(k - 1, k == 3 ? -1 : k, p, z));
    const Quad t = (k % 2 == 0 ? t1 : t2) * Quad(k < 2 ? 1 : -1), c = (Quad(1) - t * t) / (Quad(1) + t * t), s = t * Quad(2) / (Quad(1) + t * t);
    const Q3 turned = x * c + Q3(z.cross(x)) * s;
    x = turned;
    p += x * (k % 2 == 0 ? a : b);
    z = Q3(z * (k % 2 == 0 ? ca : cb) + Q3(x.cross(z)) * (k % 2 == 0 ? sa : sb));
  }
  l.joints.back().a = 2;
  return l;
}

/// A plate at height h on two pairs of links, hinged along x and along y.
Linkage sarrus(Random& r) {
  const Quad h = between(r, 0.2, 0.7), out = sqrt(Quad(0.16) - h * h / Quad(4));
  return {5, 1, {hinge(-1, 0, at(0, 0.3, 0), x_axis), hinge(0, 1, at(0, Quad(0.3) + out, h / Quad(2)), x_axis), hinge(1, 2, at(0, 0.3, h), x_axis),
                 hinge(-1, 3, at(0.3, 0, 0), y_axis), hinge(3, 4, at(Quad(0.3) + out, 0, h / Quad(2)), y_axis), hinge(4, 2, at(0.3, 0, h), y_axis)}};
}

/// Three legs of two links under a platform in a plane.
Linkage planar_robot(Random& r) {
  const Q3 ground_at[3] = {at(0, 0), at(1, 0), at(0.5, 0.9)}, centre = at(between(r, 0.4, 0.6), between(r, 0.25, 0.35));
  Linkage l{7, 3, {}};
  const Quad turn = between(r, -0.5, 0.5);
  for (Index k = 0; k < 3; ++k) l.joints.push_back(hinge(-1, 2 * k, ground_at[k]));
  for (Index k = 0; k < 3; ++k) {
    const Quad angle = turn + Quad(2.0943951023931953) * Quad(static_cast<double>(k)) + Quad(3.6);
    const Q3 platform = centre + at(cos(angle), sin(angle)) * Quad(0.15);
    l.joints.push_back(hinge(2 * k, 2 * k + 1, meet(ground_at[k], platform, 0.4, 0.35)));
    l.joints.push_back(hinge(2 * k + 1, 6, platform));
  }
  return l;
}

}  // namespace

const std::vector<LinkageShape>& linkage_shapes() {
  static const std::vector<LinkageShape> table{{"four-bar", four_bar}, {"slider-crank", slider_crank}, {"Jansen", jansen},
                                               {"Bennett", bennett},   {"Sarrus", sarrus},             {"3-RRR", planar_robot}};
  return table;
}

}  // namespace delassus::laws
