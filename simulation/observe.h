// What is observed of a moving scene: energies and momenta, from poses and twists alone. Shares with the step the frames and twists of
// Mechanism and Motion, nothing else.
//
//   kinetic     ½ Σ (m |v_c|² + ωᵀ I ω) + ½ Σ armature ν²          [J]
//   potential   −Σ m gᵀ c + ½ Σ k (q − q₀)²                        [J], springs and gravity of the scene
//   linear      Σ m v_c [N s];   angular  Σ c × m v_c + I ω about the world's origin [N m s]; rotors of armature left out
// Cost     O(N), 200 operations a body.
#pragma once

#include "algorithms/mechanism/motion.h"
#include "models/scene.h"
#include "simulation/state.h"

namespace delassus::simulation {

template <class T> struct Observed {
  T kinetic{}, potential{};
  Vector3<T> linear, angular, centre;  ///< centre of mass [m]
  T mass{};
  [[nodiscard]] T energy() const { return kinetic + potential; }
};

template <class T> class Observer {
 public:
  explicit Observer(const Scene& scene);
  [[nodiscard]] Observed<T> operator()(const State<T>& state);

 private:
  const Scene* scene_;
  Mechanism<T> mechanism_;
  Motion<T> motion_;
  Poses<T> poses_;
  std::vector<Vector6<T>> twists_;
};

}  // namespace delassus::simulation
