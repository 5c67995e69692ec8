// Identities between routes at thousands of bodies, exactly: in the integers modulo p = 2⁶¹ − 1.
//
//   round trip            V_R (A x) = x
//   symmetric             xᵀ A y = (A x)ᵀ y
//   relabelled            A x and V_R x with bodies renumbered
//   joint rows as links   A x and V_R x with 𝒦_i as K blocks on i and π(i)
//   armature as rows      V_R x with armature as rows of R = armature
//
// Every number of S, H, K, 𝒦, armature, R⁻¹ and x is drawn from all of the field: the identities are between rational
// functions of these numbers, and no positivity enters them.
//
// What equality proves. A x = a is equivalent to one linear system in the body motions and forces, joint velocities and
// rows, U = 12 N + n + m unknowns, whose coefficients are the drawn numbers themselves. By Cramer's rule every entry of
// A x and of V_R a is a quotient of two polynomials of degree U + 1 at most. An operator that solves a wrong system of
// this form exactly (a block that is missing, misplaced, transposed, of wrong sign) has quotients of the same degree.
// The difference of the two sides has a numerator of degree d ≤ 2 (U + 1) + 1 (round trip: one quotient inside another,
// less x); for a difference that is not identically zero, a random point is a zero with probability d/p at most
// (Schwartz, Zippel). An operator that is wrong without solving any such system may double its degree at every step that
// depends on the one before: d ≤ 2^(2 + depth), which proves nothing beyond some fifty dependent steps.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "algorithms/delassus.h"
#include "generators/build.h"
#include "generators/draft.h"
#include "generators/families.h"
#include "property_tests/variants.h"

namespace {

using namespace delassus;
using laws::Variant;
using F = PrimeField;
using Matrix = MatrixX<F>;

F drawn(generators::Random& r) { return F::from(r.next() % F::p); }

Matrix drawn(generators::Random& r, Index rows, Index columns) {
  return Matrix::NullaryExpr(rows, columns, [&](Index, Index) { return drawn(r); });
}

/// The structure of a spec with numbers from all of the field.
Variant<F> drawn(const generators::Spec& spec, std::uint64_t seed) {
  const generators::Built built = generators::build(spec);
  generators::Random r(seed);
  Variant<F> out{Problem<F>(built.problem.structure), {}};
  for (auto& s : out.problem.S) s = drawn(r, 6, 1);
  for (auto& k : out.problem.K) k = drawn(r, 6, 1);
  for (F& k : out.problem.joint_K) k = drawn(r);
  for (auto& H : out.problem.H) {
    const Matrix half = drawn(r, 6, 6);
    H = half + half.transpose();
  }
  for (std::size_t k = 0; k < out.problem.armature.size(); ++k)  // of every third joint
    if (k % 3 == 0) out.problem.armature[k] = drawn(r);
  for (Index row = 0; row < built.problem.structure->rows; ++row) out.damping.diagonal.push_back(drawn(r));
  return out;
}

generators::Spec family(const char* name, Index n) { return generators::find_family(name).make(n, 1); }

/// A random tree of every joint kind in which every fourth body closes a loop with one of those just before it.
generators::Spec looped_tree(Index n) {
  generators::Draft d("looped_tree", 1);
  for (Index k = 0; k < n; ++k) d.any_body(k == 0 ? -1 : std::max<Index>(0, d.last() - d.random.integer(0, 3)));
  for (Index k = 4; k < n; k += 4) d.link(generators::ConstraintKind::generic, {k, k - d.random.integer(1, 4)}).rows = 2;
  for (Index k = 0; k < n; k += 5) d.joint_rows(k);
  d.damp(generators::DampingKind::rows, 0, 0);
  return d.spec;
}

/// Humanoids of 26 bodies in a row, each holding the next by the hand.
generators::Spec crowd(Index count) {
  generators::Spec all = family("humanoid", 26);
  const generators::Spec one = all;
  const auto size = static_cast<Index>(one.bodies.size());
  for (Index k = 1; k < count; ++k) {
    const Index shift = k * size;
    for (auto b : one.bodies) {
      b.parent = b.parent < 0 ? b.parent : b.parent + shift;
      all.bodies.push_back(b);
    }
    for (auto c : one.links) {
      for (Index& b : c.bodies) b += shift;
      all.links.push_back(c);
    }
    for (auto c : one.joints) {
      c.body += shift;
      all.joints.push_back(c);
    }
    auto grip = one.links.back();
    grip.kind = generators::ConstraintKind::point;
    grip.bodies = {shift - 1, shift + size - 1};
    all.links.push_back(grip);
  }
  return all;
}

/// An operator prepared on a problem.
class Prepared {
 public:
  Prepared(const OperatorRow& row, const Variant<F>& v) : name_(row.name), op_(row.make<F>()) {
    op_->analyze(v.problem.structure);
    expect(op_->update(v.problem, v.damping));
  }
  [[nodiscard]] Matrix apply(const Matrix& x) const { return answer(x, &Operator<F>::apply); }
  [[nodiscard]] Matrix solve(const Matrix& x) const { return answer(x, &Operator<F>::solve); }

