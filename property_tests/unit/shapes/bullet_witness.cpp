#include <memory>

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>

#include "property_tests/unit/shapes/collision_witness.h"

namespace delassus {
namespace {

btVector3 bullet(const Vector3<double>& x) { return {x[0], x[1], x[2]}; }

std::unique_ptr<btConvexShape> made(const Shape& s) {
  std::unique_ptr<btConvexShape> out;
  switch (s.kind) {
    case Shape::Kind::sphere: return std::make_unique<btSphereShape>(s.size[0]);
    case Shape::Kind::capsule: return std::make_unique<btCapsuleShapeZ>(s.size[0], 2 * s.size[1]);
    case Shape::Kind::box: out = std::make_unique<btBoxShape>(bullet(s.size)); break;
    case Shape::Kind::cylinder: out = std::make_unique<btCylinderShapeZ>(btVector3(s.size[0], s.size[0], s.size[1])); break;
    case Shape::Kind::hull:
      auto hull = std::make_unique<btConvexHullShape>();
      for (const auto& x : *s.points) hull->addPoint(bullet(x));
      out = std::move(hull);
  }
  out->setMargin(0);
  return out;
}

btTransform placed(const Shape& s) {
  const Matrix3<double>& R = s.placement.rotation;
  return btTransform(btMatrix3x3(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)), bullet(s.placement.translation));
}

}  // namespace

WitnessContact bullet_contact(const Shape& a, const Shape& b) {
  const auto x = made(a), y = made(b);
  btGjkEpaSolver2::sResults r;
  const btTransform at_x = placed(a), at_y = placed(b);
  if (!btGjkEpaSolver2::Penetration(x.get(), at_x, y.get(), at_y, at_x.getOrigin() - at_y.getOrigin(), r, true)) return {};
  return {true, a.placement.rotation * Vector3<double>(r.normal.x(), r.normal.y(), r.normal.z()), std::abs(r.distance)};  // it says it in a's axes
}

}  // namespace delassus
