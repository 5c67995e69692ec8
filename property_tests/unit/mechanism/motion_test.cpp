// Motion against the exact derivatives of kinematics: in rational numbers equality, in Quad at any axes; laws of c(q, ν) and J̇ν.
#include "algorithms/mechanism/motion.h"

#include <gtest/gtest.h>

#include "property_tests/unit/mechanism/motion_cases.h"

namespace delassus::motion_test {
namespace {

using namespace unit;
using Kind = Constraint::Kind;

/// Everything Motion says at (q, ν). T a jet: of its values.
template <class T> struct Said {
  VectorX<T> c, weight, rows, tau;
  std::vector<Vector6<T>> twists, products;

  Said(const Model& model, const VectorX<T>& q, const VectorX<T>& nu, const Vector3<T>& g, const VectorX<T>& acceleration) {
    Mechanism<T> mechanism(model);
    Motion<T> motion(mechanism);
    mechanism.update(q);
    motion.update(nu);
    motion.bias_forces(c);
    motion.bias_forces(g, weight);
    weight -= c;
    motion.bias_rows(rows);
    motion.twists(twists);
    motion.velocity_products(products);
    motion.rnea(acceleration, g, tau);
  }
};

struct Exact {
  using R = Rational;
  using J = Jet<R>;
  Model model;
  VectorX<R> q, nu, acceleration;
  Vector3<R> g;

  explicit Exact(unsigned seed) {
    Eighths dice(seed);
    model = rational_robots(dice);
    add_rows(model, dice, false);
    q = dice.fractions<R>(model.q_size());
    nu = dice.fractions<R>(model.dofs());
    acceleration = dice.fractions<R>(model.dofs());
    g = dice.fractions<R>(3);
  }
  /// As jets that stand still.
  template <class X> static VectorX<J> still(const X& x) {
    VectorX<J> y(x.size());
    for (Index k = 0; k < x.size(); ++k) y[k] = J(x[k], R(0));
    return y;
  }
  [[nodiscard]] Said<J> said() const { return said(nu); }
  [[nodiscard]] Said<J> said(const VectorX<R>& v) const {
    return Said<J>(model, still(q), still(v), Vector3<J>(still(g)), still(acceleration));
  }
};

TEST(motion, twists_and_products_are_the_rates_of_kinematics_exactly) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Exact e(seed);
    const Said<Jet<Rational>> said = e.said();
    const Differentiated<Rational> truth(e.model, e.q, e.nu);
    for (Index i = 0; i < static_cast<Index>(e.model.bodies.size()); ++i) {
      EXPECT_TRUE(value_of<Rational>(said.twists[i]) == truth.twist(i)) << e.model.bodies[i].name;
      EXPECT_TRUE(value_of<Rational>(said.products[i]) == truth.velocity_product(i)) << e.model.bodies[i].name;
    }
  }
}

TEST(motion, bias_of_rows_is_the_rate_of_J_exactly) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Exact e(seed);
    const MatrixX<Rational> said = value_of<Rational>(e.said().rows), truth = Differentiated<Rational>(e.model, e.q, e.nu).rows();
    Index row = 0;
    for (const Constraint& c : e.model.constraints)
      for (Index k = 0; k < row_count(e.model, c); ++k, ++row)
        EXPECT_TRUE(said(row, 0) == truth(row, 0)) << name(c.kind) << " " << c.a.body << " " << c.b.body << " row " << k;
  }
}

TEST(motion, bias_forces_are_the_rates_of_momenta_exactly) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Exact e(seed);
    EXPECT_TRUE(value_of<Rational>(e.said().c) == Differentiated<Rational>(e.model, e.q, e.nu).bias_forces()) << seed;
  }
}

TEST(motion, weight_is_the_slope_of_the_potential_energy_exactly) {
  const Exact e(5);
  const MatrixX<Rational> weight = value_of<Rational>(e.said().weight);
  for (Index k = 0; k < e.model.dofs(); ++k) {
    VectorX<Rational> direction = VectorX<Rational>::Constant(e.model.dofs(), Rational(0));
    direction[k] = Rational(1);
    EXPECT_TRUE(weight(k, 0) == Differentiated<Rational>(e.model, e.q, direction).potential_rate(e.model, e.g)) << k;
  }
}

}  // namespace
}  // namespace delassus::motion_test
