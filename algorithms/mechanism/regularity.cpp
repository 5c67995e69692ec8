// Whether M is regular although some inertias are zero, semidefinite or indefinite: the pivots of articulated-inertia
// passes, in Quad.
#include "algorithms/mechanism/regularity.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Eigenvalues>

#include "algorithms/errors/message.h"
#include "algorithms/kit/quad.h"
#include "algorithms/mechanism/kinematics.h"

namespace delassus {
namespace {

/// What a body's own spatial inertia is.
enum class Kind : std::uint8_t { massless, semidefinite, indefinite, definite };

struct Own {
  Kind kind = Kind::definite;
  Vector3<double> moments = Vector3<double>::Zero();
};

/// By the principal moments about the centre of mass, to 30 ε · 3 of the largest.
Own own_inertia(const Body& body) {
  Own out;
  const double scale = body.inertia.cwiseAbs().maxCoeff();
  if (scale == 0) {
    out.kind = body.mass == 0 ? Kind::massless : Kind::semidefinite;
    return out;
  }
  out.moments = scale * Eigen::SelfAdjointEigenSolver<Matrix3<double>>(body.inertia / scale, Eigen::EigenvaluesOnly).eigenvalues();
  const double slack = 30 * unit_roundoff<double> * 3 * out.moments.cwiseAbs().maxCoeff();
  if (out.moments[0] < -slack) out.kind = Kind::indefinite;
  else if (body.mass == 0 || out.moments[0] <= slack) out.kind = Kind::semidefinite;
  return out;
}

bool has_armature(const Joint& joint) {
  if (joint.armature.empty()) return false;
  for (const double a : joint.armature)
    if (!(a > 0)) return false;
  return true;
}

/// The same model with every indefinite inertia replaced by its absolute value V |Λ| Vᵀ: what pivots are measured with.
Model with_sizes(Model model, const std::vector<Own>& own) {
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (own[i].kind != Kind::indefinite) continue;
    const Eigen::SelfAdjointEigenSolver<Matrix3<double>> s(model.bodies[i].inertia);
    model.bodies[i].inertia = s.eigenvectors() * s.eigenvalues().cwiseAbs().asDiagonal() * s.eigenvectors().transpose();
  }
  return model;
}

/// A pivot D = Sᵀ I^A S + armature that is not positive.
struct Lost {
  Index body, freedom;
  double pivot, whole;
  bool negative;
};

/// The first (from the tips) pivot at q that is lost in double precision, measured with its value before its joint's other
/// pivots and its children's joints were eliminated. Of definite bodies only pivots that are not positive are lost, unless
/// others are indefinite: `sizes` with absolute inertias is given then, and every pivot measured with its whole subtree.
std::optional<Lost> first_lost_pivot(const Model& model, const Model* sizes, const std::vector<Own>& own, const VectorX<double>& at) {
  const VectorX<Quad> q = at.cast<Quad>();
  const Problem<Quad> p = kinematics<Quad>(model, q);
  const Structure& s = *p.structure;
  std::vector<Matrix6<Quad>> articulated = p.H, children = sizes ? kinematics<Quad>(*sizes, q).H : p.H;  // the latter: before the children's joints give way
  const bool sound = sizes == nullptr;
  const Quad lost = Quad(30) * Quad(unit_roundoff<double>);
  for (Index i = s.bodies() - 1; i >= 0; --i) {
    const Matrix6<Quad> before = articulated[i];
    const Kind kind = own[static_cast<std::size_t>(i)].kind;
    for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) {
      const Vector6<Quad> u = articulated[i] * p.S[k];
      const Quad pivot = p.S[k].dot(u) + p.armature[k];
      const Quad whole = p.S[k].dot(Vector6<Quad>(children[i] * p.S[k])) + p.armature[k];
      // The rounding in double of the sums a pivot is made from: below it an operator loses the pivot, whatever its sign.
      const Quad rounding = lost * p.S[k].cwiseAbs().dot(Vector6<Quad>(children[i].cwiseAbs() * p.S[k].cwiseAbs()));
      const bool negative = pivot < -(lost * whole + rounding);
      if (negative || !(pivot > (sound && kind == Kind::definite ? Quad(0) : lost * whole + rounding)))
        return Lost{i, k - s.first_dof[i], static_cast<double>(pivot), static_cast<double>(whole), negative};
      articulated[i] -= u * u.transpose() / pivot;
    }
    if (s.parent[i] == ground) continue;
    articulated[s.parent[i]] += articulated[i];
    children[s.parent[i]] += sizes ? children[i] : before;
  }
  return std::nullopt;
}

/// Fixed configurations away from the neutral one: every degree of freedom moved by 0.3 to 0.9, no two alike; turn: −1, 1.
VectorX<double> perturbed(const Model& model, double turn) {
  VectorX<double> v(model.dofs());
  double fraction = 0;
  for (Index k = 0; k < v.size(); ++k) {
    fraction += 0.6180339887498949;
    if (fraction > 1) fraction -= 1;
    v[k] = turn * (0.3 + 0.6 * fraction);
  }
  return integrate<double>(model, neutral(model), v);
}

