// A robot read from MJCF against MuJoCo's own numbers of the same file.
#pragma once

#include <algorithm>
#include <limits>

#include "models/mjcf.h"
#include "property_tests/unit/path_sums.h"
#include "reference/definition.h"
#include "reference/mjcf_witness.h"
#include "reference/mujoco_witness.h"

namespace delassus::unit {

struct MjcfRatios {
  double M = 0, J = 0;        ///< worst error / (eps · bound)
  Index dofs = 0, rows = 0;   ///< rows compared
  Index equalities = 0;
};

/// Largest |x − y| / (eps · bound); infinite when the sizes differ.
inline double worst_entry(const MatrixX<Quad>& x, const MatrixX<double>& y, const MatrixX<double>& bound) {
  if (x.rows() != y.rows() || x.cols() != y.cols()) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (Index j = 0; j < y.cols(); ++j)
    for (Index i = 0; i < y.rows(); ++i) largest = std::max(largest, ratio(static_cast<double>(Quad(x(i, j) - Quad(y(i, j)))), bound(i, j)));
  return largest;
}

/// Bodies of the model in the order of MuJoCo's joints: add_mjcf makes one per joint.
inline MjcfRatios compare_mjcf(const RobotOptions& options, const Model& model, const Robot& robot, unsigned seed) {
  const MjcfSource source = mjcf_source(options.file);
  reference::MjcfWitness witness(options.file, source.text, options.pose, source.full_inertia);
  MjcfRatios out;
  Random random(seed);
  VectorX<double> q = random_configuration(model, random);
  for (const Index j : witness.curved()) {
    const auto at = static_cast<std::size_t>(model.first_q[static_cast<std::size_t>(robot.bodies[static_cast<std::size_t>(j)])]);
    q[static_cast<Index>(at)] = witness.ref(j);
  }
  witness.set(model, robot.bodies, q);
  const Problem<double> problem = kinematics<double>(model, q);
  const reference::WitnessBounds bounds = reference::witness_bounds(model, q, problem);
  const Damping<double> none = Damping<double>::uniform(problem.structure->rows, 0);
  const reference::Dense<Quad> d = reference::dense(problem.cast<Quad>(), none.cast<Quad>());
  out.dofs = model.dofs();
  out.equalities = witness.equalities();
  out.M = worst_entry(d.M, witness.M(), bounds.M);
  Index row = 0;
  for (const Constraint& c : model.constraints) {
    const Index n = row_count(model, c);
    for (Index e = 0; e < witness.equalities(); ++e) {
      const std::string given = witness.name(e), number = " equality " + std::to_string(e);
      const bool mine = given.empty() ? c.name.size() > number.size() && c.name.substr(c.name.size() - number.size()) == number
                                      : c.name == options.robot + "/" + given;
      if (!mine) continue;
      out.J = std::max(out.J, worst_entry(d.J.middleRows(row, n), witness.rows(e), bounds.J.middleRows(row, n)));
      out.rows += n;
    }
    for (const MjcfSource::Sites& s : source.sites)
      if (c.name == options.robot + "/" + s.constraint) {
        out.J = std::max(out.J, worst_entry(d.J.middleRows(row, n), witness.site_rows(s.a, s.b, s.weld), bounds.J.middleRows(row, n)));
        out.rows += n;
      }
    row += n;
  }
  if (out.rows != row) out.J = std::numeric_limits<double>::infinity();
  return out;
}

}  // namespace delassus::unit
