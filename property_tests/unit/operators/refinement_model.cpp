#include "algorithms/kit/test_scalars.h"
#include "property_tests/unit/operators/refinement_model.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <thread>
#include <vector>

#include "algorithms/factors/refinement.h"
#include "generators/build.h"
#include "generators/families.h"
#include "property_tests/laws/route.h"

namespace delassus::laws {
namespace {

using Vector = MatrixX<Quad>;
using reference::product;

double largest(const Vector& x) {
  double most = 0;
  for (Index r = 0; r < x.rows(); ++r) most = std::max(most, std::abs(static_cast<double>(x(r, 0))));
  return most;
}

double dot_product(const Vector& x, const Vector& y) { return static_cast<double>(product<Quad>(x.transpose(), y)(0, 0)); }

/// What a correction leaves of the error of ν and of λ, and how the refinement is called.
struct Asked {
  double motion, force;
  double wanted = 0;
  int most = 100;
  bool patient = false;
};

struct Expected {
  Status status = Status::ok;
  Index iterations = 0;
  double bound = -1, estimate = -1;
  double force = 1, motion = 1;  // errors left, relative
};

class Model {
 public:
  explicit Model(const Case& c)
      : exact_(reference::dense(c.problem.cast<Quad>(), c.damping.cast<Quad>())), a_(converted<Quad>(vectors<double>(c.rows(), 1, c.seed))),
        lambda_(reference::dense_solve(exact_, a_)), nu_(product<Quad>(exact_.M_inv_Jt, lambda_)), M_(exact_.M), R_inverse_(exact_.R_inverse) {}

  /// The solution of (K).
  void correct(const double* r1, const double* r2, double* d_nu, double* d_lambda, const Asked& asked) const {
    Vector right1(nu_.rows(), 1), right2(lambda_.rows(), 1);
    for (Index k = 0; k < right1.rows(); ++k) right1(k, 0) = Quad(r1 == nullptr ? 0 : r1[k]);
    for (Index k = 0; k < right2.rows(); ++k) right2(k, 0) = Quad(r2[k]);
    const Vector force = reference::dense_solve(exact_, Vector(right2 - product<Quad>(exact_.M_inv_Jt.transpose(), right1)));
    const Vector motion = M_.solve(Vector(right1 + product<Quad>(exact_.J.transpose(), force)));
    for (Index k = 0; k < motion.rows(); ++k) d_nu[k] = (1 - asked.motion) * static_cast<double>(motion(k, 0));
    for (Index k = 0; k < force.rows(); ++k) d_lambda[k] = (1 - asked.force) * static_cast<double>(force(k, 0));
  }

