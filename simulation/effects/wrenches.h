// Wrenches: forces and moments of constant direction in the world at points fixed on bodies.
//
//   τ_k += S_kᵀ (p × F + N; F)   for the joints on the way from the body to the root, p from the reference point of the tree
// Cost    11 operations per wrench and degree of freedom on the way. Energy: injects.
#pragma once

#include "models/scene.h"
#include "simulation/terms.h"

namespace delassus::simulation {

template <class T> class Wrenches final : public Effect, public ForceTerm<T> {
 public:
  explicit Wrenches(const std::vector<SceneMotion::Wrench>& wrenches);
  void add_force(Moment<T>& now) override;
  [[nodiscard]] Index bytes() const override { return static_cast<Index>(sizeof(*this) + acting_.size() * sizeof(Acting)); }

 private:
  struct Acting {
    Index body;
    Vector3<T> point, force, moment;  // point in the body's frame
  };
  std::vector<Acting> acting_;
};

}  // namespace delassus::simulation
