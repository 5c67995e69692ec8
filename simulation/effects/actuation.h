// Motors: torques, and proportional-derivative control of single degrees of freedom.
//
//   τ = torque + k (target − q) − d ν, cut at ± effort
// How     k and d are implicit as those of springs (springs.h): a stiff controller is stable at every step. Where the control at the
//         start of the step would be cut, the motor gives ± effort and nothing is implicit. In stages of implicit methods: where it is cut
//         at the last iteration; on the way from one effort to the other an iteration is made with none, so that none goes in circles.
// Cost    about 10 operations a motor. Energy: injects.
#pragma once

#include "models/scene.h"
#include "simulation/terms.h"

namespace delassus::simulation {

[[nodiscard]] bool acts(const SceneMotion::Motor& m);

template <class T> class Motors final : public Effect, public InertiaTerm<T>, public ForceTerm<T> {
 public:
  Motors(const Model& model, const std::vector<SceneMotion::Motor>& motors);
  void add_inertia(Moment<T>& now) override;
  void add_force(Moment<T>& now) override;
  [[nodiscard]] Index bytes() const override { return static_cast<Index>(sizeof(*this) + motors_.size() * sizeof(Motor)); }

 private:
  struct Motor {
    Index dof, q;
    T torque, stiffness, damping, target, effort;
    T now;  // of this step, at its start
  };
  std::vector<Motor> motors_;
};

}  // namespace delassus::simulation
