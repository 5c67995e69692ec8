// The operators against the symbolic reference: kinetic energy and constraint functions differentiated symbolically,
// evaluated to 60 digits. In double and in Quad; then with seeded defects, which must show.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>

#include "algorithms/delassus.h"
#include "algorithms/kit/test_scalars.h"
#include "algorithms/mechanism/kinematics.h"
#include "algorithms/mechanism/loop_closing.h"
#include "algorithms/mechanism/motion.h"
#include "property_tests/unit/mechanism/lagrangian_bounds.h"
#include "property_tests/unit/mechanism/lagrangian_cases.h"
#include "property_tests/laws/verdict.h"
#include "reference/lagrangian_page.h"
#include "reference/lagrangian_simplify.h"
#include "reference/lagrangian_sketch.h"
#include "reference/sensitivity.h"

namespace delassus::unit::lagrangian_test {
namespace {

using laws::Verdict;
using lagrangian::Mechanism;
using lagrangian::Numbers;

constexpr int samples = 8;

/// A x or A⁻¹ x by an operator, in Quad.
template <class T>
VectorX<Quad> answer(const OperatorRow& row, bool solve, const Problem<T>& problem, const Damping<T>& damping, const Vector& x) {
  const auto op = row.make<T>();
  op->analyze(problem.structure);
  EXPECT_TRUE(op->update(problem, damping).ok()) << row.name;
  Workspace<T> workspace(op->workspace());
  const MatrixX<T> in = converted<T>(x);
  MatrixX<T> out = MatrixX<T>::Constant(x.size(), 1, T(0));
  const Report report = solve ? op->solve(in, out, workspace) : op->apply(in, out, workspace);
  // In Quad no wider arithmetic shows an iteration that it is done; what it came to is held to the same bound.
  const bool undecided = std::is_same_v<T, Quad> && report.status == Status::not_converged;
  EXPECT_TRUE(report.ok() || undecided) << row.name << " " << name(report.status);
  VectorX<Quad> y(x.size());
  for (Index i = 0; i < x.size(); ++i) y[i] = scalar_cast<Quad>(out(i, 0));
  return y;
}

/// The worst verdict on a problem against the reference, of every operator of the table that is served in T;
/// `bound(row, solve, y)`: of the errors of y.
template <class T, class Bound>
Verdict compare(const Numbers& numbers, const Sample& s, const Problem<T>& problem, std::string_view bound_name, Bound bound) {
  const Damping<T> damping = Damping<double>{s.R_inverse, {}}.template cast<T>();
  Verdict worst;
  for (const bool solve : {false, true}) {
    const VectorX<Quad> exact = solve ? numbers.solve(s.R_inverse, s.x) : numbers.apply(s.R_inverse, s.x);
    const Vector y = exact.unaryExpr([](const Quad& v) { return static_cast<double>(v); });
    for (const OperatorRow& row : operators()) {
      if (!std::get<Maker<T>>(row.makers) || !(solve ? row.solves : row.applies)) continue;
      const VectorX<Quad> error = answer<T>(row, solve, problem, damping, s.x) - exact;
      Verdict v = laws::judge(error, converted<Quad>(bound(row, solve, y)), unit_roundoff<T>, bound_name);
      v.note = std::string(row.name) + (solve ? " solve" : " apply");
      worst = laws::worst(worst, v);
    }
  }
  return worst;
}

/// Model and kinematics in T against the reference, with the bound of kinematics.
template <class T> Verdict verdict(const Known& k, const Sample& s, const Model& model, const Problem<T>& problem) {
  const Numbers numbers(k.mechanism, k.derived, s.parameters, s.q);
  const LagrangianBounds bounds(numbers, widened(model, library_q(k, s.q), problem.template cast<double>()), s.R_inverse);
  return compare<T>(numbers, s, problem, "kinematic_sensitivity",
                    [&](const OperatorRow& row, bool solve, const Vector& y) { return bounds.of(row, solve, s.x, y); });
}
template <class T> Verdict verdict(const Known& k, const Sample& s, const Model& model) {
  return verdict<T>(k, s, model, kinematics<T>(model, converted<T>(library_q(k, s.q))));
}

/// The numbers of a problem rounded once from Quad: operators in double against the bounds of sensitivity.h.
Verdict verdict_of_rounded(const Known& k, const Sample& s) {
  const Numbers numbers(k.mechanism, k.derived, s.parameters, s.q);
  const auto problem = kinematics<Quad>(model_of(k, s), converted<Quad>(library_q(k, s.q))).cast<double>();
  const reference::Sensitivity sensitivity(problem, {s.R_inverse, {}});
  return compare<double>(numbers, s, problem, "sensitivity", [&](const OperatorRow& row, bool solve, const Vector& y) {
    if (!solve) return sensitivity.apply_sensitivity(s.x);
    if (row.solve_error == ErrorClass::normwise) return sensitivity.solve_normwise(s.x, y);
    Vector b = sensitivity.solve_sensitivity(s.x, y);
    if (row.solve_error == ErrorClass::amplified) b += sensitivity.solve_amplified(s.x);
    return b;
  });
}

std::string text(const Known& k, unsigned seed, const Verdict& v) {
  return k.mechanism.name + " sample " + std::to_string(seed) + ": " + v.note + " ratio " + std::to_string(v.ratio) +
         " of " + std::string(v.bound) + " at row " + std::to_string(v.row);
}

class Lagrangian : public testing::TestWithParam<std::size_t> {
 protected:
  const Known& k_ = known(GetParam());
};

/// Every sample passes; the worst ratio is recorded.
template <class Of> void all_pass(const Known& k, Of verdict_of) {
  double worst = 0;
  for (unsigned seed = 1; seed <= samples; ++seed) {
    const Verdict v = verdict_of(sample(k, seed));
    EXPECT_TRUE(v.passed()) << text(k, seed, v);
    worst = std::max(worst, v.ratio);
  }
  testing::Test::RecordProperty("worst_ratio", std::to_string(worst));
}

TEST_P(Lagrangian, OperatorsAgreeInDouble) {
  all_pass(k_, [&](const Sample& s) { return verdict<double>(k_, s, model_of(k_, s)); });
}
TEST_P(Lagrangian, OperatorsAgreeOnRoundedData) {
  all_pass(k_, [&](const Sample& s) { return verdict_of_rounded(k_, s); });
}
TEST_P(Lagrangian, OperatorsAgreeInQuad) {
  all_pass(k_, [&](const Sample& s) { return verdict<Quad>(k_, s, model_of(k_, s)); });
}

// ---- closed loops, assembled -----------------------------------------------------------------------------------

/// Samples of a mechanism whose loop Newton's method closes from a random start; the operators agree at each.
int closed_samples(const Known& k) {
  int closed = 0;
  for (unsigned seed = 1; seed <= 40 && closed < samples; ++seed) {
    Sample s = sample(k, seed);
    const Model model = model_of(k, s);
    try {
      s.q = assemble(model, s.q, k.mechanism.name).q;
    } catch (const ModelError&) {
      continue;
    }
    ++closed;
    const Verdict v = verdict<Quad>(k, s, model);
    EXPECT_TRUE(v.passed()) << text(k, seed, v);
  }
  return closed;
}

TEST(LagrangianLoops, OperatorsAgreeWhenClosed) {
  int mechanisms = 0;
  for (std::size_t i = 0; i < lagrangian::mechanisms().size(); ++i) {
    const Model model = model_of(known(i), sample(known(i), 1));
    if (std::none_of(model.constraints.begin(), model.constraints.end(), [](const Constraint& c) { return c.loop; })) continue;
    ++mechanisms;
    EXPECT_GE(closed_samples(known(i)), samples / 2) << known(i).mechanism.name;
  }
  EXPECT_EQ(mechanisms, 2);
}

// ---- defects: each must be seen wherever it changes A ----------------------------------------------------------

using Change = bool (*)(Model&);   // false: there is nothing to change

bool forgotten_armature(Model& m) {
  bool any = false;
  for (Body& b : m.bodies) any = any || !b.joint.armature.empty(), b.joint.armature.clear();
  return any;
}
bool halved_inertia(Model& m) { return m.bodies.back().inertia *= 0.5, m.bodies.back().joint.type != JointType::prismatic; }
bool centre_at_origin(Model& m) {
  for (Body& b : m.bodies)
    if (!b.com.isZero(0)) return b.com.setZero(), true;
  return false;
}
bool turned_frame(Model& m) {
  Constraint& c = m.constraints.front();
  Frame& a = c.a.body != ground ? c.a : c.b;
  if (a.placement.translation.isZero(0)) return false;
  a.placement.translation *= -1;
  return true;
}

TEST_P(Lagrangian, SeesAChangedModel) {
  const std::pair<const char*, Change> changes[] = {{"forgotten armature", forgotten_armature}, {"halved inertia", halved_inertia},
                                                    {"centre of mass at the origin", centre_at_origin},
                                                    {"frame on the wrong side", turned_frame}};
  const Sample s = sample(k_, 1);
  int seen = 0;
  double smallest = std::numeric_limits<double>::infinity();
  for (const auto& [what, change] : changes) {
    Model model = model_of(k_, s);
    if (!change(model)) continue;
    ++seen;
    const Verdict v = verdict<double>(k_, s, model);
    EXPECT_FALSE(v.passed()) << what;
    EXPECT_FALSE(verdict<Quad>(k_, s, model).passed()) << what;
    smallest = std::min(smallest, v.ratio);
  }
  EXPECT_GE(seen, 2);
  RecordProperty("smallest_ratio_in_double", std::to_string(smallest));
}

/// The moment part of every row of the first constraint with the wrong sign: J is wrong, M is right.
TEST_P(Lagrangian, SeesAWrongSignInJ) {
  const Sample s = sample(k_, 1);
  const Model model = model_of(k_, s);
  Problem<Quad> problem = kinematics<Quad>(model, converted<Quad>(library_q(k_, s.q)));
  const auto& first = problem.structure->link_constraints.front();
  for (const auto& link : first.links)
    for (Index r = 0; r < first.rows; ++r) problem.K[link.first + r].head<3>() *= Quad(-1);
  EXPECT_FALSE(verdict<Quad>(k_, s, model, problem).passed());
  EXPECT_FALSE(verdict<double>(k_, s, model, problem.cast<double>()).passed());
}

// ---- velocities ------------------------------------------------------------------------------------------------

struct Moves {
  MatrixX<Quad> forces, rows;
};

/// c(q, ν) and J̇ν in T.
template <class T> Moves moves(const Known& k, const Sample& s, const Model& model, const Vector& nu, const Vector& g) {
  delassus::Mechanism<T> mechanism(model);
  Motion<T> motion(mechanism);
  mechanism.update(converted<T>(library_q(k, s.q)));
  motion.update(converted<T>(nu));
  VectorX<T> c, rows;
  motion.bias_forces(Vector3<T>(converted<T>(g)), c);
  motion.bias_rows(rows);
  const auto wide = [](const VectorX<T>& x) { return MatrixX<Quad>(x.unaryExpr([](const T& v) { return scalar_cast<Quad>(v); })); };
  return {wide(c), wide(rows)};
}

/// Against what the terms may come to: squares of velocities, and gravity, times lengths (rows) and moments (forces) of the sample.
double size_of_terms(const Sample& s, const Vector& nu, const Vector& g) {
  double lengths = 1 + s.q.cwiseAbs().sum();
  for (const double p : s.parameters) lengths += std::fabs(p);
  return (std::pow(1 + nu.cwiseAbs().sum(), 2) + g.norm()) * lengths * lengths;
}
Verdict same_in(double eps, const MatrixX<Quad>& x, const MatrixX<Quad>& y, double size) {
  return laws::judge(x - y, MatrixX<Quad>::Constant(x.rows(), 1, Quad(size)), eps, "size of the terms");
}
/// Rows in the axes of frame a see the lever of frame b alone.
bool turned_far_end(Model& m) {
  Frame& b = m.constraints.front().b;
  if (b.body == ground || b.placement.translation.isZero(0)) return false;
  b.placement.translation *= -1;
  return true;
}

TEST_P(Lagrangian, BiasAgrees) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Sample s = sample(k_, seed);
    Dice dice(100 + seed);
    const Vector nu = dice.vector(static_cast<Index>(k_.mechanism.nu.size()), -2, 2), g = dice.vector(3, -8, 8);  // sixteenths
    const auto exactly = [&](Index c) { return GiNaC::ex(static_cast<int>(16 * g[c])) / 16; };
    const Numbers numbers(k_.mechanism, k_.derived, s.parameters, s.q);
    const lagrangian::Bias bias = lagrangian::bias(k_.mechanism, lagrangian::point(exactly(0), exactly(1), exactly(2)));
    const Moves exact{numbers.evaluate(bias.forces, nu), numbers.evaluate(bias.rows, nu)};
    const double size = size_of_terms(s, nu, g);
    const auto agrees = [&](double eps, const Moves& said) {
      return std::pair{same_in(eps, said.forces, exact.forces, size).passed(), same_in(eps, said.rows, exact.rows, size).passed()};
    };
    const Model model = model_of(k_, s);
    EXPECT_EQ(agrees(unit_roundoff<Quad>, moves<Quad>(k_, s, model, nu, g)), std::pair(true, true)) << seed;
    EXPECT_EQ(agrees(unit_roundoff<double>, moves<double>(k_, s, model, nu, g)), std::pair(true, true)) << seed;
    for (const bool wide : {true, false}) {
      const auto spoilt = [&](const Model& m) {
        return wide ? agrees(unit_roundoff<Quad>, moves<Quad>(k_, s, m, nu, g)) : agrees(unit_roundoff<double>, moves<double>(k_, s, m, nu, g));
      };
      Model changed = model;
      if (centre_at_origin(changed)) {
        EXPECT_FALSE(spoilt(changed).first) << seed;
      }
      changed = model;
      if (turned_far_end(changed)) {
        EXPECT_FALSE(spoilt(changed).second) << seed;
      }
    }
  }
}