  /// refinement.h, in the order of its paragraphs «How» and «Certificate».
  [[nodiscard]] Expected expected(const Asked& asked) const {
    Expected e{.force = asked.force, .motion = asked.motion};
    double size = 1, before = 1, left = 1, patient = 1;
    double motion = 1 - asked.motion, force = 1 - asked.force, energy = 1;  // of the last correction
    while (std::isfinite(asked.wanted)) {
      const bool done = left <= unit_roundoff<double>;
      if (done || asked.wanted > 0) e.bound = bound(e);
      const bool shown = e.iterations != 1 || size <= 4 * unit_roundoff<double> || !R_inverse_.regular() || at_a_row(e) <= unit_roundoff<double>;
      if ((done && shown) || (e.bound >= 0 ? e.bound <= asked.wanted : e.iterations > 0 && asked.wanted > 0 && patient <= asked.wanted)) break;
      if (e.iterations == asked.most || (e.iterations >= 2 && size >= 0.5 && before >= 0.5)) {
        e.bound = bound(e);
        const bool correction = e.estimate >= 0 && e.estimate <= 8 * unit_roundoff<double>;
        const bool at_rounding = e.bound <= 8 * unit_roundoff<double> && (correction || (R_inverse_.regular() && at_a_row(e) <= 4 * unit_roundoff<double>));
        if (asked.wanted > 0 || !at_rounding) e.status = Status::not_converged;
        break;
      }
      const Vector d_nu = nu_ * Quad((1 - asked.motion) * e.motion), d_lambda = lambda_ * Quad((1 - asked.force) * e.force);
      const double at_stake = largest(R_inverse_.regular() ? weighted(r2(e)) : d_lambda);
      const double square = dot_product(r1(e), d_nu) + dot_product(r2(e), d_lambda);
      e.motion *= asked.motion;
      e.force *= asked.force;
      const double of_force = std::abs(1 - e.force);  // λ of the iterate, relative to λ
      const double now = std::sqrt(std::abs(square)) / std::sqrt(std::abs(of_force * dot_product(lambda_, a_)));
      before = size;
      size = std::max(largest(d_lambda) / (of_force * largest(lambda_)), now);
      const auto shrunk = [](double to, double from) { return to == 0 ? 0 : std::min(1.0, to / from); };
      const double rho = std::max({shrunk(largest(d_nu), motion * largest(nu_)), shrunk(largest(d_lambda), force * largest(lambda_)), shrunk(now, energy)});
      const double gained = std::max(at_stake / (of_force * largest(lambda_)), size <= 4 * unit_roundoff<double> ? 0 : size);
      patient = std::max(size == 0 ? 0 : size * std::max(1.0, rho / (1 - rho)), std::min(at_stake / (of_force * largest(lambda_)), rho * before));
      left = asked.patient ? patient : gained * rho / (1 - rho);
      if (!asked.patient && !R_inverse_.regular() && size > 4 * unit_roundoff<double>) left = std::max(left, size);
      motion = largest(nu_) == 0 ? 0 : largest(d_nu) / largest(nu_);
      force = largest(d_lambda) / largest(lambda_);
      energy = now;
      e.estimate = size;
      ++e.iterations;
    }
    if (e.status == Status::ok && e.bound > (asked.wanted > 0 ? asked.wanted : std::sqrt(unit_roundoff<double>))) e.status = Status::not_converged;
    return e;
  }

  [[nodiscard]] MatrixX<double> right() const { return converted<double>(a_); }
  [[nodiscard]] Vector lambda(const Expected& e) const { return lambda_ * Quad(1 - e.force); }
  [[nodiscard]] Vector nu(const Expected& e) const { return nu_ * Quad(1 - e.motion); }
  [[nodiscard]] Index freedoms() const { return nu_.rows(); }

 private:
  Vector r1(const Expected& e) const { return product<Quad>(exact_.M, nu_) * Quad(e.motion) - product<Quad>(exact_.J.transpose(), lambda_) * Quad(e.force); }
  Vector r2(const Expected& e) const { return product<Quad>(exact_.J, nu_) * Quad(e.motion) + product<Quad>(exact_.R_inverse, lambda_) * Quad(e.force); }
  Vector weighted(const Vector& x) const { return R_inverse_.solve(x); }
  double energy_norm(const Expected& e) const { return std::sqrt(dot_product(r1(e), M_.solve(r1(e))) + dot_product(r2(e), weighted(r2(e)))); }
  /// √R_rr B of the stiffest row, relative to the largest force of the iterate.
  double at_a_row(const Expected& e) const {
    const Vector R = R_inverse_.inverse().diagonal();
    return std::sqrt(largest(R)) * energy_norm(e) / ((1 - e.force) * largest(lambda_));
  }
  double bound(const Expected& e) const {
    if (!R_inverse_.regular()) return -1;
    if (e.force >= 1) return std::numeric_limits<double>::infinity();  // λᵀa of the iterate is not positive
    const double B = energy_norm(e);
    const double t = B / std::sqrt((1 - e.force) * dot_product(lambda_, a_));
    return t * (t + std::sqrt(t * t + 4)) / 2 + 2 * unit_roundoff<double>;
  }

