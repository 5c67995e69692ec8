#include <cmath>

#include "algorithms/factors/square_root_factor.h"
#include "algorithms/kit/test_scalars.h"
#include "property_tests/unit/operators/kkt_system.h"
#include "property_tests/unit/operators/one_solve.h"

namespace delassus::laws {
namespace {

template <class T> Sides<T> narrow(const Sides<double>& x) { return {converted<T>(x.r1), converted<T>(x.r2)}; }

/// A solve in memory of its own, full of NaN; empty where it writes behind its workspace.
template <class T> Sides<T> asked(const SquareRootFactor<T>& factor, const Sides<T>& right, bool without_r1 = false) {
  constexpr Index behind = 16;
  Sides<T> x{MatrixX<T>::Zero(right.r1.rows(), 1), MatrixX<T>::Zero(right.r2.rows(), 1)};
  Workspace<T> work(factor.workspace() + behind);
  work.fill(std::numeric_limits<T>::quiet_NaN());
  factor.solve_kkt(without_r1 ? nullptr : right.r1.data(), right.r2.data(), x.r1.data(), x.r2.data(), work.data());
  const T* const end = work.data() + factor.workspace();
  return std::all_of(end, end + behind, [](T v) { return std::isnan(v); }) ? x : Sides<T>{};
}

template <class T> bool equal(const Sides<T>& x, const Sides<T>& y) {
  return x.r1.rows() == y.r1.rows() && x.r2.rows() == y.r2.rows() && (x.r1.array() == y.r1.array()).all() && (x.r2.array() == y.r2.array()).all();
}

template <class T> std::string root_wrong(const Case& c) {
  const Problem<T> p = c.problem.template cast<T>();
  const Damping<T> d = c.damping.template cast<T>();
  const Structure& s = *p.structure;
  SquareRootFactor<T> factor;
  factor.analyze(s);
  if (!factor.update(p, d).ok()) return "update";
  const System<Quad> system(p.template cast<double>().template cast<Quad>(), d.template cast<double>().template cast<Quad>());
  const Sides<T> right = narrow<T>({vectors<double>(s.dofs(), 1, 1), vectors<double>(s.rows, 1, 2)}), got = asked(factor, right);
  if (got.r2.rows() != c.rows()) return "written behind the workspace";
  const Verdict v = residual(system, quad(right), quad(got), true, unit_roundoff<T>);
  if (!v.passed()) return "residual, " + std::to_string(v.ratio);
  Sides<T> no_r1 = right, shared = right;
  no_r1.r1.setZero();
  if (!equal(asked(factor, no_r1, true), asked(factor, no_r1))) return "no r1";
  Workspace<T> work(factor.workspace());
  factor.solve_kkt(shared.r1.data(), shared.r2.data(), shared.r1.data(), shared.r2.data(), work.data());
  if (!equal(shared, got)) return "shared memory";
  if (!factor.update_weights(other_damping(s, c.damping).template cast<T>()).ok()) return "update_weights";
  if (factor.update_weights(d).ok() && equal(asked(factor, right), got)) return {};
  return "other weights in between";
}

/// Thirty rows between two bodies of a tree: both members of a front take six of them. The first `heavy` have R⁻¹ = 2⁻⁸⁰ and hardly
/// touch every second direction: reduced in the wrong order, they drown the others.
Case many_rows(Index heavy) {
  Structure s;
  s.add_body(ground, 6);
  s.add_body(0, 1);
  s.add_body(0, 2);
  for (int k = 0; k < 5; ++k) s.add_link_constraint(6, {1, 2});
  Problem<double> p(std::make_shared<const Structure>(std::move(s)));
  for (auto& H : p.H) H.diagonal() << 2, 3, 4, 5, 5, 5;
  const MatrixX<double> numbers = vectors<double>(6, static_cast<Index>(p.S.size() + p.K.size()), 5);
  for (std::size_t k = 0; k < p.S.size(); ++k) p.S[k] = numbers.col(static_cast<Index>(k));
  for (std::size_t k = 0; k < p.K.size(); ++k) p.K[k] = numbers.col(static_cast<Index>(p.S.size() + k));
  for (std::size_t c = 0; c < 6; ++c) p.S[c] = Vector6<double>::Unit(static_cast<Index>(c));
  Damping<double> d = Damping<double>::uniform(30, 0.5);
  for (Index r = 0; r < heavy; ++r) {
    d.diagonal[static_cast<std::size_t>(r)] = 0x1p-80;
    for (const auto& link : p.structure->link_constraints[0].links)
      for (Index c = 0; c < 6; c += 2) p.K[static_cast<std::size_t>(link.first + r)][c] *= 0x1p-40;
  }
  return make_case(std::move(p), std::move(d), "many rows, " + std::to_string(heavy) + " of them heavy", 1);
}

/// A row of these numbers and its R⁻¹.
struct Row {
  double K[3], R_inverse;
};

/// Rows on three freedoms of a body, heavy ones that are all but along one of them: each wrong order of columns drowns the light.
Case tilted_rows(std::vector<Row> rows) {
  Structure s;
  s.add_body(ground, 3);
  s.add_link_constraint(static_cast<Index>(rows.size()), {0});
  Problem<double> p(std::make_shared<const Structure>(std::move(s)));
  Damping<double> d = Damping<double>::uniform(static_cast<Index>(rows.size()), 1);
  p.H[0].diagonal().setOnes();
  for (std::size_t c = 0; c < 3; ++c) p.S[c][static_cast<Index>(c)] = 1;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (Index c = 0; c < 3; ++c) p.K[r][c] = rows[r].K[c];
    d.diagonal[r] = rows[r].R_inverse;
  }
  return make_case(std::move(p), std::move(d), "tilted rows", 1);
}

/// A tree without rows, with a fixed joint in it; a body of two freedoms (10 and 11) with a row of this size on one of them.
Case lonely_row(Index freedom, double size) {
  Structure s;
  s.add_body(ground, 6);
  s.add_body(0, 0);
  s.add_body(1, 4);
  s.add_body(ground, 2);
  s.add_link_constraint(1, {3});
  Problem<double> p(std::make_shared<const Structure>(std::move(s)));
  for (auto& H : p.H) H.diagonal() << 2, 3, 4, 5, 5, 5;
  for (std::size_t c = 0; c < p.S.size(); ++c) p.S[c][static_cast<Index>(c % 6)] = 1;
  p.K[0][freedom % 6] = size;
  return make_case(std::move(p), Damping<double>::uniform(1, 0.5), "a lonely row", 1);
}

}  // namespace