// ---- the closed forms ------------------------------------------------------------------------------------------

/// Largest difference against the largest entry, as a verdict.
Verdict same(const MatrixX<Quad>& x, const MatrixX<Quad>& y) {
  Quad size(0);
  for (const Quad& v : y.reshaped()) size = std::max(size, Quad(abs(v)));
  return laws::judge(x - y, MatrixX<Quad>::Constant(x.rows(), 1, size), unit_roundoff<Quad>, "largest entry");
}

TEST_P(Lagrangian, ClosedFormsHaveTheSameValues) {
  const Mechanism m = lagrangian::specialised(k_.mechanism);
  const Known shown{m, lagrangian::derive(m)};
  const lagrangian::ClosedForms f = lagrangian::closed_forms(m, shown.derived);
  const Sample s = sample(shown, 3);
  const Numbers numbers(m, shown.derived, s.parameters, s.q);
  const std::vector<Index> rows(m.shown.rows.begin(), m.shown.rows.end());
  const MatrixX<Quad> J = numbers.J()(rows, Eigen::all), A = numbers.lambda_inverse()(rows, rows);
  EXPECT_TRUE(same(numbers.evaluate(f.M), numbers.M()).passed());
  EXPECT_TRUE(same(numbers.evaluate(f.J), J).passed());
  const MatrixX<Quad> top = numbers.evaluate(f.numerator), bottom = numbers.evaluate(f.denominator);
  EXPECT_TRUE(same(top.cwiseQuotient(bottom), A).passed());
}

