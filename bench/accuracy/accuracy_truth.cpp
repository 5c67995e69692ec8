#include "algorithms/kit/test_scalars.h"
#include "bench/accuracy/accuracy_truth.h"

#include <algorithm>
#include <cmath>

#include "algorithms/delassus.h"
#include "algorithms/factors/factor.h"
#include "algorithms/factors/kkt_residual.h"
#include "generators/random.h"
#include "reference/sensitivity.h"

namespace delassus::accuracy {

namespace {

constexpr Index most_dofs = 100, most_rows = 150;  // of the definition in Quad

// Norms stay in Quad: in double the squares of forces below 1e-154 N are zero.
Quad dot(const VectorX<Quad>& x, const VectorX<Quad>& y) {
  Quad sum(0);
  for (Index i = 0; i < x.size(); ++i) sum += x[i] * y[i];
  return sum;
}
Quad norm(const VectorX<Quad>& x) { return sqrt(dot(x, x)); }
Quad largest(const VectorX<Quad>& x) {
  Quad most(0);
  for (const Quad& e : x) most = std::max(most, abs(e));
  return most;
}
bool all_finite(const VectorX<Quad>& x) {
  return std::all_of(x.begin(), x.end(), [](const Quad& e) { return isfinite(e); });
}
double relative(const Quad& error, const Quad& to) { return error == Quad(0) ? 0 : static_cast<double>(error / to); }

VectorX<Quad> zeros(Index n) { return VectorX<Quad>::Constant(n, Quad(0)); }

double largest_damping(const Damping<double>& damping) {
  double most = 0;
  for (const double d : damping.diagonal) most = std::max(most, d);
  for (const auto& block : damping.blocks) most = std::max(most, block.R_inverse.trace());
  return most;
}

bool has_hard_rows(const Structure& s, const Damping<double>& damping) {
  BlockDiagonal<double> inverse;
  inverse.analyze(s);
  return !inverse.assign_inverse(damping).ok();
}

/// The largest eigenvalue of the symmetric positive matrix `multiply(x, y)` applies; a few per cent low at most; NaN when it fails.
template <class Multiply> double power_iteration(Index m, const Multiply& multiply) {
  MatrixX<double> x(random_acceleration(m, 1)), y(m, 1);
  double eigenvalue = 0;
  for (int k = 0; k < 50; ++k) {
    x /= x.norm();
    if (!multiply(x, y)) return std::nan("");
    eigenvalue = y.norm();
    if (!(eigenvalue > 0)) break;
    x.swap(y);
  }
  return eigenvalue;
}

/// Of A, or of A⁻¹, by an operator in double.
double largest_of(const char* name, bool inverse, const Problem<double>& problem, const Damping<double>& damping) {
  const auto op = find_operator(name).make<double>();
  op->analyze(problem.structure);
  if (!op->update(problem, damping).ok()) return std::nan("");
  Workspace<double> workspace(op->workspace());
  return power_iteration(problem.structure->rows, [&](const MatrixX<double>& x, MatrixX<double>& y) {
    return (inverse ? op->solve(x, y, workspace) : op->apply(x, y, workspace)).ok();
  });
}

}  // namespace

/// The problem in Quad, the factor of its M, and its residual.
struct Truth::System {
  Problem<Quad> problem;
  Damping<Quad> damping;
  Plan plan;
  Factor<Quad> M;
  KktResidual<Quad> residual;
  double norm = 0;  // ‖A‖, an upper bound but for that of the power iteration

