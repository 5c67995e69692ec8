#include <ode/ode.h>

#include "property_tests/unit/shapes/collision_witness.h"

namespace delassus {
namespace {

using V3 = Vector3<double>;

dGeomID made(const Shape& s) {
  switch (s.kind) {
    case Shape::Kind::sphere: return dCreateSphere(nullptr, s.size[0]);
    case Shape::Kind::box: return dCreateBox(nullptr, 2 * s.size[0], 2 * s.size[1], 2 * s.size[2]);
    case Shape::Kind::capsule: return dCreateCapsule(nullptr, s.size[0], 2 * s.size[1]);
    case Shape::Kind::cylinder: return dCreateCylinder(nullptr, s.size[0], 2 * s.size[1]);
    case Shape::Kind::hull: break;
  }
  return nullptr;
}

/// A geometry at its place, destroyed in the end.
class Geometry {
 public:
  explicit Geometry(const Shape& s) : id_(made(s)) {
    const Matrix3<double>& R = s.placement.rotation;
    const V3& x = s.placement.translation;
    const dMatrix3 turn = {R(0, 0), R(0, 1), R(0, 2), 0, R(1, 0), R(1, 1), R(1, 2), 0, R(2, 0), R(2, 1), R(2, 2), 0};
    dGeomSetPosition(id_, x[0], x[1], x[2]);
    dGeomSetRotation(id_, turn);
  }
  ~Geometry() { dGeomDestroy(id_); }
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;
  [[nodiscard]] dGeomID id() const { return id_; }

 private:
  dGeomID id_;
};

}  // namespace

bool ode_takes(Shape::Kind a, Shape::Kind b) { return a != Shape::Kind::hull && b != Shape::Kind::hull; }

WitnessContact ode_contact(const Shape& a, const Shape& b) {
  static const bool begun = dInitODE2(0) != 0;
  static_cast<void>(begun);
  const Geometry x(a), y(b);
  dContactGeom found[16];
  const int n = dCollide(x.id(), y.id(), 16, found, sizeof(dContactGeom));
  WitnessContact out;
  for (int k = 0; k < n; ++k)
    if (!out.found || found[k].depth > out.depth) out = {true, {found[k].normal[0], found[k].normal[1], found[k].normal[2]}, found[k].depth};
  return out;
}

}  // namespace delassus
