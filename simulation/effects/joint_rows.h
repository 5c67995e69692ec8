// Rows on joints that are no equations: limits and dry friction.
//
//   limits     side · ν ≥ −φ/h, φ how far the joint is from the limit; in the step where it is near (0.05 rad or m, and what two
//              steps bring); beyond it as contacts: min(β |φ|/h, 1 per s)
//   friction   |impulse| ≤ h · effort, ν = 0 within: the joint sticks
// The scene's joint_friction rows say the effort where they give one, else the robot's file.
// Cost       a row each. Energy: limits conserve (without bounce), friction dissipates.
#pragma once

#include "models/scene.h"
#include "simulation/terms.h"

namespace delassus::simulation {

inline constexpr double limit_reach = 0.05;  ///< [rad or m]

struct FrictionOfJoint {
  Index body, dof;
  double effort;  ///< [N m or N], > 0
};
[[nodiscard]] std::vector<FrictionOfJoint> joint_frictions(const Scene& scene);
[[nodiscard]] Index limit_count(const Scene& scene);  ///< finite limits of degrees of freedom with a coordinate

template <class T> class JointLimits final : public Effect, public RowsTerm<T> {
 public:
  explicit JointLimits(const Model& model);
  void add_rows(Moment<T>& now) override;
  [[nodiscard]] Index bytes() const override { return static_cast<Index>(sizeof(*this) + limits_.size() * sizeof(Limit)); }

 private:
  struct Limit {
    Index body, dof, at, q;
    int side;
    T value;
  };
  std::vector<Limit> limits_;
};

template <class T> class JointFriction final : public Effect, public RowsTerm<T> {
 public:
  explicit JointFriction(const Scene& scene) : joints_(joint_frictions(scene)) {}
  void add_rows(Moment<T>& now) override;
  [[nodiscard]] Index bytes() const override { return static_cast<Index>(sizeof(*this) + joints_.size() * sizeof(FrictionOfJoint)); }

 private:
  std::vector<FrictionOfJoint> joints_;
};

}  // namespace delassus::simulation
