// A robot that was loaded against a second reading of its file: by reference/urdf_witness.h, reference/sdf_witness.h, or, for
// MJCF, MuJoCo's own numbers (reference/mjcf_witness.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "algorithms/kit/test_scalars.h"
#include "models/robot.h"
#include "reference/witness_matrices.h"

namespace delassus {

class SecondReading {
 public:
  virtual ~SecondReading() = default;
  /// Appends to the model welds to the world at six of the robot's ends or fewer, so that J has rows; once, before `matrices`.
  /// @throws std::runtime_error naming a link that the model lacks.
  virtual void add_welds(Model& model, const Robot& robot) = 0;
  /// What the model must say at q. Entries of q may be changed first (curved couplings, which are taken at one place only).
  /// @throws std::runtime_error saying what the model and the file do not share.
  [[nodiscard]] virtual reference::WitnessMatrices matrices(const Model& model, const Robot& robot, VectorX<double>& q) const = 0;
  [[nodiscard]] virtual bool moves() const = 0;   ///< the file has a moving joint
  /// What the reading passed over though somebody may have meant it.
  [[nodiscard]] virtual std::vector<std::string> doubtful() const { return {}; }
};

/// By the file's root element. `options` are those that the robot is read with; `armature_of_all` and `base_given` count.
/// Null for MJCF in a build without MuJoCo. @throws std::runtime_error or ModelError saying what the second reading does not take.
[[nodiscard]] std::unique_ptr<SecondReading> second_reading(const RobotOptions& options);

/// Largest |x − y| / (eps · bound) of matrices of equal size; infinite otherwise. A zero bound demands equality.
[[nodiscard]] double worst_ratio(const MatrixX<Quad>& x, const MatrixX<Quad>& y, const MatrixX<Quad>& bound);

}  // namespace delassus
