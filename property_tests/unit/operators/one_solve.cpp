#include "algorithms/kit/test_scalars.h"
#include "property_tests/unit/operators/one_solve.h"

#include <cmath>

#include "algorithms/factors/capped_inverse.h"
#include "algorithms/operators/kkt_elimination.h"
#include "property_tests/unit/operators/kkt_system.h"

namespace delassus::laws {
namespace {

/// A vector with numbers behind it that must not be read or written.
class Fenced {
 public:
  explicit Fenced(const MatrixX<double>& x) : size_(x.rows()), values_(size_ + behind) {
    values_.fill(fence);
    std::copy(x.data(), x.data() + size_, values_.data());
  }
  [[nodiscard]] double* data() { return values_.data(); }
  [[nodiscard]] MatrixX<double> value() { return Eigen::Map<const MatrixX<double>>(values_.data(), size_, 1); }
  [[nodiscard]] bool kept() { return std::all_of(values_.data() + size_, values_.data() + size_ + behind, [](double v) { return v == fence; }); }

 private:
  static constexpr double fence = 0x1p900;
  static constexpr Index behind = 8;
  Index size_;
  Workspace<double> values_;
};

constexpr double cap = 8;

/// CappedInverse<double, F> of a problem, and (K) with the damping it should have.
template <class F> class Capped {
 public:
  Capped(const Problem<double>& p, const Damping<double>& d) : inverse_(cap), structure_(p.structure), damping_(d) {
    const Structure& s = *structure_;
    const Plan plan = make_plan(s, Matrix::M, Branches::all);
    Factor<double> M;
    M.analyze(s, plan);
    updated_ = M.start(p);
    if (updated_.ok()) updated_ = M.update_undamped();
    inverse_.analyze(s);
    if (updated_.ok()) updated_ = inverse_.update(p, M);
    if (updated_.ok()) static_cast<void>(inverse_.update_damping(Damping<double>::uniform(s.rows, 0)));  // must leave no trace
    if (updated_.ok()) updated_ = inverse_.update_damping(d);
    least_.assign(static_cast<std::size_t>(s.rows), 0);
    std::vector<SixBySix<double>> omega(static_cast<std::size_t>(s.bodies()));
    if (s.rows > 0) M.row_mobility(least_.data(), omega.data());
  }
  [[nodiscard]] const Report& updated() const { return updated_; }

  /// r1 or δν may be left out.
  Sides<double> operator()(const Sides<double>& right, bool without_r1 = false, bool without_nu = false) const {
    Fenced r1(right.r1), r2(right.r2), nu(MatrixX<double>::Zero(right.r1.rows(), 1)), lambda(MatrixX<double>::Zero(right.r2.rows(), 1));
    Fenced work(MatrixX<double>::Constant(inverse_.workspace(), 1, std::numeric_limits<double>::quiet_NaN()));
    inverse_.solve_kkt(without_r1 ? nullptr : r1.data(), r2.data(), without_nu ? nullptr : nu.data(), lambda.data(), work.data());
    if (!nu.kept() || !lambda.kept() || !work.kept()) return {};
    return {nu.value(), lambda.value()};
  }
  /// R₀⁻¹ = R⁻¹ + s: s = d/g within blocks, elsewhere what R⁻¹ lacks of it.
  [[nodiscard]] System<Quad> system(const Problem<double>& p) const {
    System<Quad> s(p.cast<Quad>(), damping_.template cast<Quad>());
    for (Index r = 0; r < structure_->rows; ++r) {
      const bool in_block = std::any_of(damping_.blocks.begin(), damping_.blocks.end(), [r](const auto& b) { return r >= b.row && r < b.row + b.R_inverse.rows(); });
      const Quad least = Quad(least_[static_cast<std::size_t>(r)]) / Quad(cap), given = in_block ? Quad(0) : s.R_inverse(r, r);
      if (least > given) s.R_inverse(r, r) += least - given;
    }
    return s;
  }

 private:
  CappedInverse<double, F> inverse_;
  std::shared_ptr<const Structure> structure_;
  Damping<double> damping_;
  std::vector<double> least_;
  Report updated_;
};

/// Every entry; every unit vector of r₁; every one of r₂.
std::vector<Sides<double>> right_sides(const Structure& s) {
  std::vector<Sides<double>> all = {{vectors<double>(s.dofs(), 1, 1), vectors<double>(s.rows, 1, 2)}};
  for (Index k = 0; k < s.dofs() + s.rows; ++k) {
    all.push_back({MatrixX<double>::Zero(s.dofs(), 1), MatrixX<double>::Zero(s.rows, 1)});
    (k < s.dofs() ? all.back().r1(k, 0) : all.back().r2(k - s.dofs(), 0)) = 1;
  }
  return all;
}

bool same(const Sides<double>& x, const Sides<double>& y) { return judge_bits(x.r1, y.r1).passed() && judge_bits(x.r2, y.r2).passed(); }

struct Units {
  double mass, rate;
};

template <class F> std::string capped_wrong(const Case& c) {
  const Capped<F> inverse(c.problem, c.damping);
  if (!inverse.updated().ok()) return "update";
  const System<Quad> system = inverse.system(c.problem);
  const std::vector<Sides<double>> rights = right_sides(*c.problem.structure);
  std::vector<Sides<double>> answers;
  for (const Sides<double>& right : rights) {
    answers.push_back(inverse(right));
    if (answers.back().r2.rows() != c.rows()) return "written behind a vector";
    const Verdict v = residual(system, quad(right), quad(answers.back()), false, unit_roundoff<F>);
    if (!v.passed()) return "residual, " + std::to_string(v.ratio);
  }
  Sides<double> no_r1 = rights[0];
  no_r1.r1.setZero();
  if (!same(inverse(no_r1, true), inverse(no_r1))) return "no r1";
  if (!judge_bits(inverse(rights[0], false, true).r2, answers[0].r2).passed()) return "no motion wanted";
  for (const Units u : {Units{0x1p400, 1}, Units{0x1p-400, 1}, Units{1, 0x1p300}, Units{1, 0x1p-300}}) {
    Problem<double> p = c.problem;
    Damping<double> d = c.damping;
    for (auto& H : p.H) H *= u.mass;
    for (double& A : p.armature) A *= u.mass;
    for (double& x : d.diagonal) x /= u.mass;
    for (auto& b : d.blocks) b.R_inverse /= u.mass;
    const Capped<F> other(p, d);
    if (!other.updated().ok()) return "update in other units";
    for (std::size_t k = 0; k < rights.size(); ++k) {
      const Sides<double> got = other({rights[k].r1 * (u.mass * u.rate), rights[k].r2 * u.rate});
      if (!same({got.r1 / u.rate, got.r2 / (u.mass * u.rate)}, answers[k])) return "other bits in other units";
    }
  }
  return {};
}

/// One freedom, one hard row on it; what inertia there is: H₀₀ or an armature.
Case lone_inertia(bool armature) {
  Structure s;
  s.add_body(ground, 1);
  s.add_link_constraint(1, {0});
  Problem<double> p(std::make_shared<const Structure>(std::move(s)));
  p.S[0][0] = p.K[0][0] = 1;
  (armature ? p.armature[0] : p.H[0](0, 0)) = 2;
  return make_case(std::move(p), Damping<double>::uniform(1, 0), armature ? "an armature alone" : "one moment of inertia", 1, true);
}

/// Two freedoms that are one in float.
Problem<double> nearly_parallel(Index rows) {
  Structure s;
  s.add_body(ground, 2);
  if (rows > 0) s.add_link_constraint(rows, {0});
  Problem<double> p(std::make_shared<const Structure>(std::move(s)));
  p.H[0].diagonal().setOnes();
  p.S[0][0] = p.S[1][0] = 1;
  p.S[1][1] = 0x1p-20;
  return p;
}

}  // namespace

std::string capped_inverse_wrong(const Case& c) {
  if (c.rows() == 0) return {};  // nothing is asked
  std::string words = capped_wrong<double>(c), of = "double";
  if (words.empty()) words = capped_wrong<float>(c), of = "float";
  return words.empty() ? "" : "CappedInverse in " + of + ", " + words + " on " + c.label;
}

std::string capped_inverse_limits_wrong() {
  for (const bool armature : {true, false}) {
    const std::string words = capped_inverse_wrong(lone_inertia(armature));
    if (!words.empty()) return words;
  }
  Case still = lone_inertia(false);
  still.problem.K[0].setZero();
  const Report refused = Capped<float>(still.problem, still.damping).updated();
  if (refused.status != Status::zero_damping || refused.where != 0) return "CappedInverse, a row that nothing moves: " + std::string(name(refused.status));
  const Report lost = Capped<float>(nearly_parallel(1), Damping<double>::uniform(1, 1)).updated();
  if (lost.status != Status::lost_pivot) return "CappedInverse, M singular in float: " + std::string(name(lost.status));
  return Capped<float>(nearly_parallel(0), {}).updated().ok() ? "" : "CappedInverse, no rows";
}

std::string elimination_wrong(const Case& c) {
  using X = Rational;
  const auto [p, d] = numbers<X>(c);
  const Structure& s = *p.structure;
  KktElimination<X> op;
  op.analyze(p.structure);
  if (!op.update(p, d).ok()) return "KktElimination, update on " + c.label;
  const System<X> system(p, d);
  const Sides<X> right = system.image({vectors<X>(s.dofs(), 1, 1), vectors<X>(s.rows, 1, 2)});
  Sides<X> x{MatrixX<X>::Constant(s.dofs(), 1, X(7)), MatrixX<X>::Constant(s.rows, 1, X(7))};
  std::vector<X> work(static_cast<std::size_t>(op.workspace(1)), X(7));
  op.solve_kkt(right.r1.data(), right.r2.data(), x.r1.data(), x.r2.data(), work.data());
  const Sides<X> got = system.image(x);
  for (const Index r : op.dependent_rows())
    if (x.r2(r, 0) != X(0)) return "KktElimination, force of a row left out on " + c.label;
  return judge_equal(got.r1, right.r1).passed() && judge_equal(got.r2, right.r2).passed() ? "" : "KktElimination, residual on " + c.label;
}

}  // namespace delassus::laws