  System(const Problem<double>& p, const Damping<double>& d) : problem(p.cast<Quad>()), damping(d.cast<Quad>()) {
    plan = make_plan(*problem.structure, Matrix::M, Branches::all);
    M.analyze(*problem.structure, plan);
    const Report started = M.start(problem);
    const Report factored = started.ok() ? M.update_undamped() : started;
    if (!factored.ok()) throw std::runtime_error("accuracy: M is singular at degree of freedom " + std::to_string(factored.where));
    residual.analyze(problem.structure);
    residual.update(problem);
    residual.update_damping(damping);
  }
  /// r₁ and r₂ of kkt_residual.h.
  struct Residual { VectorX<Quad> r1, r2; };
  [[nodiscard]] Residual evaluate(const VectorX<Quad>& nu, const VectorX<Quad>& lambda, const VectorX<Quad>& a) const {
    Residual r{zeros(nu.size()), zeros(lambda.size())};
    Workspace<Quad> work(residual.workspace());
    residual.evaluate(nu.data(), lambda.data(), static_cast<const Quad*>(nullptr), a.data(), r.r1.data(), r.r2.data(), work.data());
    return r;
  }
  /// ν = M⁻¹Jᵀλ; returns ‖ν‖²_M.
  Quad motion(const VectorX<Quad>& lambda, VectorX<Quad>& nu) const {
    const VectorX<Quad> none = zeros(lambda.size());
    nu = zeros(problem.structure->dofs());
    const VectorX<Quad> force = evaluate(nu, lambda, none).r1;  // Jᵀλ
    VectorX<Quad> rate = none;
    Workspace<Quad> work(M.workspace());
    M.solve(none.data(), force.data(), rate.data(), nu.data(), work.data());
    return M.energy(force.data(), work.data());
  }
};

Truth::Truth(const Problem<double>& problem, const Damping<double>& damping, const VectorX<double>& a)
    : system_(std::make_unique<System>(problem, damping)), a_(a.cast<Quad>()) {
  largest_ = largest_of("aba_sweep", false, problem, Damping<double>::uniform(a.size(), 0));
  system_->norm = largest_ + largest_damping(damping);
  solve();
  compare_with_definition(problem, damping, a);
  if (known()) static_cast<void>(system_->motion(answer_.lambda, answer_.nu));
}

Truth::~Truth() = default;

void Truth::solve() {
  const Index m = a_.size();
  MatrixX<Quad> lambda = MatrixX<Quad>::Constant(m, 1, Quad(0));
  for (const char* name : {"lcaba_refined", "lcaba_qr"}) {
    const auto op = find_operator(name).make<Quad>();
    op->analyze(system_->problem.structure);
    if (!op->update(system_->problem, system_->damping).ok()) continue;
    Workspace<Quad> workspace(op->workspace());
    const Report report = op->solve(MatrixX<Quad>(a_), lambda, workspace);
    if (!(report.error_bound >= 0 && report.error_bound <= worst_bound)) continue;
    bound_ = report.error_bound;
    answer_.lambda = lambda;
    return;
  }
  why_not_ = "no certified reference in Quad";
}

void Truth::compare_with_definition(const Problem<double>& problem, const Damping<double>& damping, const VectorX<double>& a) {
  condition_ = disagreement_ = std::nan("");
  if (problem.structure->dofs() > most_dofs || a.size() > most_rows) {
    condition_ = largest_of("aba_sweep", false, problem, damping) * largest_of("ladder", true, problem, damping);
    return;
  }
  const reference::Sensitivity definition(problem, damping);
  if (!definition.regular()) return;
  condition_ = definition.condition();
  const VectorX<Quad> lambda = definition.solve(a);
  if (known()) {
    disagreement_ = relative(largest(lambda - answer_.lambda), largest(lambda));
  } else if (has_hard_rows(*problem.structure, damping)) {
    answer_.lambda = lambda;
    why_not_.clear();
  }
}

Quad Truth::motion_energy(const VectorX<Quad>& lambda, const VectorX<Quad>& nu) const {
  VectorX<Quad> through_lambda;
  if (nu.size() == 0) return system_->motion(lambda, through_lambda);
  return -dot(nu, system_->evaluate(nu, zeros(lambda.size()), zeros(lambda.size())).r1);
}

Errors Truth::errors_of(const Answer& answer) const {
  const double none = std::nan("");
  if (!known() || !all_finite(answer.lambda) || !all_finite(answer.nu)) return {none, none, none, none};
  const VectorX<Quad> off = answer.lambda - answer_.lambda;
  const bool own_motion = answer.nu.size() > 0;
  const VectorX<Quad> nu_off = own_motion ? VectorX<Quad>(answer.nu - answer_.nu) : VectorX<Quad>();
  const Quad motion = std::max(Quad(0), motion_energy(off, nu_off));
  VectorX<Quad> damped = zeros(off.size());
  system_->damping.multiply(off, damped);
  const Quad force = dot(off, damped);

  Errors e;
  e.lambda = relative(largest(off), largest(answer_.lambda));
  e.motion = relative(sqrt(motion), sqrt(motion_energy(answer_.lambda, answer_.nu)));
  e.energy = relative(sqrt((own_motion ? motion : Quad(0)) + force), sqrt(dot(answer_.lambda, a_)));
  VectorX<Quad> nu;
  static_cast<void>(system_->motion(answer.lambda, nu));
  const VectorX<Quad> rest = system_->evaluate(nu, answer.lambda, a_).r2;
  e.backward = relative(norm(rest), Quad(system_->norm) * norm(answer.lambda) + norm(a_));
  return e;
}

VectorX<double> random_acceleration(Index rows, std::uint64_t seed) {
  generators::Random random(seed);
  VectorX<double> a(rows);
  for (double& e : a) e = random.integer(-1000000, 1000000) / 1e6;
  return a;
}

VectorX<double> consistent_acceleration(const Problem<double>& problem, std::uint64_t seed) {
  const Structure& s = *problem.structure;
  KktResidual<Quad> residual;
  residual.analyze(problem.structure);
  residual.update(problem.cast<Quad>());
  residual.update_damping(Damping<Quad>::uniform(s.rows, Quad(0)));
  const VectorX<double> nu = 0.1 * random_acceleration(s.dofs(), seed);
  const VectorX<Quad> wide = nu.cast<Quad>(), none = zeros(s.rows);
  VectorX<Quad> r1 = zeros(s.dofs()), r2 = zeros(s.rows);
  Workspace<Quad> work(residual.workspace());
  residual.evaluate(wide.data(), none.data(), static_cast<const Quad*>(nullptr), none.data(), r1.data(), r2.data(), work.data());
  VectorX<double> a(s.rows);
  for (Index r = 0; r < s.rows; ++r) a[r] = -static_cast<double>(r2[r]);
  return a;
}

}  // namespace delassus::accuracy
