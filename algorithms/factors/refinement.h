// Refinement on the KKT residual, and its certificate: what every solve that keeps its promise of accuracy shares.
//
// What     from a correction (δν, δλ) ≈ solution of
//            M δν − Jᵀδλ = r₁,   J δν + R⁻¹δλ = r₂                                                     (K)
//          ν += δν, λ += δλ with the residual (r₁, r₂) of kkt_residual.h, until nothing is left to gain. Any solve of (K)
//          serves: the inversion lemma, a QR factor, a dense one, one in float, one at another damping.
// How      ν and λ are carried as Wide<T>. A correction measures the error before it: in the energy norm
//            ‖δν‖²_M + ‖δλ‖²_{R⁻¹} = r₁ᵀδν + r₂ᵀδλ,   relative to νᵀr₁⁰ + λᵀr₂⁰ of the right-hand side asked for,
//          and per row, relative to the largest force. Its own relative error ρ is about how much smaller it is than the
//          correction before it (the largest of the ratios of ν, λ and energy); of δλ = R (r₂ − J δν) it leaves ρ |R r₂|,
//          and all that further corrections would bring is ρ/(1 − ρ) of it. Steps end when that is below eps; where rows are
//          hard, when moreover the correction itself is below 4 eps. The first correction is compared with the solution, and the
//          largest force may hide the rows that converge slowly: it ends the steps only when it is itself below 4 eps, or when
//          the certificate below leaves no row more than eps of the largest force, √R_rr B ≤ eps max|λ|. Those of a patient correction, which is fast in most
//          directions and slow in some, when it is below eps itself, and ρ of the one before it or |R r₂| is, too: of a row whose
//          r₂ and J δν cancel it may be 0 by luck, with R r₂ left. Two corrections in a row as large as half the solution
//          are divergence: not_converged. So is the last step allowed, unless neither certificate nor last correction is above 8 eps,
//          or what the certificate leaves a row, √R_rr B / max|λ|, is below 4 eps: then no step would add a digit.
// Certificate  B² = r₁ᵀM⁻¹r₁ + r₂ᵀR r₂ ≥ ‖δν‖²_M + ‖δλ‖²_{R⁻¹} for the final iterate (the symmetric part of (K) is
//          diag(M, R⁻¹)), by one backward sweep of the factor of M; hence |δλ_r| ≤ √R_rr B, and ‖δλ‖_A ≤ B for λ alone
//          (A δλ = r₂ − J M⁻¹r₁). error_bound is B relative to the energy norm of the solution, √(νᵀr₁⁰ + λᵀr₂⁰), plus 2 eps for
//          rounding. The solution's energy is at least e with e (e + B) = s, s that of the iterate: so, with t = B/√s,
//          error_bound = t (t + √(t² + 4)) / 2, infinite where s ≤ 0. r₁ and r₂ are scaled by powers of two, each to a largest
//          entry of about one, before they are squared; where even so a square is lost, error_bound is infinite.
//          An answer whose bound is above what was wanted, or above √eps when all digits were, is not_converged.
//          B itself is evaluated to a relative eps κ, κ of M and of the blocks of R⁻¹ with unit diagonal.
// Hard rows, R⁻¹ = 0: from (K), ‖δν‖²_M + ‖δλ‖²_{R⁻¹} ≤ r₁ᵀM⁻¹r₁ + r₂ᵀA⁻¹r₂ and ‖δλ‖_A ≤ B = √(r₁ᵀM⁻¹r₁) + √(r₂ᵀA⁻¹r₂). Whoever
//          has a factor of A gives a bound on r₂ᵀA⁻¹r₂ (kkt_elimination.h). Nobody else has a bound: error_bound is −1, and
//          an accuracy is reached when what further corrections would bring, judged by the last one, is below it.
//          Rounding the iterate to T when it is returned adds up to eps √(|λ|ᵀ|A||λ|), more than eps where forces cancel.
// Cost     per step one residual in Wide<T> and one solve of (K); at the end one residual in T and half a sweep.
// Workspace  4 n + 7 m, the residual's or the correction's.
// Source   N. Higham, Accuracy and Stability of Numerical Algorithms, chapter 12.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>

