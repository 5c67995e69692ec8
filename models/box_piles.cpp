#include "models/box_piles.h"

#include <cmath>

namespace delassus {
namespace {

constexpr double edge = 0.2, fall = 0.002;  // [m]

Scene pile(const std::string& name, Index boxes, Index courses, double damping, Vector3<double> (*foot)(Index column, Index course, Index columns)) {
  Scene s;
  s.name = name + ":" + std::to_string(boxes);
  if (boxes < 1) throw ModelError("", "scene " + s.name, "has no boxes", "N >= 1; " + name + ":10 has ten boxes");
  s.note = "Boxes that settle; their number is the size.";
  s.has_gravity = true, s.gravity = {0, 0, -9.81};
  s.has_ground = true, s.ground_friction = 0.5;
  s.motion.detects = true, s.motion.search.ground = true, s.motion.contact_damping = damping;
  s.q.resize(7 * boxes);
  s.model.bodies.reserve(static_cast<std::size_t>(boxes));
  for (Index i = 0; i < boxes; ++i) {
    Body b;
    b.name = "box_" + std::to_string(i);
    b.joint.name = b.name + "/base";
    b.joint.type = JointType::floating;
    b.mass = 1;
    b.inertia.diagonal().setConstant(edge * edge / 6);
    b.shapes.push_back({Shape::Kind::box, Vector3<double>::Constant(edge / 2), {}, -1, {}});
    s.frames.emplace(b.name, Frame{s.model.add(std::move(b)), {}});
    s.motion.search.object.push_back(i);
    const Index column = i / courses, course = i % courses;
    Vector3<double> at = foot(column, course, (boxes + courses - 1) / courses);
    at[2] = edge * (static_cast<double>(course) + 0.5) + fall * static_cast<double>(course + 1);
    s.q.segment<7>(7 * i) << at, 1, 0, 0, 0;
  }
  s.assembly.q = s.q;
  s.damping = Damping<double>::uniform(0, 0);
  return s;
}

}  // namespace

Scene stacks(Index boxes) {
  return pile("stacks", boxes, 5, 1e-4, [](Index column, Index, Index columns) {
    const auto side = static_cast<Index>(std::ceil(std::sqrt(static_cast<double>(columns))));
    return Vector3<double>(0.5 * static_cast<double>(column % side), 0.5 * static_cast<double>(column / side), 0);
  });
}

Scene wall(Index boxes) {
  return pile("wall", boxes, 10, 1e-2, [](Index column, Index course, Index) { return Vector3<double>(1.1 * edge * (static_cast<double>(column) + 0.5 * static_cast<double>(course % 2)), 0, 0); });
}

}  // namespace delassus
