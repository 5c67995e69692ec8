// Programs that let a scene move, ours among them, and what each must tell of a step so that it can be judged (bench/simulation/step_residual.h).
// Those from outside: one source per program, compiled where it was found (CMakeLists.txt); none of their code is here.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "models/scene.h"

namespace delassus::bench {

/// A row, or some, that a program held in a step, as a constraint of ours between frames at the step's q; kinds point, contact, joint_limit
/// and joint_friction from outside, any from ours. Contacts: frame a's z is the normal from b to a.
struct HeldRows {
  Constraint constraint;
  VectorX<double> impulse;  ///< in our rows of it [N s, N m s]
  VectorX<double> R_inverse;  ///< that the scene gives them [1/kg]; empty: hard
  double gap = 0;           ///< of contacts and limits, at the start of the step [m or rad]
};

/// A contact at a point of the world; axes: two tangents, then the normal from `other` to `body`.
[[nodiscard]] Constraint contact_in_world(const Poses<double>& at, Index body, Index other, const Vector3<double>& point, const Matrix3<double>& axes, double friction);

/// M̂ (after − before) = pushed + Σ Jᵀ impulse, at q, by the program's own word.
struct Stepped {
  VectorX<double> q, before, after;  ///< configuration at the start; ν, both in the axes there
  VectorX<double> pushed;            ///< n: step times the forces that are no rows [N s, N m s]
  VectorX<double> added;             ///< n: to the diagonal of M: armature, what is implicit
  std::vector<HeldRows> rows;
  std::vector<Index> held;           ///< degrees of freedom that something else holds: their momentum is not told
};

/// One program on one scene.
class Simulator {
 public:
  virtual ~Simulator() = default;
  /// At the scene's q and ν again, as if nothing had run.
  virtual void reset() = 0;
  /// One step. False: it did not come to an end that it stands by; `why_not` has its words.
  virtual bool step() = 0;
  [[nodiscard]] virtual std::string why_not() const { return ""; }
  /// The last step. Not timed.
  [[nodiscard]] virtual Stepped last() const = 0;
  [[nodiscard]] virtual Index contacts() const = 0;   ///< points with rows in the last step
  [[nodiscard]] virtual Index row_count() const = 0;  ///< of the last step
  [[nodiscard]] virtual int iterations() const = 0;   ///< of the solver in the last step
  /// Compared before anything is timed; all in our q and ν. M without what is implicit.
  [[nodiscard]] virtual MatrixX<double> M(const VectorX<double>& q) = 0;
  /// ν̇ as if there were no rows.
  [[nodiscard]] virtual VectorX<double> free_acceleration(const VectorX<double>& q, const VectorX<double>& nu) = 0;
  /// What it adds to the diagonal of M to hold degrees of freedom without rows; empty: nothing. Such are not compared.
  [[nodiscard]] virtual VectorX<double> held() const { return {}; }
};

/// A program at one of its settings.
struct SimulatorRow {
  std::string name, program, what;  ///< of this row; the program with its version; its settings in a line
  /// @throws ModelError where it cannot express the scene, naming what.
  std::unique_ptr<Simulator> (*make)(const Scene& scene, double step);
};

/// Those compiled in.
[[nodiscard]] std::vector<SimulatorRow> simulators();
/// Those of one program; defined where it was found.
[[nodiscard]] std::vector<SimulatorRow> mujoco_simulators();

}  // namespace delassus::bench
