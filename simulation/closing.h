// Drift: what a step leaves open of the constraints that have a position, closed after it.
//
//   q ← q ⊕ d,   min ‖d‖_M̂  with  J d = −φ(q)
// How      chord steps with J and M̂ of the step that has just been taken: no new factor; φ falls from order h² by a factor of order h
//          each time. Ends at 1e-12 m and rad, when φ no longer halves, or after five. Velocities are not touched, so closing gives
//          no energy but that of the displacement d in the fields.
// Cost     a solve and the poses, twice as a rule.
#pragma once

#include "simulation/paths.h"

namespace delassus::simulation {

template <class T> class Closing final : public Effect, public EventTerm<T> {
 public:
  static constexpr double closed = 1e-12;  ///< [m, rad]

  Closing(const Model& model, Mechanism<T>& mechanism, EquationsPath<T>& path);
  void after(Moment<T>& now, State<T>& next) override;
  [[nodiscard]] Index bytes() const override;

  /// Largest |φ| at q; leaves φ in `gap`.
  T error(const VectorX<T>& q, VectorX<T>& gap);

 private:
  const Model* model_;
  Mechanism<T>* mechanism_;
  EquationsPath<T>* path_;
  Advance<T> advance_;
  Poses<T> poses_;
  VectorX<T> gap_, gap_then_, d_, q_;
};

}  // namespace delassus::simulation
