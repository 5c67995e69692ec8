#include "models/parts.h"

namespace delassus {

void sum_parts(const std::vector<Part>& parts, Body& body) {
  if (parts.size() == 1) {
    body.mass = parts[0].mass, body.com = parts[0].com;
    body.inertia = (parts[0].inertia + parts[0].inertia.transpose()) / 2;
    return;
  }
  for (const Part& p : parts) body.mass += p.mass, body.com += p.mass * p.com;
  if (body.mass == 0) body.com.setZero();
  else body.com /= body.mass;
  for (const Part& p : parts) {
    const Vector3<double> d = p.com - body.com;
    body.inertia += p.inertia + p.mass * (d.squaredNorm() * Matrix3<double>::Identity() - d * d.transpose());
  }
  body.inertia = (body.inertia + body.inertia.transpose()).eval() / 2;
}

}  // namespace delassus