INSTANTIATE_TEST_SUITE_P(Mechanisms, Lagrangian, testing::Range<std::size_t>(0, lagrangian::mechanisms().size()),
                         [](const auto& i) { return lagrangian::mechanisms()[i.param].name; });

/// The rates of a quaternion turn it by ω in body axes: Rᵀ Ṙ = ω̂, symbolically.
TEST(LagrangianRates, QuaternionTurnsByOmega) {
  for (const Mechanism& m : lagrangian::mechanisms()) {
    if (m.quaternions.empty()) continue;
    const GiNaC::matrix& R = m.bodies[0].rotation;
    GiNaC::matrix R_rate(3, 3);
    for (unsigned k = 0; k < 9; ++k) R_rate(k / 3, k % 3) = lagrangian::rate(m, R(k / 3, k % 3));
    const GiNaC::ex x = m.nu[0], y = m.nu[1], z = m.nu[2];
    const GiNaC::matrix omega{{0, -z, y}, {z, 0, -x}, {-y, x, 0}};
    const GiNaC::matrix turned = lagrangian::Simplifier(m).polynomial(R.transpose().mul(R_rate));
    for (unsigned k = 0; k < 9; ++k)
      EXPECT_TRUE((turned(k / 3, k % 3) - omega(k / 3, k % 3)).expand().is_zero()) << m.name << " entry " << k;
  }
}

