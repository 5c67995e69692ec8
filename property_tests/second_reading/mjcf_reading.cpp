#include "algorithms/kit/test_scalars.h"
#include "property_tests/second_reading/mjcf_reading.h"

#include <stdexcept>

#include "algorithms/mechanism/kinematics.h"
#include "models/formats/mjcf.h"
#include "reference/mjcf_witness.h"
#include "reference/mujoco_witness.h"

namespace delassus {
namespace {

using reference::WitnessMatrices;

bool ends_with(const std::string& text, const std::string& end) { return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0; }

class MjcfReading : public SecondReading {
 public:
  explicit MjcfReading(const RobotOptions& o) : source_(mjcf_source(o.file)), witness_(o.file, source_.text, o.pose, source_.full_inertia) {}

  void add_welds(Model&, const Robot&) override {}
  [[nodiscard]] bool moves() const override { return witness_.joints() > 0; }

  [[nodiscard]] WitnessMatrices matrices(const Model& model, const Robot& robot, VectorX<double>& q) const override {
    if (static_cast<Index>(robot.bodies.size()) != witness_.joints())
      throw std::runtime_error(std::to_string(robot.bodies.size()) + " bodies in the model, " + std::to_string(witness_.joints()) + " joints in MuJoCo");
    for (const Index j : witness_.curved()) q[model.first_q[static_cast<std::size_t>(robot.bodies[static_cast<std::size_t>(j)])]] = witness_.ref(j);
    witness_.set(model, robot.bodies, q);
    VectorX<double> about = VectorX<double>::Zero(static_cast<Index>(model.bodies.size()));
    for (std::size_t j = 0; j < robot.bodies.size(); ++j) about[robot.bodies[j]] = witness_.about(static_cast<Index>(j));
    const reference::WitnessBounds bounds = reference::witness_bounds(model, q, kinematics<double>(model, q), about);
    WitnessMatrices out;
    out.M = witness_.M().cast<Quad>();
    for (Index k = 0; k < model.dofs(); ++k)
      if (out.M(k, k) == Quad(0)) throw std::runtime_error("freedom " + std::to_string(k) + " of the model is none of MuJoCo's");
    out.J = rows(model, robot).cast<Quad>();
    out.M_bound = bounds.M.cast<Quad>(), out.J_bound = bounds.J.cast<Quad>();
    reference::witness::couple(out);
    if (out.regular) out.A_bound = bounds.A.cast<Quad>();
    return out;
  }

 private:
  /// Rows of the constraints in the model's order.
  [[nodiscard]] MatrixX<double> rows(const Model& model, const Robot& robot) const {
    Index m = 0;
    for (const Constraint& c : model.constraints) m += row_count(model, c);
    MatrixX<double> J = MatrixX<double>::Zero(m, model.dofs());
    std::vector<char> used(static_cast<std::size_t>(witness_.equalities()));
    Index r = 0;
    for (const Constraint& c : model.constraints) {
      const Index n = row_count(model, c);
      const MatrixX<double> theirs = rows_of(c, robot, used);
      if (theirs.rows() != n) throw std::runtime_error("constraint " + c.name + " has " + std::to_string(n) + " rows, MuJoCo's equality " + std::to_string(theirs.rows()));
      J.middleRows(r, n) = theirs;
      r += n;
    }
    for (Index e = 0; e < witness_.equalities(); ++e)
      if (!used[static_cast<std::size_t>(e)] && witness_.rows(e).rows() > 0 && !told(e, robot)) throw std::runtime_error("equality " + label(e) + " is not in the model, and nothing says so");
    return J;
  }

  [[nodiscard]] std::string label(Index e) const { return witness_.name(e).empty() ? "equality " + std::to_string(e) : witness_.name(e); }

  [[nodiscard]] MatrixX<double> rows_of(const Constraint& c, const Robot& robot, std::vector<char>& used) const {
    for (Index e = 0; e < witness_.equalities(); ++e) {
      const std::string given = witness_.name(e);
      if (given.empty() ? !ends_with(c.name, " equality " + std::to_string(e)) : c.name != robot.name + "/" + given) continue;
      used[static_cast<std::size_t>(e)] = 1;
      return witness_.rows(e);
    }
    for (const MjcfSource::Sites& s : source_.sites)
      if (c.name == robot.name + "/" + s.constraint) return witness_.site_rows(s.a, s.b, s.weld);
    throw std::runtime_error("MuJoCo has no equality for the constraint " + c.name);
  }

  /// Whether a note or warning names the equality, or all are said to be switched off.
  [[nodiscard]] bool told(Index e, const Robot& robot) const {
    const std::string end = label(e) + "\"";
    const auto names = [&](const std::string& text) { return text.find(end) != std::string::npos || text.find("switches all equalities off") != std::string::npos; };
    for (const std::string& n : robot.notes) if (names(n)) return true;
    for (const Warning& w : robot.warnings) if (names(w.text)) return true;
    return false;
  }

  MjcfSource source_;
  mutable reference::MjcfWitness witness_;
};

}  // namespace

std::unique_ptr<SecondReading> mjcf_reading(const RobotOptions& options) { return std::make_unique<MjcfReading>(options); }

std::string mujoco_refuses(const std::string& file) {
  if (file.size() < 4 || file.compare(file.size() - 4, 4, ".xml") != 0) return {};
  try {
    reference::MjcfWitness(file, "", {}, {});
  } catch (const ModelError& e) {
    return e.what();
  }
  return {};
}

}  // namespace delassus