#include "algorithms/factors/factor.h"
#include "algorithms/factors/kkt_residual.h"
#include "algorithms/kit/columns.h"
#include "algorithms/kit/vectors.h"

namespace delassus {

template <class T> class Refinement {
 public:
  using W = Wide<T>;

  /// Who factors M for the certificate: this class, or whoever gives solve_with the energy.
  enum class Mass : std::uint8_t { factored_here, factored_elsewhere };

  void analyze(std::shared_ptr<const Structure> structure, Mass mass = Mass::factored_here);
  /// M is factored here, beside a factor of M_R made with `plan`, which is started before each update and takes rows that move first.
  void analyze(std::shared_ptr<const Structure> structure, const Plan& plan, const Factor<T>& of_M_R);
  void update(const Problem<T>& problem);
  /// Rows that moved; the factor of M is kept.
  void update_rows(const Problem<T>& problem);
  void update_damping(const Damping<T>& damping);

  /// What update was given; `to` has the structure and the sizes.
  void numbers(Problem<T>& to) const { residual_.numbers(to); }
  /// R, or in what row it does not exist.
  [[nodiscard]] const BlockDiagonal<T>& weights() const { return weights_; }
  [[nodiscard]] const Report& invertible() const { return invertible_; }
  /// Factors M where that is done here, once after an update: at the first call, which solve makes when a certificate is asked
  /// for. Threads wait for the one that does it. Report: lost_pivot.
  [[nodiscard]] Report factor_mass() const;
  /// The factor of M, after factor_mass.
  [[nodiscard]] const Factor<T>& factor_M() const { return factor_M_; }

  struct NoBound {
    template <class X> std::optional<X> operator()(const X*, X*) const { return std::nullopt; }
  };
  struct Steps {
    int most;
    bool patient = false;
  };
  /// What is asked: (K) with these right-hand sides, r1 (n, nullptr: zero) and r2 (m), from the pair given, or from zero.
  template <class X> struct AskedOf {
    const X *r1 = nullptr, *r2 = nullptr;
    const X *nu = nullptr, *lambda = nullptr;  // both, or none
  };
  using Asked = AskedOf<T>;
  /// f = λ of the (ν, λ) asked for (m). `correct(r1, r2, d_nu, d_lambda, work)` solves (K)
  /// approximately, r1 = nullptr meaning zero; `work` needs workspace(the correction's) scalars. nu, when given, receives ν (n).
  /// Report: iterations (corrections after the first evaluation), error_bound, error_estimate; not_converged when the
  /// accuracy was not reached, with the iterate it came to; not_finite; lost_pivot of M. `at_rows(r2, scratch)`, asked where R⁻¹
  /// has a zero, is a bound on r₂ᵀA⁻¹r₂, or none; scratch is m.
  template <class Correct, class AtRows = NoBound>
  Report solve(const Asked& asked, T* f, Accuracy wanted, Steps steps, const Correct& correct, T* work, T* nu = nullptr,
               const AtRows& at_rows = {}) const {
    if (std::isfinite(wanted.error))
      if (const Report factored = factor_mass(); !factored.ok()) return factored;
    const auto energy = [this](const T* tau, T* rest) { return factor_M_.energy(tau, rest); };
    return solve_with(asked, f, wanted, steps, correct, energy, work, nu, at_rows);
  }
  /// The same with `energy(τ, work)` = τᵀM⁻¹τ.
  template <class Correct, class Energy, class AtRows = NoBound>
  Report solve_with(const Asked& asked, T* f, Accuracy wanted, Steps steps, const Correct& correct, const Energy& energy, T* work,
                    T* nu = nullptr, const AtRows& at_rows = {}) const {
    Report report;
    solve_each(asked, {f, 0, nu}, 1, wanted, steps, correct, energy, work, &report, at_rows);
    return report;
  }
  /// `count` columns side by side, λ of the next one `stride` further: each takes the steps it needs, as if it were alone.
  /// `correct` and `work` as above, with lanes for scalars; a report of each.
  template <class Correct>
  void solve_lanes(const Lanes<T>* r2, T* f, Index stride, int count, Accuracy wanted, Steps steps, const Correct& correct,
                   Lanes<T>* work, Report* reports) const {
    const auto energy = [this](const Lanes<T>* tau, Lanes<T>* rest) { return factor_M_.energy(tau, rest); };
    if (const Report factored = std::isfinite(wanted.error) ? factor_mass() : Report{}; !factored.ok()) std::fill_n(reports, count, factored);
    else solve_each(AskedOf<Lanes<T>>{.r2 = r2}, {f, stride}, count, wanted, steps, correct, energy, work, reports, NoBound{});
  }

  /// r₁ = Jᵀλ − M ν and r₂ = a − J ν − R⁻¹λ in T. Shapes n, m, m, n, m; `work` as for solve without its vectors.
  void residual(const T* nu, const T* lambda, const T* a, T* r1, T* r2, T* work) const {
    residual_.template evaluate<T, T>(nu, lambda, nullptr, a, r1, r2, work);
  }
  [[nodiscard]] Index workspace(Index of_correction) const;
  [[nodiscard]] Index bytes() const;

 private:
  template <class X> struct Buffers;
  /// Where products of two floats may leave the range of float.
  using Products = std::conditional_t<std::is_same_v<T, float>, double, T>;
  template <class X> using ProductsOf = std::conditional_t<std::is_same_v<X, T>, Products, X>;
  struct Progress {
    double size = 1;      // of the last correction, relative: the error before it
    double expected = 1;  // of the next one: the error now
    double patient = 1;   // the same if corrections are slow in directions that this one does not show
    double energy = 1, motion = 0, force = 0;  // of the last one: in the energy norm, max|δν|, max|δλ|
  };
  /// The certificate says so; where there is none, the last correction.
  static bool enough(const Report& r, const Progress& now, double wanted) {
    return r.error_bound >= 0 ? r.error_bound <= wanted : r.iterations > 0 && wanted > 0 && now.patient <= wanted;
  }
  /// B relative to the solution, −1: none; and √R_rr B of the row where it is largest, relative to the largest force.
  struct Certificate {
    double relative = -1, at_a_row = std::numeric_limits<double>::infinity();
  };
  /// Nothing left to gain.
  static bool at_rounding(const Report& r, const Certificate& c) {
    const bool correction = r.error_estimate >= 0 && r.error_estimate <= 8 * unit_roundoff<T>;
    return r.error_bound <= 8 * unit_roundoff<T> && (correction || c.at_a_row <= 4 * unit_roundoff<T>);
  }
  /// Whether ρ, or what does not depend on it, was seen in all rows.
  static bool shown(const Report& r, const Progress& now, const Certificate& c) {
    return r.iterations != 1 || now.size <= 4 * unit_roundoff<T> || c.at_a_row <= unit_roundoff<T>;
  }
  /// One column of those side by side; `open` until it is finished.
  struct Column {
    Report report;
    Progress now, before;
    Certificate certificate;
    bool open = true;
  };
  struct Answers {
    T* f;
    Index stride;  // of f
    T* nu = nullptr;
  };
  template <class X> using Columns = std::array<Column, columns_in<X>>;
  template <class X, class Correct, class Energy, class AtRows>
  void solve_each(const AskedOf<X>& asked, const Answers& to, int count, Accuracy wanted, Steps steps, const Correct& correct,
                  const Energy& energy, X* work, Report* reports, const AtRows& at_rows) const;

  /// νᵀr₁⁰ + λᵀr₂⁰ of the iterate
  template <class X> static ProductsOf<X> energy_of(const Buffers<X>& b);
  template <class X> void start(Buffers<X>& b, Columns<X>& columns) const;
  template <class X> void advance(Buffers<X>& b, Columns<X>& columns) const;
  /// The pair given becomes the iterate.
  template <class X> static void take(Buffers<X>& b, const AskedOf<X>& asked);
  template <class X> static void finish(const Buffers<X>& b, Column& column, int l, Accuracy wanted, const Answers& to);
  /// Overwrites the correction.
  template <class X, class Energy, class AtRows>
  void certify(Buffers<X>& b, Columns<X>& columns, const Energy& energy, const AtRows& at_rows) const {
    const auto of_r1 = scale(b.r1, b.d_nu, b.n), of_r2 = scale(b.r2, b.d_lambda, b.m);
    const std::optional<X> rows = invertible_.ok() ? soft_rows(b) : at_rows(b.d_lambda, b.scratch);
    if (rows) bound(b, {energy(b.d_nu, b.rest), of_r1}, Square<X>{*rows, of_r2}, columns);
    else
      for (Column& c : columns) c.certificate = {};
  }
  /// to = 2^(−e) from, of a largest magnitude between ½ and 1. Returns e; 0 where the scalar is exact or all is zero.
  template <class X> static std::array<int, columns_in<X>> scale(const X* from, X* to, Index n);
  template <class X> struct Square {
    X value;
    std::array<int, columns_in<X>> exponent;  // of its root
  };
  template <class X> std::optional<X> soft_rows(Buffers<X>& b) const;
  template <class X> void bound(const Buffers<X>& b, const Square<X>& motion, const Square<X>& rows, Columns<X>& columns) const;

  std::shared_ptr<const Structure> structure_;
  KktResidual<T> residual_;
  Mass mass_ = Mass::factored_here;
  bool beside_ = false;  // a factor of M_R
  Plan plan_M_;
  mutable Factor<T> factor_M_;
  mutable Report factored_M_;
  mutable std::atomic<bool> M_is_current_ = true;
  mutable std::mutex factoring_M_;
  BlockDiagonal<T> weights_;
  Report invertible_;
  double stiffest_ = 0;  // max √R_rr
};

// One column's vectors, or lanes of several, zero up to their padded ends; Wide ones first, so that everything stays aligned.
template <class T> template <class X> struct Refinement<T>::Buffers {
  using WX = Wide<X>;
  static constexpr Index wide = static_cast<Index>(sizeof(WX) / sizeof(X));
  Index n, m;
  WX *nu, *lambda;
  const X* r1_0;  // the right-hand sides
  X *a, *f;       // … and λ rounded to X
  X *d_nu, *r1, *d_lambda, *r2, *scratch;
  X* rest;

  Buffers(const Structure& s, const AskedOf<X>& asked, X* work) : n(s.dofs()), m(s.rows), r1_0(asked.r1) {
    nu = reinterpret_cast<WX*>(work);
    lambda = reinterpret_cast<WX*>(work += wide * padded(n));
    X* const narrow_ones = work += wide * padded(m);
    for (X** x : {&d_nu, &r1}) *x = work, work += padded(n);
    for (X** x : {&a, &f, &d_lambda, &r2, &scratch}) *x = work, work += padded(m);
    rest = work;
    std::fill(narrow_ones, rest, X{});
    if (r1_0 != nullptr) std::copy(r1_0, r1_0 + n, r1);
    std::copy(asked.r2, asked.r2 + m, a);
    std::copy(asked.r2, asked.r2 + m, r2);
  }
  static Index size(const Structure& s) { return (wide + 2) * padded(s.dofs()) + (wide + 5) * padded(s.rows); }
};

template <class T>
template <class X, class Correct, class Energy, class AtRows>
void Refinement<T>::solve_each(const AskedOf<X>& asked, const Answers& to, int count, Accuracy wanted, Steps steps, const Correct& correct,
                               const Energy& energy, X* work, Report* reports, const AtRows& at_rows) const {
  Buffers<X> b(*structure_, asked, work);
  residual_.damping().switch_off(b.a);
  residual_.damping().switch_off(b.r2);
  Columns<X> columns;
  int open = count;
  const auto each = [&](const auto& f) {
    for (int l = 0; l < count; ++l)
      if (columns[l].open) f(columns[l], l);
  };
  const auto close = [&](Column& c, int l) {
    finish(b, c, l, wanted, to);
    reports[l] = c.report;
    --open;
  };
  const auto residual = [&] { residual_.evaluate(b.nu, b.lambda, b.r1_0, b.a, b.r1, b.r2, b.rest); };
  if (asked.nu != nullptr) {  // what the pair given leaves
    take(b, asked);
    residual_.damping().switch_off(b.lambda);
    residual();
    if (wanted.error > 0 && std::isfinite(wanted.error)) certify(b, columns, energy, at_rows);
    each([&](Column& c, int l) {
      c.report.error_bound = c.certificate.relative;
      if (c.report.error_bound >= 0 && c.report.error_bound <= wanted.error) close(c, l);
    });
    if (open == 0) return;
    correct(b.r1, b.r2, b.d_nu, b.d_lambda, b.rest);
    advance(b, columns);
  } else {
    correct(b.r1_0, b.r2, b.d_nu, b.d_lambda, b.rest);
    start(b, columns);
  }
  each([](Column& c, int) { c.before = c.now; });
  const auto close_ended = [&] {
    each([&](Column& c, int l) {
      if (!std::isfinite(c.now.size) || !std::isfinite(wanted.error)) close(c, l);
    });
  };
  for (close_ended(); open > 0; close_ended()) {
    const auto is_done = [&](const Column& c) { return (steps.patient ? c.now.patient : c.now.expected) <= unit_roundoff<T>; };
    int done = 0;
    each([&](Column& c, int) { done += is_done(c); });
    // ‖δ‖ < √eps of the solution when done: what is left then is as good in T
    const bool in_T = done == open;
    if (in_T) residual_.evaluate(b.d_nu, b.d_lambda, b.r1, b.r2, b.r1, b.r2, b.rest);
    else residual();
    if (done > 0 || wanted.error > 0) certify(b, columns, energy, at_rows);
    each([&](Column& c, int l) {
      const bool certified = is_done(c) || wanted.error > 0;
      if (certified) c.report.error_bound = c.certificate.relative;
      if ((is_done(c) && shown(c.report, c.now, c.certificate)) || enough(c.report, c.now, wanted.error)) close(c, l);
    });
    if (open == 0) break;
    if (in_T) residual();
    const auto is_last = [&](const Column& c) {
      const bool diverges = c.report.iterations >= 2 && c.now.size >= 0.5 && c.before.size >= 0.5;
      return c.report.iterations >= std::min(steps.most, wanted.steps) || diverges;
    };
    int last = 0;
    each([&](Column& c, int) { last += is_last(c); });
    if (last > 0) certify(b, columns, energy, at_rows);
    each([&](Column& c, int l) {
      if (!is_last(c)) return;
      c.report.error_bound = c.certificate.relative;
      if (wanted.error > 0 || !at_rounding(c.report, c.certificate)) c.report.status = Status::not_converged;
      close(c, l);
    });
    if (open == 0) break;
    correct(b.r1, b.r2, b.d_nu, b.d_lambda, b.rest);
    each([](Column& c, int) { ++c.report.iterations, c.before = c.now; });
    advance(b, columns);
    each([](Column& c, int) { c.report.error_estimate = c.now.size; });
  }
}

template <class T>
template <class X>
void Refinement<T>::finish(const Buffers<X>& b, Column& column, int l, Accuracy wanted, const Answers& to) {
  Report& report = column.report;
  if (!std::isfinite(column.now.size)) report.status = Status::not_finite;
  if (report.ok() && report.error_bound > (wanted.error > 0 ? wanted.error : std::sqrt(unit_roundoff<T>))) report.status = Status::not_converged;
  T* const f = to.f + l * to.stride;
  for (Index r = 0; r < b.m; ++r) f[r] = lane(b.f[r], l);
  if constexpr (std::is_same_v<X, T>)
    for (Index c = 0; c < b.n && to.nu != nullptr; ++c) to.nu[c] = narrow<T>(b.nu[c]);
  column.open = false;
}

}  // namespace delassus