std::string square_root_limits_wrong() {
  const Row light = {{0.75, 0.625, 0.5}, 1}, other = {{0.875, -0.5, 0.25}, 1};
  const Case second_first = tilted_rows({{{0x1p-40, 1, 0x1p-40}, 0x1p-80}, light, other});
  const Case third_second = tilted_rows({{{1, 0.5, 0}, 0x1p-120}, {{0x1p-30, 0x1p-30, 1}, 0x1p-60}, light, other});
  for (const Case& c : {many_rows(0), many_rows(3), second_first, third_second, lonely_row(11, 1)}) {
    const std::string words = square_root_wrong(c);
    if (!words.empty()) return words;
  }
  for (const Index freedom : {10, 11}) {
    const Case overflows = lonely_row(freedom, 0x1p600);
    SquareRootFactor<double> factor;
    factor.analyze(*overflows.problem.structure);
    const Report lost = factor.update(overflows.problem, overflows.damping);
    if (lost.status != Status::lost_pivot || lost.where != freedom)
      return "SquareRootFactor, squares overflow: " + std::string(name(lost.status)) + " at " + std::to_string(lost.where);
  }
  return {};
}

std::string square_root_wrong(const Case& c) {
  std::string words = root_wrong<double>(c), of = "double";
  if (words.empty()) words = root_wrong<float>(c), of = "float";
  return words.empty() ? "" : "SquareRootFactor in " + of + ", " + words + " on " + c.label;
}

}  // namespace delassus::laws