std::string described(const Own& own, const Body& body) {
  if (own.kind == Kind::massless) return "massless body";
  if (own.moments.isZero(0)) return "point mass of " + number_text(body.mass) + " kg";
  return "body of " + number_text(body.mass) + " kg with the principal moments (" + number_text(own.moments[0]) + " " + number_text(own.moments[1]) + " " +
         number_text(own.moments[2]) + ") kg m^2";
}

[[noreturn]] void refuse(const Model& model, const std::vector<Own>& own, const Lost& lost, const std::string& file) {
  const auto i = static_cast<std::size_t>(lost.body);
  const Body& body = model.bodies[i];
  const std::string joint = body.joint.name.empty() ? "" : " (joint " + body.joint.name + ")";
  const std::string pivot = "its pivot of M is " + number_text(lost.pivot) + " of " + number_text(lost.whole) + " kg m^2 or kg";
  const std::string accepted = "armature above 0 on every degree of freedom";
  std::size_t culprit = i;
  for (std::size_t k = model.bodies.size(); k-- > i;) {
    Index up = static_cast<Index>(k);
    while (up > lost.body) up = model.bodies[static_cast<std::size_t>(up)].parent;
    if (up == lost.body && own[k].kind == Kind::indefinite) culprit = k;
  }
  if (own[culprit].kind != Kind::indefinite)
    throw ModelError(file, body.name, described(own[i], body) + " whose joint" + joint + " moves no inertia of its descendants: M is singular, " + pivot,
                     "an inertia above 0 about every axis, massive descendants that its joint moves, or " + accepted + "; give the body an inertia, or the joint an armature");
  throw ModelError(file, model.bodies[culprit].name,
                   described(own[culprit], model.bodies[culprit]) + (lost.negative ? ": M is indefinite, at " : ": M is singular, at ") + body.name + joint + " " + pivot,
                   "principal moments of 0 or more, or " + accepted + "; check the signs of the products of inertia and the axes they are in");
}

/// What a number of M can come to: Σ m ℓ² + |I| over all bodies, ℓ the length of the path to the centre of mass.
void check_range(const Model& model, const std::string& file) {
  constexpr long double most = 1e300L;
  std::vector<long double> reach;
  long double sum = 0;
  for (const Body& body : model.bodies) {
    const auto norm = [](const Vector3<double>& x) { return std::hypot(static_cast<long double>(x[0]), static_cast<long double>(x[1]), static_cast<long double>(x[2])); };
    const bool root = body.parent == ground;  // the place of a tree in the world does not enter M
    reach.push_back(root ? 0 : reach[static_cast<std::size_t>(body.parent)] + norm(body.joint.placement.translation));
    const long double arm = reach.back() + norm(body.com);
    sum += static_cast<long double>(body.mass) * arm * arm + static_cast<long double>(body.inertia.cwiseAbs().maxCoeff());
    if (sum > most || reach.back() > most)
      throw ModelError(file, body.name,
                       "mass " + number_text(body.mass) + " kg at " + number_text(static_cast<double>(std::min(arm, most))) + " m, largest moment " +
                           number_text(body.inertia.cwiseAbs().maxCoeff()) + " kg m^2: M leaves the range of double",
                       "m l^2 and moments below 1e300 kg m^2; check the units of mass, inertia and origins");
  }
}

}  // namespace

void check_regular(const Model& model, const std::string& file) {
  check_range(model, file);
  std::vector<bool> tip(model.bodies.size(), true);
  for (const Body& body : model.bodies)
    if (body.parent != ground) tip[static_cast<std::size_t>(body.parent)] = false;
  std::vector<Own> own;
  bool doubtful = false, indefinite = false;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    own.push_back(own_inertia(body));
    indefinite = indefinite || own[i].kind == Kind::indefinite;
    if (own[i].kind == Kind::definite || (own[i].kind != Kind::indefinite && has_armature(body.joint))) continue;
    if (own[i].kind == Kind::massless && tip[i])
      throw ModelError(file, body.name, "massless tip without armature" + (body.joint.name.empty() ? "" : ", on joint " + body.joint.name),
                       "mass above 0 kg, or armature above 0 [kg m^2 or kg] on every degree of freedom of its joint; give one of them, or fix the joint");
    doubtful = true;
  }
  if (!doubtful) return;
  // Of positive semidefinite inertias a pivot is an analytic function of q: regular at one configuration, it is regular in
  // general position. Indefinite ones must leave every pivot positive wherever it is looked at.
  Model tree = model;
  tree.constraints.clear();
  const Model sizes = indefinite ? with_sizes(tree, own) : Model{};
  std::optional<Lost> first;
  bool regular = false;
  for (const double turn : {0.0, 1.0, -1.0, 2.0}) {
    const auto lost = first_lost_pivot(tree, indefinite ? &sizes : nullptr, own, turn == 0 ? neutral(tree) : perturbed(tree, turn));
    if (lost && lost->negative) refuse(model, own, *lost, file);
    regular = regular || !lost;
    if (lost && !first) first = lost;
    if (!indefinite && (regular || turn == 1)) break;
  }
  if (!regular) refuse(model, own, *first, file);
}

}  // namespace delassus
