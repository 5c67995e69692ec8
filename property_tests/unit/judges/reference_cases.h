// Random problems and the comparison that the tests of the references share.
#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <random>

#include "algorithms/kit/test_scalars.h"
#include "algorithms/problem/problem.h"

namespace delassus::reference::cases {

using Matrix = MatrixX<double>;
using Vector = VectorX<double>;

struct Case {
  Problem<double> problem;
  Damping<double> damping;
};

/// max_i |x_i − y_i| / (eps · bound_i); a zero bound demands equality.
inline double ratio(const VectorX<Quad>& x, const VectorX<Quad>& y, const Vector& bound, double eps) {
  double worst = 0;
  for (Index i = 0; i < x.size(); ++i) {
    const double error = static_cast<double>(abs(x[i] - y[i]));
    if (error == 0) continue;
    const double r = bound[i] > 0 ? error / (eps * bound[i]) : std::numeric_limits<double>::infinity();
    if (!(r <= worst)) worst = r;
  }
  return worst;
}

template <class To, class From> MatrixX<To> convert(const MatrixX<From>& X) {
  MatrixX<To> Y(X.rows(), X.cols());
  for (Index j = 0; j < X.cols(); ++j)
    for (Index i = 0; i < X.rows(); ++i) Y(i, j) = scalar_cast<To>(X(i, j));
  return Y;
}

// ---- random problems -------------------------------------------------------------------------------------------

/// Dyadic numbers of few bits, so that exact arithmetic stays small.
class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  Index integer(Index low, Index high) { return low + static_cast<Index>(engine_() % static_cast<unsigned>(high - low + 1)); }
  double number() { return static_cast<double>(integer(-8, 8)) / 4; }
  Vector6<double> vector() {
    Vector6<double> v;
    for (Index i = 0; i < 6; ++i) v[i] = number();
    return v;
  }
  Vector3<double> point() { return {number(), number(), number()}; }

 private:
  std::mt19937 engine_;
};

/// Columns that are linearly independent by construction: entry c of column c is 4 or more in excess of the others.
inline void fill_joint(Dice& dice, Problem<double>& p, Index body) {
  const Structure& s = *p.structure;
  for (Index k = s.first_dof[body]; k < s.first_dof[body + 1]; ++k) {
    p.S[k] = dice.vector();
    p.S[k][(k - s.first_dof[body] + body) % 6] += 16;
  }
}

inline Matrix6<double> random_inertia(Dice& dice, double mass) {
  Matrix3<double> I = Matrix3<double>::Zero();
  for (int axis = 0; axis < 3; ++axis) I(axis, axis) = mass * static_cast<double>(dice.integer(5, 8)) / 8;
  return spatial_inertia<double>(mass, dice.point(), I);
}

/// Tree of `bodies`, `loops` two-body constraints (K general, not antisymmetric), one three-body constraint, joint rows.
inline Case random_case(unsigned seed, Index bodies, Index loops, double smallest_damping = 0.25) {
  Dice dice(seed);
  auto s = std::make_shared<Structure>();
  for (Index i = 0; i < bodies; ++i) s->add_body(i == 0 ? ground : dice.integer(std::max<Index>(-1, i - 3), i - 1), dice.integer(1, 3));
  for (Index e = 0; e < loops; ++e) {
    const Index one = dice.integer(0, bodies - 1), other = dice.integer(0, bodies - 1);
    s->add_link_constraint(dice.integer(1, 3), one == other ? std::vector<Index>{one} : std::vector<Index>{one, other});
  }
  if (bodies >= 3) s->add_link_constraint(2, {0, bodies / 2, bodies - 1});
  s->add_joint_constraint(2, bodies - 1);
  s->add_joint_constraint(1, 0);
  Case c{Problem<double>(s), Damping<double>::uniform(s->rows, 0)};
  for (Index i = 0; i < bodies; ++i) {
    fill_joint(dice, c.problem, i);
    c.problem.H[i] = random_inertia(dice, static_cast<double>(dice.integer(1, 8)) / 2);
  }
  for (auto& k : c.problem.K) k = dice.vector();
  for (auto& k : c.problem.joint_K) k = dice.number();
  for (auto& a : c.problem.armature) a = static_cast<double>(dice.integer(0, 2)) / 4;
  for (auto& r : c.damping.diagonal) r = smallest_damping * static_cast<double>(dice.integer(1, 4));
  return c;
}

/// Replaces the damping of the first link constraint by a full block B Bᵀ + 1.
inline void add_block(Case& c, unsigned seed) {
  Dice dice(seed);
  const auto& e = c.problem.structure->link_constraints.front();
  Matrix B(e.rows, e.rows);
  for (Index j = 0; j < e.rows; ++j)
    for (Index i = 0; i < e.rows; ++i) B(i, j) = dice.number();
  for (Index r = 0; r < e.rows; ++r) c.damping.diagonal[static_cast<std::size_t>(e.row + r)] = 0;
  c.damping.blocks.push_back({e.row, B * B.transpose() + Matrix::Identity(e.rows, e.rows)});
}

inline Matrix random_right_side(unsigned seed, Index rows) {
  Dice dice(seed);
  Matrix x(rows, 1);
  for (Index i = 0; i < rows; ++i) x(i, 0) = dice.number();
  return x;
}

inline Vector rounded(const MatrixX<Quad>& x) { return convert<double>(x).col(0); }

}  // namespace delassus::reference::cases
