// RNEA, CRBA, ABA and constrained forward dynamics against each other and against dense equations.
#include "algorithms/dynamics/dynamics.h"

#include <gtest/gtest.h>

#include "property_tests/unit/allocations.h"
#include "property_tests/unit/mechanism/motion_cases.h"
#include "property_tests/laws/verdict.h"
#include "reference/definition.h"

namespace delassus::laws {
std::int64_t (*allocation_count)() = nullptr;  // set by count_allocations
}

namespace delassus::dynamics_test {
namespace {

using namespace unit;

// ---- exactly -----------------------------------------------------------------------------------------------------

/// A rational mechanism's numbers, c with gravity and J̇ν, in an exact scalar.
template <class T> struct Numbers {
  Problem<T> problem;
  VectorX<T> c, rows, acceleration, tau;
  Damping<T> damping;

  explicit Numbers(unsigned seed) {
    using R = Rational;
    Eighths dice(seed);
    Model model = rational_robots(dice);
    add_rows(model, dice, false);
    const VectorX<R> q = dice.fractions<R>(model.q_size()), nu = dice.fractions<R>(model.dofs());
    const auto still = [](const VectorX<R>& x) { return VectorX<Jet<R>>(x.unaryExpr([](const R& v) { return Jet<R>(v, R(0)); })); };
    Mechanism<Jet<R>> mechanism(model);
    Motion<Jet<R>> motion(mechanism);
    Problem<Jet<R>> jets(mechanism.structure());
    mechanism.update(still(q));
    mechanism.fill(jets);
    motion.update(still(nu));
    VectorX<Jet<R>> of_c, of_rows, of_tau;
    const VectorX<R> a = dice.fractions<R>(model.dofs());
    const Vector3<Jet<R>> g(Jet<R>(0), Jet<R>(1), Jet<R>(-10));
    motion.bias_forces(g, of_c);
    motion.bias_rows(of_rows);
    motion.rnea(still(a), g, of_tau);
    const auto exact = [](const auto& x) { return x.unaryExpr([](const Jet<R>& v) { return of(v.value); }).eval(); };
    problem = Problem<T>(mechanism.structure());
    for (std::size_t k = 0; k < jets.S.size(); ++k) problem.S[k] = exact(jets.S[k]), problem.armature[k] = of(jets.armature[k].value);
    for (std::size_t k = 0; k < jets.H.size(); ++k) problem.H[k] = exact(jets.H[k]);
    for (std::size_t k = 0; k < jets.K.size(); ++k) problem.K[k] = exact(jets.K[k]);
    for (std::size_t k = 0; k < jets.joint_K.size(); ++k) problem.joint_K[k] = of(jets.joint_K[k].value);
    c = exact(of_c), rows = exact(of_rows), tau = exact(of_tau);
    acceleration = a.unaryExpr([](const R& v) { return of(v); });
    for (Index r = 0; r < rows.size(); ++r) damping.diagonal.push_back(T(1 + static_cast<int>(r % 7)));
  }
  static T of(const Rational& x) {
    if constexpr (std::is_same_v<T, Rational>) return x;
    else {  // numerator over denominator, each digit by digit
      const auto whole = [](const mpz_class& z) {
        T sum(0);
        for (const char digit : mpz_class(abs(z)).get_str()) sum = sum * T(10) + T(digit - '0');
        return z < 0 ? -sum : sum;
      };
      return whole(x.v.get_num()) / whole(x.v.get_den());
    }
  }
};

template <class T> class ExactDynamics : public testing::Test {};
using ExactScalars = testing::Types<Rational, PrimeField>;
TYPED_TEST_SUITE(ExactDynamics, ExactScalars);

TYPED_TEST(ExactDynamics, rnea_crba_and_aba_are_one) {
  using T = TypeParam;
  const Numbers<T> k(91);
  MatrixX<T> M;
  crba(k.problem, M);
  EXPECT_TRUE(M == mass_matrix(k.problem));
  EXPECT_TRUE(VectorX<T>(M * k.acceleration + k.c) == k.tau) << "rnea";
  ForwardDynamics<T> forward(k.problem.structure, "lcaba");
  ASSERT_TRUE(forward.update(k.problem, k.damping).ok());
  VectorX<T> a;
  ASSERT_TRUE(forward.aba(k.tau - k.c, a).ok());
  EXPECT_TRUE(a == k.acceleration) << "aba of rnea";
}

TYPED_TEST(ExactDynamics, constrained_aba_satisfies_its_equations) {
  using T = TypeParam;
  const Numbers<T> k(92);
  ForwardDynamics<T> forward(k.problem.structure, "lcaba");
  ASSERT_TRUE(forward.update(k.problem, k.damping).ok());
  const VectorX<T> f = k.tau - k.c;
  VectorX<T> wanted(k.rows.size()), a, lambda;
  for (Index r = 0; r < wanted.size(); ++r) wanted[r] = T(static_cast<int>(r) - 5) - k.rows[r];
  ASSERT_TRUE(forward.constrained_aba(f, wanted, Accuracy::full(), a, lambda).ok());
  const MatrixX<T> J = constraint_jacobian(k.problem), M = mass_matrix(k.problem);
  EXPECT_TRUE(VectorX<T>(M * a - J.transpose() * lambda) == f);
  VectorX<T> damped(lambda.size());
  k.damping.multiply(lambda, damped);
  EXPECT_TRUE(VectorX<T>(J * a + damped) == wanted);
}

// ---- rounded -----------------------------------------------------------------------------------------------------

struct Moving {
  Model model;
  VectorX<double> q, nu, acceleration, wanted, tau;
  Vector3<double> g;
  Damping<double> damping;

