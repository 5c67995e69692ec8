// Mechanisms whose kinematics is rational: axes and placements along coordinate axes, dyadic numbers, quaternions and half tangents
// of small fractions. Every joint type and every kind of row, within a tree, between trees, to the world.
#pragma once

#include <array>

#include "algorithms/mechanism/motion.h"
#include "property_tests/unit/mechanism/jet.h"
#include "property_tests/unit/operators/path_sums.h"

namespace delassus::unit {

class Eighths {
 public:
  explicit Eighths(unsigned seed) : engine_(seed) {}
  double number(int most = 16) { return static_cast<double>(integer(-most, most)) / 8; }
  double positive() { return static_cast<double>(integer(1, 16)) / 8; }
  int integer(int low, int high) { return low + static_cast<int>(engine_() % static_cast<unsigned>(high - low + 1)); }
  Vector3<double> vector() { return {number(), number(), number()}; }
  Vector3<double> axis(int& k) {
    k = integer(0, 2);
    return (integer(0, 1) ? 1.0 : -1.0) * Vector3<double>::Unit(k);
  }
  /// One of the 24 rotations of a cube.
  Matrix3<double> rotation() {
    int i = 0, j = 0;
    const Vector3<double> x = axis(i);
    Vector3<double> y = axis(j);
    while (j == i) y = axis(j);
    Matrix3<double> R;
    R << x, y, x.cross(y);
    return R;
  }
  Pose<double> pose() { return {rotation(), vector()}; }
  template <class T> VectorX<T> fractions(Index n) {
    VectorX<T> x(n);
    for (Index k = 0; k < n; ++k) x[k] = T(integer(-9, 9)) / T(integer(1, 7));
    return x;
  }

