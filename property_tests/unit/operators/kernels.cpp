#include "algorithms/kit/test_scalars.h"
#include "property_tests/unit/operators/kernels.h"

#include <utility>

#include "algorithms/factors/factor.h"
#include "algorithms/factors/kkt_residual.h"
#include "algorithms/kit/vectors.h"
#include "algorithms/kit/columns.h"
#include "property_tests/laws/route.h"

namespace delassus::laws {
namespace {

using X = Rational;
using reference::product;

MatrixX<X> transposed(const MatrixX<X>& A) { return A.transpose(); }

struct Exact {
  Problem<X> problem;
  Damping<X> damping;
  MatrixX<X> M, J, R_inverse;
  explicit Exact(const Case& c) : problem(c.problem.cast<X>()), damping(c.damping.cast<X>()) {
    M = reference::mass_matrix(problem);
    J = reference::constraint_jacobian(problem);
    R_inverse = reference::damping_matrix(*problem.structure, damping);
  }
  [[nodiscard]] const Structure& structure() const { return *problem.structure; }
};

/// diag(Σ_l k K_l Ω_l K_lᵀ) over the k links of each constraint, each with the others' K put to zero; 𝒦 as it is.
VectorX<X> mobilities(const Exact& e) {
  const Structure& s = e.structure();
  VectorX<X> d = VectorX<X>::Constant(s.rows, X(0));
  std::size_t most = 1;
  for (const auto& c : s.link_constraints) most = std::max(most, c.links.size());
  for (std::size_t link = 0; link < most; ++link) {
    Problem<X> one = e.problem;
    for (const auto& c : s.link_constraints)
      for (std::size_t l = 0; l < c.links.size(); ++l)
        for (Index r = 0; l != link && r < c.rows; ++r) one.K[c.links[l].first + r].setZero();
    const MatrixX<X> J = reference::constraint_jacobian(one);
    const MatrixX<X> A = product<X>(J, reference::PivotedLdlt<X>(e.M).solve(transposed(J)));
    for (const auto& c : s.link_constraints)
      for (Index r = c.row; r < c.row + c.rows; ++r) d[r] += X(static_cast<int>(c.links.size())) * A(r, r);
    for (const auto& c : s.joint_constraints)
      for (Index r = c.row; r < c.row + c.rows; ++r) d[r] = A(r, r);
  }
  return d;
}

bool equal(const MatrixX<X>& a, const MatrixX<X>& b) { return judge_equal(a, b).passed(); }

/// The functions of a factor of `matrix` = M or M_R.
std::string factor_wrong(const Exact& e, const Factor<X>& factor, const MatrixX<X>& matrix, bool mobility) {
  const Structure& s = e.structure();
  const reference::PivotedLdlt<X> inverse(matrix);
  const MatrixX<X> x = vectors<X>(s.rows, 1, 1), tau = vectors<X>(s.dofs(), 1, 2);
  MatrixX<X> y = x, nu = tau;
  std::vector<X> work(static_cast<std::size_t>(factor.solve_workspace()));
  factor.project(x.data(), y.data(), work.data());
  const MatrixX<X> force = product<X>(transposed(e.J), x);
  if (!equal(y, product<X>(e.J, inverse.solve(force)))) return "project";
  factor.project(y.data(), y.data(), work.data());
  if (!equal(y, product<X>(e.J, inverse.solve(product<X>(transposed(e.J), product<X>(e.J, inverse.solve(force))))))) return "project in place";
  factor.solve(x.data(), tau.data(), y.data(), nu.data(), work.data());
  const MatrixX<X> expected = inverse.solve(MatrixX<X>(force + tau));
  if (!equal(nu, expected)) return "solve: nu";
  if (!equal(y, product<X>(e.J, expected))) return "solve: y";
  if (!(factor.energy(tau.data(), work.data()) == product<X>(transposed(tau), inverse.solve(tau))(0, 0))) return "energy";
  if (!mobility) return {};
  VectorX<X> d = VectorX<X>::Constant(s.rows, X(-1));
  std::vector<SixBySix<X>> omega(static_cast<std::size_t>(s.bodies()));
  factor.row_mobility(d.data(), omega.data());
  return equal(d, mobilities(e)) ? "" : "row_mobility";
}

std::string factors_wrong(const Exact& e) {
  const Structure& s = e.structure();
  BlockDiagonal<X> weights, twice;
  weights.analyze(s);
  twice.analyze(s);
  const bool damped = weights.assign_inverse(e.damping).ok();
  if (damped) static_cast<void>(twice.assign_inverse(other_damping(s, e.damping)));
  for (const Branches branches : {Branches::all, Branches::with_rows})
    for (const Matrix matrix : {Matrix::M, Matrix::M_R}) {
      if (matrix == Matrix::M_R && !damped) continue;
      const Plan plan = make_plan(s, matrix, branches);
      const bool all = branches == Branches::all;
      Factor<X> factor;
      factor.analyze(s, plan);
      MatrixX<X> expected = e.M;
      if (matrix == Matrix::M_R) expected += product<X>(transposed(e.J), reference::PivotedLdlt<X>(e.R_inverse).solve(e.J));
      for (int time = 0; time < 3; ++time) {  // from start, after other weights, from start again
        if (time != 1 && !factor.start(e.problem).ok()) return "start";
        if (time == 1 && matrix == Matrix::M_R && !factor.update_weights(twice).ok()) return "update_weights";
        if (matrix == Matrix::M_R ? !factor.update_weights(weights).ok() : time != 1 && !factor.update_undamped().ok()) return "update";
        const std::string words = factor_wrong(e, factor, expected, matrix == Matrix::M);
        if (!words.empty()) return "Factor, " + std::string(matrix == Matrix::M ? "M, " : "M_R, ") + (all ? "all, " : "with rows, ") + words;
      }
    }
  return {};
}

std::string residual_wrong(const Exact& e) {
  const Structure& s = e.structure();
  KktResidual<X> residual;
  residual.analyze(e.problem.structure);
  residual.update(e.problem);
  residual.update_damping(e.damping);
  const MatrixX<X> nu = vectors<X>(s.dofs(), 1, 3), lambda = vectors<X>(s.rows, 1, 4);
  MatrixX<X> r1 = vectors<X>(s.dofs(), 1, 5), r2 = vectors<X>(s.rows, 1, 6);
  const MatrixX<X> motion = product<X>(transposed(e.J), lambda) - product<X>(e.M, nu);
  const MatrixX<X> left = MatrixX<X>(r2 - product<X>(e.J, nu)) - product<X>(e.R_inverse, lambda), given = r1;
  std::vector<X> work(static_cast<std::size_t>(residual.workspace()));
  const MatrixX<X> r2_0 = r2;
  residual.evaluate(nu.data(), lambda.data(), static_cast<const X*>(nullptr), r2_0.data(), r1.data(), r2.data(), work.data());
  if (!equal(r1, motion) || !equal(r2, left)) return "residual from (0, a)";
  r1 = given;
  r2 = r2_0;
  residual.evaluate(nu.data(), lambda.data(), r1.data(), r2.data(), r1.data(), r2.data(), work.data());
  return equal(r1, given + motion) && equal(r2, left) ? "" : "residual from a residual";
}

/// One entry more in every array, which stays as it is.
template <class T> std::string numbers_wrong(const Problem<T>& p) {
  KktResidual<T> residual;
  residual.analyze(p.structure);
  residual.update(p);
  Problem<T> got, expected = p;
  const auto prepare = [](auto& to, auto& from, const auto& one) {
    from.push_back(one);
    to.assign(from.size(), one);
  };
  prepare(got.S, expected.S, Vector6<T>::Ones());
  prepare(got.K, expected.K, Vector6<T>::Ones());
  prepare(got.H, expected.H, Matrix6<T>::Ones());
  prepare(got.armature, expected.armature, T(1));
  prepare(got.joint_K, expected.joint_K, T(1));
  residual.numbers(got);
  const bool same = got.S == expected.S && got.K == expected.K && got.H == expected.H && got.armature == expected.armature && got.joint_K == expected.joint_K;
  return same ? "" : "numbers";
}

MatrixX<Quad> exactly(const std::vector<DoubleDouble>& x) {
  MatrixX<Quad> out(static_cast<Index>(x.size()), 1);
  for (Index r = 0; r < out.rows(); ++r) out(r, 0) = Quad(x[static_cast<std::size_t>(r)].hi) + Quad(x[static_cast<std::size_t>(r)].lo);
  return out;
}

std::vector<DoubleDouble> two_words(const MatrixX<Quad>& x) {
  std::vector<DoubleDouble> out;
  for (Index r = 0; r < x.rows(); ++r) {
    const double hi = static_cast<double>(x(r, 0));
    out.push_back({hi, static_cast<double>(Quad(x(r, 0) - Quad(hi)))});
  }
  return out;
}

/// At a solution in two words, where everything cancels.
std::string wide_residual_wrong(const Case& c) {
  const Structure& s = *c.problem.structure;
  if (why_no_bound(Function::solve, c)) return {};
  const auto quad = [](const auto& x) { return x.template cast<Quad>(); };
  Problem<Quad> problem = quad(c.problem), sizes = problem;
  for (auto& x : sizes.S) x = x.cwiseAbs();
  for (auto& x : sizes.H) x = x.cwiseAbs();
  for (auto& x : sizes.K) x = x.cwiseAbs();
  for (auto& x : sizes.joint_K) x = abs(x);
  const auto exact = reference::dense(problem, quad(c.damping));
  const MatrixX<Quad> M = reference::mass_matrix(sizes), J = reference::constraint_jacobian(sizes), R_inverse = magnitude(exact.R_inverse);
  const MatrixX<double> a = vectors<double>(s.rows, 1, 7);
  const auto lambda = two_words(reference::dense_solve(exact, converted<Quad>(a)));
  const auto nu = two_words(product<Quad>(exact.M_inv_Jt, exactly(lambda)));
  const MatrixX<Quad> l = exactly(lambda), v = exactly(nu), size_l = magnitude(l), size_v = magnitude(v);
  KktResidual<double> residual;
  residual.analyze(c.problem.structure);
  residual.update(c.problem);
  residual.update_damping(c.damping);
  Workspace<double> work(residual.workspace());
  MatrixX<double> r1(s.dofs(), 1), r2(s.rows, 1);
  residual.evaluate(nu.data(), lambda.data(), static_cast<const double*>(nullptr), a.data(), r1.data(), r2.data(), work.data());
  const MatrixX<Quad> exact_1 = product<Quad>(exact.J.transpose(), l) - product<Quad>(exact.M, v);
  const MatrixX<Quad> exact_2 = MatrixX<Quad>(converted<Quad>(a) - product<Quad>(exact.J, v)) - product<Quad>(exact.R_inverse, l);
  const Quad eps(unit_roundoff<double>);
  const MatrixX<Quad> bound_1 = magnitude(exact_1) + MatrixX<Quad>(product<Quad>(J.transpose(), size_l) + product<Quad>(M, size_v)) * eps;
  const MatrixX<Quad> bound_2 = magnitude(exact_2) + MatrixX<Quad>(magnitude(converted<Quad>(a)) + product<Quad>(J, size_v) + product<Quad>(R_inverse, size_l)) * eps;
  const bool right = judge(converted<Quad>(r1) - exact_1, bound_1, unit_roundoff<double>, "").passed() &&
                     judge(converted<Quad>(r2) - exact_2, bound_2, unit_roundoff<double>, "").passed();
  return right ? "" : "residual in two words";
}

/// dot and largest_magnitude on small whole numbers, the largest in every place and with either sign, zero up to the padded end.
template <class T> std::string reductions_wrong() {
  for (const Index n : {0, 1, 7, 8, 9, 17}) {
    Workspace<T> memory(2 * padded(n) + 16);
    memory.fill(T(0));
    T *const x = memory.data(), *const y = x + padded(n);
    int expected = 0;
    for (Index c = 0; c < n; ++c) {
      x[c] = T(static_cast<int>(c % 5) - 2);
      y[c] = T(static_cast<int>(c % 7) + 1);
      expected += (static_cast<int>(c % 5) - 2) * (static_cast<int>(c % 7) + 1);
    }
    if (!(dot(x, y, n) == T(expected))) return "dot of " + std::to_string(n) + " numbers";
    for (Index c = 0; c < n; ++c)
      for (const int largest : {9, -9}) {
        const T kept = std::exchange(x[c], T(largest));
        if (!(largest_magnitude(x, n) == 9)) return "largest of " + std::to_string(n) + " numbers";
        x[c] = kept;
      }
  }
  return {};
}

}  // namespace

std::string kernel_wrong(const Case& c) {
  const Exact e(c);
  std::string words = factors_wrong(e);
  if (words.empty()) words = residual_wrong(e);
  if (words.empty()) words = wide_residual_wrong(c);
  if (words.empty()) words = numbers_wrong(c.problem);
  for (const auto& reductions : {reductions_wrong<double>, reductions_wrong<float>, reductions_wrong<Rational>})
    if (words.empty()) words = reductions();
  return words.empty() ? words : words + " on " + c.label;
}

}  // namespace delassus::laws