std::string contents(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream s;
  s << in.rdbuf();
  return s.str();
}

TEST(LagrangianPage, IsUpToDate) {
  EXPECT_EQ(contents("docs/closed_forms.md"), lagrangian::closed_forms_page())
      << "write it anew: <build>/reference/lagrangian_page > docs/closed_forms.md";
}

/// Of algorithms/ only the scalars and the matrix types.
TEST(LagrangianPage, ReferenceUsesNoSpatialAlgebra) {
  for (const char* file : {"", "_main", "_mechanisms", "_page", "_simplify", "_sketch"})
    for (const char* end : {".h", ".cpp"}) {
      const std::string source = contents(std::string("reference/lagrangian") + file + end);
      for (std::size_t at = 0; (at = source.find("#include \"algorithms/", at)) != std::string::npos; ++at)
        EXPECT_TRUE(source.compare(at + 21, 18, "kit/test_scalars.h") == 0 || source.compare(at + 21, 13, "kit/spatial.h") == 0) << file;
      for (const char* word : {"spatial_inertia", "rotation_axis", "cross_matrix", "Vector6", "Matrix6"})
        EXPECT_EQ(source.find(word), std::string::npos) << file << " " << word;
    }
}

}  // namespace
}  // namespace delassus::unit::lagrangian_test
