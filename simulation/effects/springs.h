// Springs and dampers on single degrees of freedom, implicit in h: springs of the scene, viscous damping of joints.
//
//   M (ν⁺ − ν) = h (τ − k (q + h ν⁺ − q₀) − d ν⁺)   ⇒   M̂ = M + h d + h² k,   force −k (q − q₀) − h k ν − d ν
// so that no stiffness and no damping makes a step unstable.
// Cost    3 operations in M̂, 7 in the force, per spring. Energy: a spring conserves (implicit: loses of order h), a damper dissipates.
#pragma once

#include "models/scene.h"
#include "simulation/terms.h"

namespace delassus::simulation {

/// Springs of the scene with a stiffness or a damping.
[[nodiscard]] bool acts(const SceneMotion::Spring& s);

template <class T> class Springs final : public Effect, public InertiaTerm<T>, public ForceTerm<T> {
 public:
  Springs(const Model& model, const std::vector<SceneMotion::Spring>& springs);
  void add_inertia(Moment<T>& now) override;
  void add_force(Moment<T>& now) override;
  [[nodiscard]] Index bytes() const override { return static_cast<Index>(sizeof(*this) + springs_.size() * sizeof(Spring)); }

 private:
  struct Spring {
    Index dof, q;
    T stiffness, rest, damping;
  };
  std::vector<Spring> springs_;
};

/// Viscous damping of the robots' files.
template <class T> class JointDamping final : public Effect, public InertiaTerm<T>, public ForceTerm<T> {
 public:
  explicit JointDamping(const Model& model);
  void add_inertia(Moment<T>& now) override;
  void add_force(Moment<T>& now) override;
  [[nodiscard]] Index bytes() const override { return static_cast<Index>(sizeof(*this) + damped_.size() * sizeof(Damped)); }

 private:
  struct Damped {
    Index dof;
    T damping;
  };
  std::vector<Damped> damped_;
};

}  // namespace delassus::simulation