  reference::Dense<Quad> exact_;
  Vector a_, lambda_, nu_;
  reference::PivotedLdlt<Quad> M_, R_inverse_;
};

/// Right to half the digits: what is compared is itself a residual. Near eps only its being small counts.
bool about(double got, double expected) {
  if (expected < 0 || std::isinf(expected)) return got == expected;
  if (expected < 1e3 * unit_roundoff<double>) return got >= 0 && got < 2e3 * unit_roundoff<double>;
  const Quad error = Quad(got) - Quad(expected), size(expected);
  return judge(MatrixX<Quad>::Constant(1, 1, error), MatrixX<Quad>::Constant(1, 1, size), unit_roundoff<float>, "itself").passed();
}

std::string differs(const Model& model, const Refinement<double>& refinement, const Asked& asked, Workspace<double>& work) {
  const Expected expected = model.expected(asked);
  const MatrixX<double> a = model.right();
  MatrixX<double> f(a.rows(), 1), nu(model.freedoms(), 1);
  const auto correct = [&](const double* r1, const double* r2, double* d_nu, double* d_lambda, double*) { model.correct(r1, r2, d_nu, d_lambda, asked); };
  const Report r = refinement.solve({.r2 = a.data()}, f.data(), {asked.wanted}, {asked.most, asked.patient}, correct, work.data(), nu.data());
  if (r.status != expected.status) return "status " + std::string(name(r.status));
  if (r.iterations != expected.iterations) return std::to_string(r.iterations) + " steps instead of " + std::to_string(expected.iterations);
  if (!about(r.error_bound, expected.bound) || (r.error_bound >= 0 && r.error_bound < 2 * unit_roundoff<double>))
    return "bound " + std::to_string(r.error_bound / expected.bound) + " times what it should be";
  if (!about(r.error_estimate, expected.estimate)) return "estimate " + std::to_string(r.error_estimate) + " instead of " + std::to_string(expected.estimate);
  const auto close = [](const MatrixX<double>& got, const Vector& wanted) {
    return judge(converted<Quad>(got) - wanted, MatrixX<Quad>::Constant(got.rows(), 1, Quad(largest(wanted))), unit_roundoff<double>, "largest").passed();
  };
  if (!close(f, model.lambda(expected))) return "force";
  return close(nu, model.nu(expected)) ? "" : "motion";
}

std::string not_finite_missed(const Model& model, const Refinement<double>& refinement, Workspace<double>& work) {
  const Index n = model.freedoms();
  MatrixX<double> a = model.right(), f = a;
  for (const int bad : {0, 1, 2})
    for (const bool motion : {true, false})
      for (const Accuracy wanted : {Accuracy::full(), Accuracy::fastest()}) {
        if ((motion && n == 0) || (bad > 0 && wanted.error > 0)) continue;
        int calls = 0;
        const auto correct = [&](const double* r1, const double* r2, double* d_nu, double* d_lambda, double*) {
          model.correct(r1, r2, d_nu, d_lambda, {0.5, 0.5});
          if (calls++ == bad) (motion ? d_nu[n - 1] : d_lambda[a.rows() - 1]) = std::numeric_limits<double>::quiet_NaN();
        };
        const Report r = refinement.solve({.r2 = a.data()}, f.data(), wanted, {100}, correct, work.data());
        if (r.status != Status::not_finite) return "a NaN in correction " + std::to_string(bad) + ": " + std::string(name(r.status));
      }
  return {};
}

/// Nothing is asked: nothing is answered, at once.
std::string zero_missed(const Model& model, const Refinement<double>& refinement, Workspace<double>& work) {
  const MatrixX<double> a = MatrixX<double>::Zero(model.right().rows(), 1);
  MatrixX<double> f = model.right();
  const auto correct = [&](const double* r1, const double* r2, double* d_nu, double* d_lambda, double*) { model.correct(r1, r2, d_nu, d_lambda, {0.5, 0.5}); };
  const Report r = refinement.solve({.r2 = a.data()}, f.data(), Accuracy::full(), {100}, correct, work.data());
  const bool certain = !refinement.invertible().ok() ? r.error_bound == -1 : r.error_bound == 2 * unit_roundoff<double>;
  return r.ok() && r.iterations == 1 && certain && f.isZero(0) ? "" : "the answer to zero";
}

std::string calls_wrong(const Case& c, const std::vector<Asked>& calls) {
  const Model model(c);
  Refinement<double> refinement;
  refinement.analyze(c.problem.structure);
  refinement.update(c.problem);
  if (!refinement.factor_mass().ok()) return "update on " + c.label;
  refinement.update_damping(c.damping);
  Workspace<double> work(refinement.workspace(0));
  work.fill(std::numeric_limits<double>::quiet_NaN());
  for (const Asked& asked : calls) {
    // Without a certificate it goes on to the end, where rounding of the slower part hides how fast the other one is.
    if (!refinement.invertible().ok() && asked.wanted > 0 && asked.motion != asked.force) continue;
    const std::string words = differs(model, refinement, asked, work);
    if (!words.empty()) return "Refinement, call " + std::to_string(&asked - calls.data()) + ", " + words + " on " + c.label;
  }
  const std::string words = zero_missed(model, refinement, work);
  return words.empty() ? not_finite_missed(model, refinement, work) : words;
}

}  // namespace

std::string refinement_wrong(const Case& c) {
  const std::vector<Asked> calls = {{0.55, 0.55}, {0.3, 0.3}, {0.7, 0.7}, {0, 0}, {0.55, 0.55, 0, 100, true}, {0.7, 0.7, 0, 200, true}, {0.3, 0.3, 0, 100, true},
                         {0.55, 0.55, 1e-3}, {0.125, 0.25, 1e-7}, {0.5, 0.125, 1e-5}, {0.55, 0.55, 1e-30}, {0.5, 0.25, 0, 3}, {0.125, 0.5, 1e-9, 3}, {0.5, 0.5, 0, 0},
                         {-2, -2}, {-2, -2, 0, 1}, {0.7, 0.55}, {0.25, 0.25, std::numeric_limits<double>::infinity()}, {0, 1e-8}, {1e-8, 1e-8}, {1.2e-8, 1.2e-8, 0, 1}};
  std::string words;
  for (const double softer : {1.0, 0x1p10}) {
    Case soft = make_case(c.problem, c.damping, c.label + (softer > 1 ? ", softer" : ""), c.seed);
    for (double& d : soft.damping.diagonal) d *= softer;
    for (auto& b : soft.damping.blocks) b.R_inverse *= softer;
    if (words.empty()) words = calls_wrong(soft, calls);
  }
  return words;
}

namespace {

constexpr Index bodies = 5, unseen = 2 * bodies - 1;

/// Bodies of two freedoms on the axes of their frames, M = mass I for the first, hardly anything for the others, and a row
/// of damping 1 along the first freedom.
Problem<double> sliders(double mass, double others = 0x1p-100) {
  Structure s;
  for (Index body = 0; body < bodies; ++body) s.add_body(ground, 2);
  s.add_link_constraint(1, {0});
  Problem<double> p(std::make_shared<const Structure>(std::move(s)));
  for (auto& H : p.H) H.diagonal().setConstant(&H == p.H.data() ? mass : others);
  for (std::size_t c = 0; c < p.S.size(); ++c) p.S[c][static_cast<Index>(c % 2)] = 1;
  p.K[0][0] = 1;
  return p;
}

void analyze_and_update(Refinement<double>& r, const Problem<double>& p, Refinement<double>::Mass mass) {
  r.analyze(p.structure, mass);
  r.update(p);
  r.update_damping(Damping<double>::uniform(p.structure->rows, 1));
}

/// Corrections of the freedom with the row, of the last one, and of the force.
struct Scripted {
  double motion, stray, force;
};

/// Corrections of the sliders as written, then zeros, to λ = 1/2: whether it takes so many of them.
std::string steps_wrong(const std::vector<Scripted>& script, bool patient, int steps) {
  Refinement<double> refinement;
  analyze_and_update(refinement, sliders(1, 0x1p-160), Refinement<double>::Mass::factored_here);
  Workspace<double> work(refinement.workspace(0));
  const double a = 1;
  double f = 0;
  std::size_t calls = 0;
  const auto correct = [&](const double*, const double*, double* d_nu, double* d_lambda, double*) {
    const Scripted now = calls < script.size() ? script[calls] : Scripted{};
    ++calls;
    d_nu[0] = now.motion;
    d_nu[unseen] = now.stray;
    *d_lambda = now.force;
  };
  const Report r = refinement.solve({.r2 = &a}, &f, Accuracy::full(), {100, patient}, correct, work.data());
  return r.ok() && r.iterations == steps && f == 0.5 ? "" : "Refinement: corrections of ν alone, " + std::to_string(r.iterations) + " steps";
}

/// τᵀM⁻¹τ for τ = 1, after M is factored if it has to be.
double energy_of_ones(const Refinement<double>& refinement, Index freedoms) {
  Workspace<double> tau(padded(freedoms)), work(refinement.factor_M().solve_workspace());
  std::fill_n(tau.data(), freedoms, 1.0);
  return refinement.factor_mass().ok() ? refinement.factor_M().energy(tau.data(), work.data()) : -1;
}

std::string threads_wrong(const Problem<double>& p) {
  Refinement<double> refinement;
  analyze_and_update(refinement, p, Refinement<double>::Mass::factored_here);
  const Index n = p.structure->dofs();
  const double expected = energy_of_ones(refinement, n);
  for (int round = 0; round < 20; ++round) {
    refinement.update(p);
    std::atomic<int> ready = 0, wrong = 0;
    const auto ask = [&] {
      for (++ready; ready < 2;) std::this_thread::yield();
      for (int k = 0; k < 20; ++k) wrong += energy_of_ones(refinement, n) != expected;
    };
    std::thread other(ask);
    ask();
    other.join();
    if (wrong > 0) return "Refinement: another energy on two threads";
  }
  return {};
}

std::string sizes_wrong(const Problem<double>& p) {
  Refinement<double> here, elsewhere;
  analyze_and_update(here, p, Refinement<double>::Mass::factored_here);
  analyze_and_update(elsewhere, p, Refinement<double>::Mass::factored_elsewhere);
  KktResidual<double> residual;
  residual.analyze(p.structure);
  const Index own = 4 * padded(p.structure->dofs()) + 7 * padded(p.structure->rows);
  for (const Index correction : {Index(0), Index(1000000)})
    if (here.workspace(correction) != own + std::max({here.factor_M().solve_workspace(), residual.workspace(), correction}) ||
        elsewhere.workspace(correction) != own + std::max(residual.workspace(), correction))
      return "Refinement: workspace";
  return elsewhere.factor_mass().ok() && (p.structure->dofs() == 0 || elsewhere.bytes() < here.bytes()) ? "" : "Refinement: bytes";
}

std::string lost_pivot_wrong() {
  Refinement<double> refinement;
  const double a = 1;
  double f = 0;
  const auto correct = [](const double*, const double* r2, double* d_nu, double* d_lambda, double*) { d_nu[0] = d_lambda[0] = r2[0] / 2; };
  analyze_and_update(refinement, sliders(1), Refinement<double>::Mass::factored_here);
  Workspace<double> work(refinement.workspace(0));
  for (const double mass : {1, 0, 0, 1}) {
    refinement.update(sliders(mass));
    const Status expected = mass > 0 ? Status::ok : Status::lost_pivot;
    for (const double wanted : {Accuracy::fastest().error, 1.0, 1.0}) {
      const Report r = refinement.solve({.r2 = &a}, &f, {wanted}, {0}, correct, work.data());
      if (wanted > 1 ? !r.ok() : r.status != expected || (r.ok() && r.error_bound != 2 * unit_roundoff<double>))
        return "Refinement: " + std::string(name(r.status)) + " with a mass of " + std::to_string(mass);
    }
  }
  return {};
}

}  // namespace

std::string stray_motion_wrong() {
  const std::string words[] = {steps_wrong({{0.5, 0, 0.375}, {0, 0, 0.125}, {1e-30, 0, 0}}, false, 2),
                               steps_wrong({{0.5, 0, 0.375}, {0, 0, 0.125}, {1e-30, 0, 0}}, true, 2),
                               steps_wrong({{0.5, 0, 0.5 - 0x1p-30}, {0, 0.25, 0}, {0, -0.25, 0x1p-30}}, false, 3),
                               steps_wrong({{0.5, 0, 0.375}, {0, 0.25, 0}, {0, 0, 0.125}}, true, 3),  // 0 by luck, with R r₂ = 1/8
                               steps_wrong({{0.5, 0x1p10, 0.5 - 0x1p-30}, {0, -0x1p-16, 0x1p-30}}, false, 1)};
  return *std::max_element(std::begin(words), std::end(words));
}

std::string factored_mass_wrong() {
  const Problem<double> none(std::make_shared<const Structure>());
  const Problem<double> chain = generators::build(generators::find_family("chain").make(200, 1)).problem;
  for (const std::string& words : {sizes_wrong(none), sizes_wrong(chain), lost_pivot_wrong(), threads_wrong(chain)})
    if (!words.empty()) return words;
  return {};
}

}  // namespace delassus::laws
