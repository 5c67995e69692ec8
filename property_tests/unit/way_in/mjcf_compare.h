// A robot read from MJCF against MuJoCo's own numbers of the same file.
#pragma once

#include <algorithm>
#include <limits>

#include "algorithms/kit/test_scalars.h"
#include "models/formats/mjcf.h"
#include "property_tests/second_reading/mjcf_reading.h"
#include "property_tests/unit/operators/path_sums.h"
#include "reference/definition.h"
#include "reference/mujoco_witness.h"

namespace delassus::unit {

struct MjcfRatios {
  double M = 0, J = 0;        ///< worst error / (eps · bound)
  Index rows = 0;
};

/// Largest |x − y| / (eps · bound); infinite when the sizes differ.
inline double worst_entry(const MatrixX<Quad>& x, const MatrixX<double>& y, const MatrixX<double>& bound) {
  if (x.rows() != y.rows() || x.cols() != y.cols()) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (Index j = 0; j < y.cols(); ++j)
    for (Index i = 0; i < y.rows(); ++i) largest = std::max(largest, ratio(static_cast<double>(Quad(x(i, j) - Quad(y(i, j)))), bound(i, j)));
  return largest;
}

/// At a random configuration; J is infinite where an equality and a constraint have no counterpart.
inline MjcfRatios compare_mjcf(const RobotOptions& options, const Model& model, const Robot& robot, unsigned seed) {
  MjcfRatios out;
  Random random(seed);
  VectorX<double> q = random_configuration(model, random);
  try {
    const reference::WitnessMatrices theirs = mjcf_reading(options)->matrices(model, robot, q);
    const Problem<Quad> ours = kinematics<double>(model, q).cast<Quad>();
    out.M = worst_ratio(reference::mass_matrix(ours), theirs.M, theirs.M_bound);
    out.J = worst_ratio(reference::constraint_jacobian(ours), theirs.J, theirs.J_bound);
    out.rows = theirs.J.rows();
  } catch (const std::runtime_error&) {
    out.J = std::numeric_limits<double>::infinity();
  }
  return out;
}

}  // namespace delassus::unit
