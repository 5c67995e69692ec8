#include "algorithms/kit/test_scalars.h"
#include "property_tests/second_reading/second_reading.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "property_tests/second_reading/mjcf_reading.h"
#include "reference/sdf_witness.h"
#include "reference/urdf_witness.h"

namespace delassus {
namespace {

using reference::SdfWitness;
using reference::UrdfWitness;
using reference::WitnessMatrices;

/// At most six of a list, spread over it.
std::vector<Index> some(const std::vector<Index>& all) {
  constexpr std::size_t most = 6;
  if (all.size() <= most) return all;
  std::vector<Index> out;
  for (std::size_t k = 0; k < most; ++k) out.push_back(all[k * all.size() / most]);
  return out;
}

template <class Witness> void weld(const Witness& w, const std::vector<Index>& links, Model& model, const Robot& robot) {
  for (const Index i : links) {
    const std::string& name = w.links[static_cast<std::size_t>(i)].name;
    const auto it = robot.links.find(name);
    if (it == robot.links.end()) throw std::runtime_error("link " + name + " is not in the model");
    Constraint c;
    c.name = "second reading " + name;
    c.kind = Constraint::Kind::weld;
    c.a = it->second;
    model.constraints.push_back(std::move(c));
  }
}

class UrdfReading : public SecondReading {
 public:
  explicit UrdfReading(const RobotOptions& o) : w_(reference::read_urdf_witness(o.file)), welded_(some(w_.leaves())) {
    for (UrdfWitness::Joint& j : w_.joints)
      if (j.armature == 0 && o.armature_of_all >= 0) j.armature = o.armature_of_all;
  }
  void add_welds(Model& model, const Robot& robot) override { weld(w_, welded_, model, robot); }
  [[nodiscard]] WitnessMatrices matrices(const Model& model, const Robot& robot, VectorX<double>& q) const override {
    return reference::urdf_matrices(w_, model, robot.name, q, welded_);
  }
  [[nodiscard]] bool moves() const override { return w_.moving() > 0; }
  [[nodiscard]] std::vector<std::string> doubtful() const override { return w_.doubtful; }

 private:
  UrdfWitness w_;
  std::vector<Index> welded_;
};

class SdfReading : public SecondReading {
 public:
  explicit SdfReading(const RobotOptions& o)
      : w_(reference::read_sdf_witness(o.file)), welded_(some(w_.leaves())), armature_(o.armature_of_all), base_given_(o.base_given) {}
  void add_welds(Model& model, const Robot& robot) override { weld(w_, welded_, model, robot); }
  [[nodiscard]] WitnessMatrices matrices(const Model& model, const Robot& robot, VectorX<double>& q) const override {
    return reference::sdf_matrices(w_, model, robot.name, q, welded_, armature_, base_given_);
  }
  [[nodiscard]] bool moves() const override { return w_.moving() > 0; }
  [[nodiscard]] std::vector<std::string> doubtful() const override { return w_.doubtful; }

 private:
  SdfWitness w_;
  std::vector<Index> welded_;
  double armature_;
  bool base_given_;
};

}  // namespace

std::unique_ptr<SecondReading> second_reading(const RobotOptions& options) {
  tinyxml2::XMLDocument document;
  if (document.LoadFile(options.file.c_str()) != tinyxml2::XML_SUCCESS || document.RootElement() == nullptr) throw std::runtime_error("no XML");
  const std::string root = document.RootElement()->Name();
  if (root == "mujoco") return mjcf_reading(options);
  if (root == "sdf") return std::make_unique<SdfReading>(options);
  return std::make_unique<UrdfReading>(options);
}

double worst_ratio(const MatrixX<Quad>& x, const MatrixX<Quad>& y, const MatrixX<Quad>& bound) {
  if (x.rows() != y.rows() || x.cols() != y.cols()) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (Index j = 0; j < y.cols(); ++j)
    for (Index i = 0; i < y.rows(); ++i) {
      const Quad error = abs(Quad(x(i, j) - y(i, j)));
      if (error == Quad(0)) continue;
      const Quad underflow(bound(i, j) == Quad(0) ? 0.0 : std::numeric_limits<double>::min());
      const double r = static_cast<double>(error / (Quad(unit_roundoff<double>) * (bound(i, j) + underflow)));
      largest = std::max(largest, std::isnan(r) ? std::numeric_limits<double>::infinity() : r);
    }
  return largest;
}

}  // namespace delassus
