// What a run depends on, and nothing else: a run that begins at a saved state repeats every bit.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "algorithms/mechanism/model.h"

namespace delassus::simulation {

/// Which row it is from step to step: effect, body or joint, other body, feature.
using Identity = std::array<Index, 4>;

template <class T> struct State {
  /// Impulses of the rows of the last step, for a warm start.
  struct Impulse {
    Identity of;
    std::array<T, 3> value;
  };
  std::int64_t steps = 0;  ///< taken since time 0
  VectorX<T> q;            ///< configuration
  VectorX<T> nu;           ///< velocities at q, floating joints in body axes (docs/conventions.md)
  std::vector<Impulse> impulses;
  double trial = 0;        ///< the next step that error control tries [s]; 0 without it

  /// Of a tree, where sleeping is called for.
  struct Rest {
    std::int64_t quiet = 0;  ///< steps, as far as they count
    Index island = -1;       ///< it sleeps in; −1: awake
    bool known = false;      ///< its forces are in rest_force
  };
  std::vector<Rest> rest;
  VectorX<T> rest_force;  ///< n, of what sleeps [N m or N]
};

/// q ⊕ h ν⁺ and ν⁺ in the axes of the new configuration.
///   joints with coordinates   q + h ν
///   spherical                 quaternion · exp(h ω)
///   floating                  position + h R v, quaternion · exp(h ω); the velocity R v of the origin is kept in the axes of the
///                             joint while the body turns: a free body flies straight and R⁺ᵀ R v is its velocity in body axes
/// So ν holds for the start of the step when it goes in and for its end when it comes out.
template <class T> class Advance {
 public:
  explicit Advance(const Model& model);
  /// Of some bodies: displacements of their joints, one behind the other; q is that of the model.
  Advance(const Model& model, const std::vector<Index>& bodies);
  void operator()(const T& h, VectorX<T>& q, VectorX<T>& nu) const;
  /// q alone: a displacement d of the joints, d in the axes at q.
  void displace(const VectorX<T>& d, VectorX<T>& q) const;

 private:
  struct Joint {
    JointType type;
    Index q, dof, n;
  };
  std::vector<Joint> joints_;
};

}  // namespace delassus::simulation