  Moving(unsigned seed, bool hard) : model(two_robots(seed)) {
    Random random(seed);
    if (hard)
      for (const auto& [a, b] : {std::pair<Index, Index>{3, 7}, {4, 12}, {15, ground}}) {
        Constraint c;
        c.kind = a == 15 ? Constraint::Kind::contact : Constraint::Kind::point;
        c.a = {a, random.pose()};
        c.b = {b, random.pose()};
        model.constraints.push_back(c);
      }
    else add_rows(model, random, true);
    q = random_configuration(model, random);
    const auto numbers = [&](Index n) { return VectorX<double>(VectorX<double>::NullaryExpr(n, [&](Index) { return random.number(-2, 2); })); };
    nu = numbers(model.dofs()), acceleration = numbers(model.dofs()), tau = numbers(model.dofs());
    g = {0, 0, -9.81};
    Index rows = 0;
    for (const Constraint& c : model.constraints) rows += row_count(model, c);
    wanted = numbers(rows);
    damping = Damping<double>::uniform(rows, hard ? 0 : 0.125);
  }
};

/// |M⁻¹|(M_bound |a| + |f|): what an error of eps in M's numbers and in f makes of M⁻¹f (reference/sensitivity.h).
struct Dense {
  MatrixX<Quad> M, J, A, M_inverse;
  MatrixX<double> M_bound, M_inverse_abs, J_abs, A_inverse_abs;

