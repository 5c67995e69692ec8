// Whether M is regular although some bodies are massless: the pivots of one articulated-inertia pass, in Quad.
#include "algorithms/regularity.h"

#include "algorithms/kinematics.h"
#include "algorithms/scalars.h"

namespace delassus {
namespace {

bool massless(const Body& body) { return body.mass == 0; }

bool has_armature(const Joint& joint) {
  if (joint.armature.empty()) return false;
  for (const double a : joint.armature)
    if (!(a > 0)) return false;
  return true;
}

/// Index of the first massless body (from the tips) whose joint has a pivot of D = Sᵀ I^A S + armature that is lost in
/// double precision, ground when there is none. A pivot is lost at 30 ε times its value before its joint's other
/// pivots and its children's joints were eliminated.
Index first_lost_pivot(const Model& model, const VectorX<Quad>& q) {
  const Problem<Quad> p = kinematics<Quad>(model, q);
  const Structure& s = *p.structure;
  std::vector<Matrix6<Quad>> articulated = p.H, children = p.H;  // the latter: before the children's joints give way
  const Quad lost = Quad(30) * Quad(unit_roundoff<double>);
  for (Index i = s.bodies() - 1; i >= 0; --i) {
    const Matrix6<Quad> before = articulated[i];
    for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) {
      const Vector6<Quad> u = articulated[i] * p.S[k];
      const Quad pivot = p.S[k].dot(u) + p.armature[k];
      const Quad whole = p.S[k].dot(Vector6<Quad>(children[i] * p.S[k])) + p.armature[k];
      if (massless(model.bodies[i]) && !(pivot > lost * whole)) return i;
      articulated[i] -= u * u.transpose() / pivot;
    }
    if (s.parent[i] == ground) continue;
    articulated[s.parent[i]] += articulated[i];
    children[s.parent[i]] += before;
  }
  return ground;
}

/// A fixed configuration away from the neutral one: every degree of freedom moved by 0.3 to 0.9, no two alike.
VectorX<double> perturbed(const Model& model) {
  VectorX<double> v(model.dofs());
  double fraction = 0;
  for (Index k = 0; k < v.size(); ++k) {
    fraction += 0.6180339887498949;
    if (fraction > 1) fraction -= 1;
    v[k] = 0.3 + 0.6 * fraction;
  }
  return integrate<double>(model, neutral(model), v);
}

}  // namespace

void check_regular(const Model& model, const std::string& file) {
  std::vector<bool> tip(model.bodies.size(), true);
  for (const Body& body : model.bodies)
    if (body.parent != ground) tip[body.parent] = false;
  bool doubtful = false;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    if (!massless(body) || has_armature(body.joint)) continue;
    if (tip[i])
      throw ModelError(file, body.name, "massless tip without armature",
                       "mass above 0 kg, or armature above 0 on every degree of freedom of its joint");
    doubtful = true;
  }
  if (!doubtful) return;
  // A pivot is an analytic function of q: regular at one configuration, it is regular in general position.
  Model tree = model;
  tree.constraints.clear();
  const Index lost = first_lost_pivot(tree, neutral(tree).cast<Quad>());
  if (lost == ground || first_lost_pivot(tree, perturbed(tree).cast<Quad>()) == ground) return;
  throw ModelError(file, model.bodies[lost].name, "massless body whose joint moves no inertia of its descendants",
                   "massive descendants that its joint moves, or armature above 0 on every degree of freedom");
}

}  // namespace delassus
