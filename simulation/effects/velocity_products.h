// Velocity products: Coriolis, centrifugal and gyroscopic forces −c(q, ν).
//
// How     motion.h, without gravity. Floating joints are stepped with the velocity of their origin in axes that do not turn
//         (state.h), so their ω × v is not part of c here. Of a floating root v does not enter at all: forces do not know how fast a
//         tree travels, and no digit is lost by it. Of floating joints further out, −ω × v enters as an acceleration.
// Vanish  where it can be proved tree by tree: no joint turns · one floating or spherical body whose inertia is a multiple of 1 about
//         its centre of mass, the origin of its frame · one body that turns about or slides along one fixed axis.
// Cost    about 230 operations a body. Energy: neither; the exact ones do no work, explicit ones gain or lose of order h.
#pragma once

#include "algorithms/mechanism/motion.h"
#include "models/scene.h"
#include "simulation/effects.h"
#include "simulation/terms.h"

namespace delassus::simulation {

/// Whether the velocity products of a model may be other than zero, and the first tree where, or why not.
[[nodiscard]] Call has_velocity_products(const Scene& scene);

template <class T> class VelocityProducts final : public Effect, public ForceTerm<T> {
 public:
  VelocityProducts(const Model& model, const Mechanism<T>& mechanism);
  void add_force(Moment<T>& now) override;
  [[nodiscard]] Index bytes() const override;

 private:
  Motion<T> motion_;
  Index bodies_;
  std::vector<Index> roots_, inner_;  // first degree of freedom of floating joints: of roots, of others
  VectorX<T> nu_, product_, c_;
};

}  // namespace delassus::simulation