 private:
  std::mt19937 engine_;
};

inline Body rational_body(Eighths& dice, const std::string& name, Index parent, JointType type) {
  Body b;
  b.name = name;
  b.parent = parent;
  b.joint.type = type;
  b.joint.placement = dice.pose();
  int first = 0, second = 0;
  b.joint.axis = dice.axis(first);
  do b.joint.axis2 = dice.axis(second);
  while (second == first);
  b.mass = dice.positive();
  b.com = dice.vector();
  b.joint.armature.assign(static_cast<std::size_t>(dof_count(type)), dice.positive());
  const double x = dice.number(4), y = dice.number(4), z = dice.number(4);
  b.inertia << 4, x, y, x, 5, z, y, z, 6;
  return b;
}

/// Two trees with every joint type, one of them floating.
inline Model rational_robots(Eighths& dice) {
  Model m;
  for (int robot = 0; robot < 2; ++robot)
    for (Index k = 0; k < 8; ++k) {
      const Index base = robot * 8, parent = k == 0 ? ground : k == 5 ? base + 1 : base + k - 1;
      m.add(rational_body(dice, std::string(robot ? "b/" : "a/") + std::to_string(k), parent, every_joint[(robot ? k + 1 : k) % 7]));
    }
  return m;
}

inline constexpr Constraint::Kind between_frames[] = {
    Constraint::Kind::point,     Constraint::Kind::weld,   Constraint::Kind::hinge,   Constraint::Kind::universal, Constraint::Kind::cylindrical,
    Constraint::Kind::prismatic, Constraint::Kind::planar, Constraint::Kind::contact, Constraint::Kind::distance};

/// Every kind but distance; `pose()` gives placements, `number()` coefficients.
template <class Dice> void add_rows(Model& m, Dice& dice, bool distances) {
  using Kind = Constraint::Kind;
  for (const Kind kind : between_frames) {
    if (kind == Kind::distance && !distances) continue;
    const std::array<Index, 2> ends[] = {{3, 7}, {4, 12}, {15, 2}, {6, ground}, {ground, 10}};
    for (const auto& [a, b] : ends) {
      Constraint c;
      c.kind = kind;
      c.length = 1;
      c.a = {a, dice.pose()};
      c.b = {b, dice.pose()};
      m.constraints.push_back(c);
    }
  }
  Constraint c;
  c.kind = Kind::general;
  for (const Index body : {2, 9, 2, 13}) c.terms.push_back({body, 0, 1, MatrixX<double>::NullaryExpr(2, 6, [&](Index, Index) { return dice.number(); })});
  m.constraints.push_back(c);
  c = {};
  c.kind = Kind::coupling;
  c.terms = {{4, 1, 2.0, {}}, {5, 0, -3.0, {}}, {3, 0, 0.5, {}}, {0, 4, 1.5, {}}};
  m.constraints.push_back(c);
  for (const Kind kind : {Kind::joint_lock, Kind::joint_friction, Kind::joint_limit}) {
    c = {};
    c.kind = kind;
    c.a.body = 4;
    m.constraints.push_back(c);
  }
}

template <class T, class X> VectorX<T> converted(const X& x) {
  VectorX<T> y(x.size());
  for (Index k = 0; k < y.size(); ++k) y[k] = scalar_cast<T>(x[k]);
  return y;
}

/// Value and rate of every entry.
template <class T, class X> MatrixX<T> value_of(const X& x) { return x.unaryExpr([](const Jet<T>& j) { return j.value; }); }
template <class T, class X> MatrixX<T> rate_of(const X& x) { return x.unaryExpr([](const Jet<T>& j) { return j.rate; }); }

/// What the jets say of a mechanism that moves through q with ν, by definition: nothing of motion.h is used.
template <class T> struct Differentiated {
  using J = Jet<T>;
  Problem<J> problem;
  Poses<J> poses;
  VectorX<T> nu;

  Differentiated(const Model& model, const VectorX<T>& q, const VectorX<T>& v) : problem(structure_of(model)), nu(v) {
    Mechanism<J> mechanism(model, problem.structure);
    mechanism.update(along<T>(model, q, v));
    mechanism.fill(problem);
    mechanism.poses(poses);
  }
  [[nodiscard]] MatrixX<T> rows() const { return rate_of<T>(constraint_jacobian(problem)) * nu; }
  [[nodiscard]] MatrixX<T> J_nu() const { return value_of<T>(constraint_jacobian(problem)) * nu; }
  [[nodiscard]] Vector3<T> reference_velocity(Index body) const {
    return rate_of<T>(poses.reference[poses.tree[body]]);
  }
  [[nodiscard]] Vector6<T> twist(Index body) const { return value_of<T>(body_jacobian(problem, body)) * nu; }
  /// J̇_i ν, the reference point held where it is.
  [[nodiscard]] Vector6<T> velocity_product(Index body) const {
    Vector6<T> a = rate_of<T>(body_jacobian(problem, body)) * nu;
    a.template tail<3>() -= Vector3<T>(twist(body).template head<3>()).cross(reference_velocity(body));
    return a;
  }
  /// Σ J_iᵀ d/dt (H_i J_i ν) about the point where the reference point is now.
  [[nodiscard]] VectorX<T> bias_forces() const {
    VectorX<T> c = VectorX<T>::Constant(nu.size(), T(0));
    for (Index i = 0; i < problem.structure->bodies(); ++i) {
      const MatrixX<J> Ji = body_jacobian(problem, i);
      VectorX<J> v = VectorX<J>::Constant(6, J(0));
      for (Index k = 0; k < nu.size(); ++k) v += Ji.col(k) * J(nu[k], T(0));
      const VectorX<J> momentum = problem.H[i] * v;
      VectorX<T> force = rate_of<T>(momentum);
      const Vector3<T> linear = value_of<T>(momentum).template bottomRows<3>();
      force.template head<3>() += reference_velocity(i).cross(linear);
      c += value_of<T>(Ji).transpose() * force;
    }
    return c;
  }
  /// νᵀṀν
  [[nodiscard]] T twice_power() const { return nu.dot(VectorX<T>(rate_of<T>(mass_matrix(problem)) * nu)); }
  /// Rate of the height of all masses in the direction −g times their weight: of the potential energy.
  [[nodiscard]] T potential_rate(const Model& model, const Vector3<T>& g) const {
    T rate(0);
    for (Index i = 0; i < problem.structure->bodies(); ++i) {
      const Vector3<J> com = poses.rotation[i] * Vector3<J>(model.bodies[i].com.cast<J>()) + poses.position[i] + poses.reference[poses.tree[i]];
      rate -= T(model.bodies[i].mass) * g.dot(Vector3<T>(rate_of<T>(com)));
    }
    return rate;
  }
};

}  // namespace delassus::unit
