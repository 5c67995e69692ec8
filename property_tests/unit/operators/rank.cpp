#include "property_tests/unit/operators/rank.h"

#include <array>
#include <cmath>

namespace delassus::laws {
namespace {

/// One constraint on a body of unit mass that slides along three axes: A = K Kᵀ + R⁻¹.
struct Slider {
  const char* what;
  std::vector<std::array<double, 3>> K;
  std::vector<double> a;
  std::vector<Index> dependent;      // hard rows that depend on others, by the rule of hard_rows.h
  Status status = Status::ok;        // of kkt_elimination
  Index where = -1;
  std::vector<double> f = {};        // the answer; empty: not compared
  double damping = 0;
};

// The size B of a row k here is 3 |k|². The thresholds, in units of u = 2⁻⁵³: a pivot, (30 · 2)² · 3 · 1.890625 = 20418.75 u²;
// a residual, 30 · 2 · (1 + 1 + √3) = 223.92 u.
std::vector<Slider> sliders() {
  constexpr Status ok = Status::ok, inconsistent = Status::inconsistent;
  constexpr double u = 0x1p-53, far = 0x1p60;
  const std::vector<std::array<double, 3>> three = {{1, 0, 0}, {1, 0, 0}, {2, 0, 0}}, twice = {{1, 0, 0}, {1, 0, 0}};
  const std::array<double, 3> above = {1.375, 142 * u, 16 * u}, below = {1.375, 142 * u, 15 * u};
  return {
      {"consistent", three, {1, 1, 2}, {1, 2}, ok, -1, {1, 0, 0}},
      {"the first row contradicts", three, {2, 1, 2}, {1, 2}, inconsistent, 1},
      {"the second row contradicts", three, {1, 2, 2}, {1, 2}, inconsistent, 1},
      {"the third row contradicts", three, {1, 1, 3}, {1, 2}, inconsistent, 2},
      {"soft", three, {2, 1, 2}, {}, ok, -1, {}, 0.5},
      {"damping below eps", three, {1, 1, 2}, {}, Status::not_converged, -1, {}, 0x1p-60},
      {"a pivot of 20420", {{2, 0, 0}, above}, {}, {}},
      {"a pivot of 20389", {{2, 0, 0}, below}, {}, {1}},
      {"a pivot of 20420 beside a row in other units", {{2 * far, 0, 0}, above}, {}, {}},
      {"a pivot of 20389 beside a row in other units", {{2 * far, 0, 0}, below}, {}, {1}},
      {"a pivot of 20389, first row", {below, {2, 0, 0}}, {}, {1}},
      {"a row of zeros", {{0, 0, 0}, {1, 0, 0}}, {0, 1}, {0}, ok, -1, {0, 1}},
      {"a residual of 222", twice, {1, 1 + 222 * u}, {1}, ok, -1, {1, 0}},
      {"a residual of 224", twice, {1, 1 + 224 * u}, {1}, inconsistent, 1},
      {"zero", twice, {0, 0}, {1}, ok, -1, {0, 0}},
      {"small beside another row", {{0, 1, 0}, {1, 0, 0}, {1, 0, 0}}, {0x1p10, 1, 1 + 0x1p-40}, {2}, ok, -1, {0x1p10, 1, 0}},
      {"small beside the forces", {{1, 0, 0}, {0, 0, 1}, {1, 0x1p-10, 0}, {1, 0x1p-10, 0}}, {0, 0, 1, 1 + 0x1p-30}, {3}},
  };
}

struct OfRank {
  Report report;
  std::vector<Index> dependent;
  MatrixX<double> f;
};

/// Rows in units of `unit`, accelerations times `scale`.
OfRank of_rank(const OperatorRow& row, const Slider& k, const Damping<double>& damping, double unit = 1, double scale = 1) {
  const Index m = static_cast<Index>(k.K.size());
  Structure s;
  s.add_body(ground, 3);
  s.add_link_constraint(m, {0});
  Problem<double> p(std::make_shared<const Structure>(std::move(s)));
  p.H[0].diagonal().setOnes();
  for (Index c = 0; c < 3; ++c) p.S[static_cast<std::size_t>(c)][c] = 1;
  for (std::size_t r = 0; r < k.K.size(); ++r)
    for (Index c = 0; c < 3; ++c) p.K[r][c] = unit * k.K[r][static_cast<std::size_t>(c)];
  const auto op = row.make<double>();
  op->analyze(p.structure);
  static_cast<void>(op->update(p, Damping<double>::uniform(m, 1)));
  static_cast<void>(op->update_damping(damping));
  OfRank said{{}, op->dependent_rows(), MatrixX<double>::Constant(m, 1, 0.75)};
  if (k.a.empty()) return said;
  MatrixX<double> a(m, 1);
  for (Index r = 0; r < m; ++r) a(r, 0) = scale * k.a[static_cast<std::size_t>(r)];
  Workspace<double> w(op->workspace(1));
  w.fill(0.75);
  said.report = op->solve(a, said.f, w);
  return said;
}

std::string words(const Report& r) { return std::string(name(r.status)) + " at " + std::to_string(r.where); }

/// f in other units.
bool answers(const OfRank& said, const std::vector<double>& f, double unit) {
  for (std::size_t r = 0; r < f.size(); ++r)
    if (said.f(static_cast<Index>(r), 0) != f[r] * unit) return false;
  return true;
}

std::string slider_wrong(const OperatorRow& row, const Slider& k, double unit, double scale) {
  const bool refused = row.name == "dense_refined" && !k.dependent.empty();
  const OfRank said = of_rank(row, k, Damping<double>::uniform(static_cast<Index>(k.K.size()), k.damping), unit, scale);
  if (row.decides_rank && said.dependent != k.dependent) return "other rows left out";
  if (k.a.empty()) return {};
  const Report expected = refused ? Report{Status::lost_pivot, k.dependent[0]} : Report{k.status, k.where};
  if (said.report.status != expected.status || (!expected.ok() && said.report.where != expected.where)) return words(said.report);
  return refused || answers(said, k.f, scale / (unit * unit)) ? "" : "other forces";
}

/// A block of R⁻¹ that is singular where the rows are dependent: this arithmetic cannot tell, nothing is left out.
std::string singular_block_wrong(const OperatorRow& row, const Slider& k) {
  Damping<double> damping = Damping<double>::uniform(3, 0);
  damping.blocks = {{0, MatrixX<double>::Constant(2, 2, -0.5)}};
  damping.blocks[0].R_inverse.diagonal().setConstant(0.5);
  const Report r = of_rank(row, k, damping).report;
  return r.status == Status::lost_pivot && r.where == 1 ? "" : words(r);
}

}  // namespace

std::string dependent_rows_wrong(const OperatorRow& row) {
  const std::string who = std::string(row.name) + ", dependent rows, ";
  const std::vector<Slider> all = sliders();
  for (const Slider& k : all)
    for (const double unit : {1.0, 0x1p100, 0x1p-100})
      for (const double scale : {1.0, 0x1p150, 0x1p-150}) {
        if (k.damping > 0 && (unit != 1 || scale != 1)) continue;
        const std::string wrong = slider_wrong(row, k, unit, scale);
        if (!wrong.empty()) return who + k.what + " (units " + std::to_string(std::ilogb(unit)) + ", " + std::to_string(std::ilogb(scale)) + "): " + wrong;
      }
  const std::string wrong = singular_block_wrong(row, all[0]);
  return wrong.empty() ? "" : who + "singular block: " + wrong;
}

}  // namespace delassus::laws
