#include "models/swimmer.h"

#include <cmath>
#include <numbers>

namespace delassus {
namespace {

constexpr double length = 0.1;      // of a link [m]
constexpr double half_width = 0.01;  // of a link [m]

/// Link k: a bar from its joint along x, 1 kg, uniform.
Body bar(Index k) {
  Body b;
  b.name = "swimmer/link_" + std::to_string(k);
  b.parent = k - 1;
  b.joint.name = k == 0 ? "swimmer/base" : "swimmer/joint_" + std::to_string(k);
  b.joint.type = k == 0 ? JointType::planar : JointType::revolute;
  if (k > 0) b.joint.placement.translation[0] = length;
  b.mass = 1;
  b.com = {length / 2, 0, 0};
  const double w = 2 * half_width;
  b.inertia.diagonal() << (w * w + w * w) / 12, (length * length + w * w) / 12, (length * length + w * w) / 12;
  b.shapes.push_back({Shape::Kind::box, {length / 2, half_width, half_width}, {}, -1, {}});
  b.shapes[0].placement.translation = {length / 2, 0, half_width};
  return b;
}

Constraint contact(Index body, double x, const Pose<double>& link) {
  Constraint c;
  c.name = "contact swimmer/link_" + std::to_string(body) + " - ground";
  c.kind = Constraint::Kind::contact;
  c.a = {body, {link.rotation.transpose(), {x, 0, 0}}};
  c.b = {ground, link * c.a.placement};
  return c;
}

}  // namespace

Scene swimmer(Index links) {
  if (links < 1) throw ModelError("", "scene swimmer:" + std::to_string(links), "has no links", "N >= 1; swimmer:10 has ten links");
  Scene s;
  s.name = "swimmer:" + std::to_string(links);
  s.note = "Planar chain; the number of links is the size.";
  s.has_ground = true;
  // A closed ring would bend by 2π / N per joint; half of that is a half circle at every length.
  const double bend = std::numbers::pi / static_cast<double>(links);
  s.q = VectorX<double>::Constant(links + 2, bend);
  s.q.head<3>().setZero();
  s.model.bodies.reserve(static_cast<std::size_t>(links));
  s.model.constraints.reserve(static_cast<std::size_t>(2 * links));
  Pose<double> pose;
  for (Index k = 0; k < links; ++k) {
    const Index i = s.model.add(bar(k));
    const double angle = static_cast<double>(k) * bend;
    if (k > 0) pose.translation = pose * Vector3<double>(length, 0, 0);
    pose.rotation << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
    for (const double x : {0.25 * length, 0.75 * length}) s.model.constraints.push_back(contact(i, x, pose));
    s.frames.emplace(s.model.bodies.back().name, Frame{i, {}});
  }
  s.assembly.q = s.q;
  s.motion.nu = VectorX<double>::Zero(links + 2);  // a wave of two lengths along it
  for (Index k = 1; k < links; ++k) s.motion.nu[k + 2] = bend * std::cos(4 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(links));
  s.damping = Damping<double>::uniform(6 * links, 1e-4);
  return s;
}

}  // namespace delassus