 private:
  using Phase = Report (Operator<F>::*)(ConstRef<F>, Ref<F>, Workspace<F>&) const;
  [[nodiscard]] Matrix answer(const Matrix& x, Phase phase) const {
    Workspace<F> w(op_->workspace(x.cols()));
    Matrix y(x.rows(), x.cols());
    expect(((*op_).*phase)(x, y, w));
    return y;
  }
  void expect(const Report& r) const {
    if (!r.ok()) throw std::runtime_error(std::string(name_) + ": " + std::string(delassus::name(r.status)));
  }
  std::string_view name_;
  std::unique_ptr<Operator<F>> op_;
};

Matrix appended_zeros(const Matrix& x, Index rows) {
  Matrix out = Matrix::Zero(rows, x.cols());
  out.topRows(x.rows()) = x;
  return out;
}

/// The identities that fail. `second` is what the other side of each is computed from: the same numbers, or a defect.
std::string broken(const OperatorRow& solver, const Variant<F>& v, const Variant<F>& second) {
  const OperatorRow& sweep = find_operator("aba_sweep");
  const Prepared A(sweep, v), V(solver, v);
  generators::Random r(7);
  const Index m = v.problem.structure->rows;
  const Matrix x = drawn(r, m, 2), Ax = A.apply(x), Vx = V.solve(x);
  std::string out;
  const auto check = [&](const char* name, bool holds) { if (!holds) out += std::string(" | ") + name; };
  check("round trip", Prepared(solver, second).solve(Ax) == x);
  const Matrix y = drawn(r, m, 1), By = Prepared(sweep, second).apply(y);
  F left, right;
  for (Index k = 0; k < m; ++k) {
    left += x(k, 0) * By(k, 0);
    right += Ax(k, 0) * y(k, 0);
  }
  check("symmetric", left == right);
  const Variant<F> other = laws::relabelled(second.problem, second.damping, 3);
  check("relabelled apply", Prepared(sweep, other).apply(x) == Ax);
  check("relabelled solve", Prepared(solver, other).solve(x) == Vx);
  const Variant<F> links = laws::joint_rows_as_links(second.problem, second.damping);
  check("joint rows as links, apply", Prepared(sweep, links).apply(x) == Ax);
  check("joint rows as links, solve", Prepared(solver, links).solve(x) == Vx);
  const Variant<F> rows = laws::armature_as_rows(second.problem, second.damping);
  check("armature as rows", Prepared(solver, rows).solve(appended_zeros(x, rows.problem.structure->rows)).topRows(m) == Vx);
  return out;
}

constexpr int identities = 7;

/// A problem with one number changed by one: the last H, which every identity must notice.
Variant<F> spoiled(Variant<F> v) {
  v.problem.H.back()(5, 5) += F(1);
  return v;
}

struct Mechanism {
  const char* name;
  std::function<generators::Spec()> spec;
};

int run(const Mechanism& mechanism, std::uint64_t seed) {
  const Variant<F> v = drawn(mechanism.spec(), seed);
  const Structure& s = *v.problem.structure;
  const double degree = 2 * static_cast<double>(12 * s.bodies() + s.dofs() + s.rows + 1) + 1;
  std::printf("%-12s %5ld bodies %6ld freedoms %6ld rows, survival of a wrong identity < %.1e\n", mechanism.name,
              static_cast<long>(s.bodies()), static_cast<long>(s.dofs()), static_cast<long>(s.rows),
              degree / static_cast<double>(F::p));
  int failed = 0;
  for (const char* solver : {"lcaba", "lcaba_refined"}) {
    const auto start = std::chrono::steady_clock::now();
    const std::string fails = broken(find_operator(solver), v, v), noticed = broken(find_operator(solver), v, spoiled(v));
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto count = std::count(noticed.begin(), noticed.end(), '|');
    std::printf("  %-14s %.2f s, %s%s; one number changed: %ld of %d identities fail\n", solver, seconds,
                fails.empty() ? "all hold" : "BROKEN", fails.c_str(), static_cast<long>(count), identities);
    failed += (fails.empty() ? 0 : 1) + (count == identities ? 0 : 1);
  }
  return failed;
}

}  // namespace

int main() {
  const Mechanism mechanisms[] = {
      {"swimmer", [] { return family("swimmer", 4000); }},   {"comb", [] { return family("comb", 3000); }},
      {"looped tree", [] { return looped_tree(3000); }},     {"crowd", [] { return crowd(80); }},
      {"contacts", [] { return family("contacts", 2000); }},
  };
  int failed = 0;
  try {
    for (const Mechanism& m : mechanisms) failed += run(m, 11);
  } catch (const std::exception& e) {
    std::printf("FAILED: %s\n", e.what());
    return EXIT_FAILURE;
  }
  std::printf(failed == 0 ? "every identity holds, every one notices a changed number\n" : "FAILED\n");
  return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
