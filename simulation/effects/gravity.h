// Gravity: forces of a uniform field at the joints.
//
//   (moment; force)_i = Σ over the bodies from i outwards of (m c × g; m g),   τ_k = S_kᵀ of it
// How     m and m c stand in H, about the reference point of the tree: a robot far away loses no digit. Armature has no weight.
// Cost    6 additions and 12 products a body, 11 operations a degree of freedom. Energy: conserves, with −m gᵀx as potential.
#pragma once

#include "models/scene.h"
#include "simulation/terms.h"

namespace delassus::simulation {

[[nodiscard]] bool has_gravity(const Scene& scene);

template <class T> class Gravity final : public Effect, public ForceTerm<T> {
 public:
  Gravity(const Vector3<double>& g, Index bodies) : g_(g.cast<T>()), wrench_(static_cast<std::size_t>(bodies)) {}
  void add_force(Moment<T>& now) override;
  [[nodiscard]] Index bytes() const override { return static_cast<Index>(sizeof(*this) + wrench_.size() * sizeof(Vector6<T>)); }

 private:
  Vector3<T> g_;
  std::vector<Vector6<T>> wrench_;  // per body, about the reference point
};

}  // namespace delassus::simulation
