// Armature: inertia of rotors reflected to the joints, on the diagonal of M.
// Cost    an addition per degree of freedom that has one. Energy: conserves.
#pragma once

#include "simulation/terms.h"

namespace delassus::simulation {

template <class T> class Armature final : public Effect, public InertiaTerm<T> {
 public:
  explicit Armature(const Model& model);
  void add_inertia(Moment<T>& now) override;
  [[nodiscard]] Index bytes() const override { return static_cast<Index>(sizeof(*this) + rotors_.size() * sizeof(Rotor)); }

 private:
  struct Rotor {
    Index dof;
    T inertia;
  };
  std::vector<Rotor> rotors_;
};

}  // namespace delassus::simulation
