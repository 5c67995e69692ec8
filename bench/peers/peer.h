// Implementations from outside that are timed beside ours, and what each must answer. One source per program, compiled where it was
// found (CMakeLists.txt); none of their code is here.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "models/scene.h"

namespace delassus::bench {

/// What is timed. Kinematics ends with everything that does not depend on R⁻¹ and is no factor: poses, joint axes, constraint rows.
enum class Step : std::uint8_t {
  kinematics,
  first_product,  ///< at a new q, after kinematics: what a product needs, and one
  product,        ///< one more
  first_solve,    ///< at a new q, after kinematics: what a damped solve needs, and one
  solve,          ///< one more
  new_damping,    ///< another R⁻¹ and one solve
};
inline constexpr std::size_t step_count = 6;
[[nodiscard]] inline Step step(std::size_t i) { return static_cast<Step>(i); }
[[nodiscard]] const char* name(Step s);

/// One peer on one scene at its q, with R⁻¹ and a vector x.
class Peer {
 public:
  virtual ~Peer() = default;
  /// Does it once. new_damping takes other_damping(R⁻¹) and R⁻¹ in turn; that one is in force until the next.
  virtual void take(Step step) = 0;
  /// A x or A⁻¹x as the last step left it, in our rows. Shape m.
  [[nodiscard]] virtual VectorX<double> answer() const = 0;
  /// The joint-space inertia in our ν, computed anew. n × n.
  [[nodiscard]] virtual MatrixX<double> M() = 0;
};

/// One way of a program to answer.
struct PeerRow {
  std::string name, program, what;  ///< of this row; the program with its version; a line on what it does
  std::string product, solve;       ///< our operators of the same algorithm; empty: it has no such answer
  bool from_q = false;              ///< its first_ steps begin at q: it has no kinematics of its own
  /// @throws ModelError where it cannot express the scene, naming what.
  std::unique_ptr<Peer> (*make)(const Scene& scene, const Damping<double>& damping, const VectorX<double>& x);
};

/// Those compiled in.
[[nodiscard]] std::vector<PeerRow> peers();
/// Those of one program; defined where it was found.
[[nodiscard]] std::vector<PeerRow> pinocchio_peers();
[[nodiscard]] std::vector<PeerRow> mujoco_peers();

}  // namespace delassus::bench