  Dense(const Problem<double>& problem, const Damping<double>& damping) {
    const Problem<Quad> p = problem.cast<Quad>();
    M = reference::mass_matrix(p), J = reference::constraint_jacobian(p);
    M_inverse = reference::PivotedLdlt<Quad>(M).inverse();
    A = J * M_inverse * J.transpose() + reference::damping_matrix(*p.structure, damping.cast<Quad>());
    const auto magnitude = [](const MatrixX<Quad>& x) { return MatrixX<double>(x.unaryExpr([](const Quad& v) { return std::fabs(static_cast<double>(v)); })); };
    M_inverse_abs = magnitude(M_inverse);
    if (A.rows() > 0) A_inverse_abs = magnitude(reference::PivotedLdlt<Quad>(A).inverse());
    Problem<double> absolute = problem;
    for (auto& s : absolute.S) s = s.cwiseAbs().eval();
    for (auto& k : absolute.K) k = k.cwiseAbs().eval();
    for (auto& k : absolute.joint_K) k = std::fabs(k);
    J_abs = reference::constraint_jacobian(absolute);
    const VectorX<double> d = magnitude(M).diagonal().cwiseSqrt();
    M_bound = d * d.transpose();
  }
  [[nodiscard]] VectorX<double> free_bound(const VectorX<double>& a, const VectorX<double>& f) const {
    return M_inverse_abs * (M_bound * a.cwiseAbs() + f.cwiseAbs());
  }
};

VectorX<double> rounded(const VectorX<Quad>& x) { return x.unaryExpr([](const Quad& v) { return static_cast<double>(v); }); }
laws::Verdict judged(const VectorX<double>& said, const VectorX<Quad>& truth, const VectorX<double>& bound) {
  return laws::judge(converted<Quad>(said) - truth, converted<Quad>(bound), unit_roundoff<double>, "sensitivity");
}

TEST(dynamics, aba_undoes_rnea) {
  for (unsigned seed = 93; seed < 97; ++seed) {
    const Moving k(seed, false);
    Dynamics<double> d(k.model, k.g);
    ASSERT_TRUE(d.update(k.q, k.nu, k.damping).ok());
    VectorX<double> tau, a;
    d.rnea(k.acceleration, tau);
    ASSERT_TRUE(d.aba(tau, a).ok());
    // τ of rnea errs by eps of M_bound |a| and of what c is summed from, of which c and the weight of everything are a measure.
    const Dense dense(d.problem(), k.damping);
    const VectorX<double> size = d.bias_forces().cwiseAbs() + VectorX<double>::Constant(tau.size(), d.bias_forces().cwiseAbs().maxCoeff());
    EXPECT_TRUE(judged(a, converted<Quad>(k.acceleration), dense.free_bound(k.acceleration, tau.cwiseAbs() + size)).passed()) << seed;
    MatrixX<double> M;
    d.crba(M);
    EXPECT_LT(ratio<double>(M, rounded(dense.M.reshaped()).reshaped(M.rows(), M.cols())), 30) << seed;
  }
}

/// ν̇ and λ of the dense equations in Quad at the numbers that the dynamics were given.
void expect_dense_answer(const Moving& k, std::string_view op) {
  Dynamics<double> d(k.model, k.g, op);
  ASSERT_TRUE(d.update(k.q, k.nu, k.damping).ok()) << op;
  VectorX<double> a, lambda;
  const Report report = d.constrained_aba(k.tau, k.wanted, a, lambda);
  ASSERT_TRUE(report.ok()) << op << " " << name(report.status);
  const Dense dense(d.problem(), k.damping);
  const VectorX<Quad> f = converted<Quad>(k.tau) - converted<Quad>(d.bias_forces()), target = converted<Quad>(k.wanted) - converted<Quad>(d.bias_rows());
  const VectorX<Quad> free = dense.M_inverse * f, right = target - dense.J * free;
  const VectorX<Quad> truth = reference::PivotedLdlt<Quad>(dense.A).solve(right).col(0);
  const VectorX<Quad> moving = dense.M_inverse * VectorX<Quad>(f + dense.J.transpose() * truth);
  // To first order, of the equations that the numbers err in by eps: right side, J free, A λ.
  const VectorX<double> force = k.tau.cwiseAbs() + d.bias_forces().cwiseAbs(), free_size = rounded(free);
  const VectorX<double> of_free = dense.free_bound(free_size, force);
  const VectorX<double> of_lambda = dense.free_bound(dense.M_inverse_abs * (dense.J_abs.transpose() * rounded(truth).cwiseAbs()), dense.J_abs.transpose() * rounded(truth).cwiseAbs());
  const VectorX<double> right_bound = k.wanted.cwiseAbs() + d.bias_rows().cwiseAbs() + dense.J_abs * (free_size.cwiseAbs() + of_free + of_lambda) + 0.125 * rounded(truth).cwiseAbs();
  const VectorX<double> bound = dense.A_inverse_abs * right_bound;
  EXPECT_TRUE(judged(lambda, truth, bound).passed()) << op << " " << judged(lambda, truth, bound).ratio;
  const VectorX<double> of_motion = of_free + of_lambda + dense.M_inverse_abs * (dense.J_abs.transpose() * bound);
  EXPECT_TRUE(judged(a, moving, of_motion).passed()) << op << " " << judged(a, moving, of_motion).ratio;
}

TEST(dynamics, constrained_aba_agrees_with_the_dense_equations) {
  for (unsigned seed = 97; seed < 99; ++seed) {
    for (const std::string_view op : {"ladder", "lcaba_refined", "dense_cholesky", "proximal"}) expect_dense_answer(Moving(seed, false), op);
    for (const std::string_view op : {"ladder", "kkt_elimination"}) expect_dense_answer(Moving(seed, true), op);
  }
}

/// Hard rows accelerate as they are told to, and the difference of J ν along the motion says so.
TEST(dynamics, hard_rows_accelerate_as_wanted) {
  const Moving k(99, true);
  Dynamics<Quad> d(k.model, Vector3<Quad>(converted<Quad>(k.g)));
  const VectorX<Quad> q = converted<Quad>(k.q), nu = converted<Quad>(k.nu), wanted = converted<Quad>(k.wanted);
  const auto J_nu = [&](const VectorX<Quad>& at, const VectorX<Quad>& v) { return MatrixX<Quad>(constraint_jacobian(kinematics<Quad>(k.model, at)) * v); };
  ASSERT_TRUE(d.update(q, nu, k.damping.cast<Quad>()).ok());
  VectorX<Quad> a, lambda;
  (void)d.constrained_aba(converted<Quad>(k.tau), wanted, a, lambda);  // in Quad nothing wider shows that it is done
  constexpr double h = 0x1p-30;
  const auto at = [&](double s) {  // q moved by ν s + ν̇ s²/2 to third order
    const VectorX<Quad> v = nu + a * Quad(s);
    return J_nu(integrate<Quad>(k.model, q, VectorX<Quad>((nu + a * Quad(s / 2)) * Quad(s))), v);
  };
  const MatrixX<Quad> difference = (at(h) - at(-h)) / Quad(2 * h);
  const double rate = 1 + k.nu.cwiseAbs().sum() + rounded(a).cwiseAbs().sum();
  for (Index r = 0; r < wanted.size(); ++r)
    EXPECT_LT(ratio(static_cast<double>(Quad(difference(r, 0) - wanted[r])), rate * rate * rate * rate, h * h), 30) << r;
}

TEST(dynamics, nothing_allocates_after_the_first_call) {
  laws::count_allocations();
  if (laws::allocation_count == nullptr) GTEST_SKIP() << "allocations are not counted in this build";
  const Moving k(101, false);
  Dynamics<double> d(k.model, k.g);
  VectorX<double> a, lambda, tau;
  const auto step = [&] {
    (void)d.update(k.q, k.nu, k.damping);
    d.rnea(k.acceleration, tau);
    (void)d.aba(k.tau, a);
    (void)d.constrained_aba(k.tau, k.wanted, a, lambda);
  };
  step();
  const std::int64_t before = laws::allocation_count();
  step();
  EXPECT_EQ(laws::allocation_count() - before, 0);
  const VectorX<double> seen = VectorX<double>::Zero(100);
  EXPECT_GT(laws::allocation_count() - before, 0) << "the counter counts " << seen.size();
}

TEST(dynamics, what_is_wrong_is_said) {
  Moving k(100, false);
  EXPECT_THROW(Dynamics<double>(k.model, k.g, "no_such"), ModelError);
  Dynamics<double> d(k.model, k.g);
  EXPECT_THROW((void)d.update(VectorX<double>::Zero(2), k.nu, k.damping), std::logic_error);
  EXPECT_THROW((void)d.update(k.q, VectorX<double>::Zero(2), k.damping), std::logic_error);
  ASSERT_TRUE(d.update(k.q, k.nu, k.damping).ok());
  VectorX<double> a, lambda;
  EXPECT_THROW((void)d.aba(VectorX<double>::Zero(2), a), std::logic_error);
  EXPECT_THROW((void)d.constrained_aba(VectorX<double>::Zero(2), k.wanted, a, lambda), std::logic_error);
  EXPECT_THROW((void)d.constrained_aba(k.tau, VectorX<double>::Zero(2), a, lambda), std::logic_error);
  k.damping.diagonal[3] = -1;
  EXPECT_EQ(d.update(k.q, k.nu, k.damping).status, Status::bad_damping);
  EXPECT_EQ(d.constrained_aba(k.tau, k.wanted, a, lambda).status, Status::bad_damping);
  EXPECT_TRUE(d.aba(k.tau, a).ok());
  for (Body& b : k.model.bodies) b.mass = 0, b.inertia.setZero(), b.joint.armature.clear();
  Dynamics<double> massless(k.model, k.g);
  EXPECT_EQ(massless.update(k.q, k.nu, Damping<double>::uniform(k.wanted.size(), 1)).status, Status::lost_pivot);
  EXPECT_EQ(massless.aba(k.tau, a).status, Status::lost_pivot);
  EXPECT_TRUE(a.array().isNaN().all());
}

}  // namespace
}  // namespace delassus::dynamics_test
