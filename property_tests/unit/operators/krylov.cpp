#include "property_tests/unit/operators/krylov.h"

#include <cmath>
#include <vector>

#include "property_tests/laws/verdict.h"

namespace delassus::laws {
namespace {

/// Two hard rows on a body that slides along two axes: (a, 0) and (b, c), of A the block [a² ab; ab b² + c²] / mass.
struct Pair {
  double a, b, c;
};

Problem<double> sliders(const std::vector<Pair>& pairs, double mass) {
  Structure s;
  for (Index body = 0; body < static_cast<Index>(pairs.size()); ++body) {
    s.add_body(ground, 2);
    s.add_link_constraint(2, {body});
  }
  Problem<double> p(std::make_shared<const Structure>(std::move(s)));
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    p.H[k].diagonal().setConstant(mass);
    for (Index axis = 0; axis < 2; ++axis) p.S[2 * k + static_cast<std::size_t>(axis)][axis] = 1;
    p.K[2 * k][0] = pairs[k].a;
    p.K[2 * k + 1].head<2>() << pairs[k].b, pairs[k].c;
  }
  return p;
}

/// How a solve ends, and after how many steps.
struct End {
  Status status;
  int least, most;
};

struct Spectrum {
  const char* what;
  std::vector<Pair> pairs;
  double first, second;  // a of each pair
  End plain, preconditioned;
  double mass = 1;
};

std::vector<Spectrum> spectra() {
  constexpr Status ok = Status::ok, not_converged = Status::not_converged;
  std::vector<Pair> line, close, graded, slow;
  for (int k = 0; k < 32; ++k) line.push_back({1 + k / 4.0, 0, 1.125 + k / 4.0});
  for (int k = 1; k <= 6; ++k) close.push_back({1, 1, k / 24.0});
  for (int k = 0; k < 32; k += 2) graded.push_back({std::exp2(-25 * k / 31.0), 0, std::exp2(-25 * (k + 1) / 31.0)});
  for (int k = 0; k < 64; k += 2) slow.push_back({std::exp2(-11.5 * k / 63.0), 0, std::exp2(-11.5 * (k + 1) / 63.0)});
  const std::vector<Pair> regular = {{1, 0.5, 3}};
  return {{"one eigenvalue", {{0.7, 0, 0.7}, {0.7, 0, 0.7}, {0.7, 0, 0.7}}, 1, 1, {ok, 1, 1}, {ok, 1, 2}, 3},
          {"64 eigenvalues from 1 to 79", line, 1, 1, {ok, 51, 80}, {ok, 1, 10}},
          {"pairs of nearly parallel rows", close, 1, 0.5, {ok, 6, 18}, {ok, 6, 11}},
          {"32 eigenvalues from 1 to 2^-50", graded, 1, 1, {not_converged, 370, 370}, {ok, 1, 10}},
          {"64 eigenvalues from 1 to 2^-23, no step too early", slow, 1, 1, {ok, 600, 690}, {ok, 1, 10}},
          {"regular", regular, 1, 2, {ok, 1, 3}, {ok, 1, 5}},
          {"a row that nothing moves", {{1, 0, 0}}, 1, 2, {not_converged, 3, 3}, {Status::zero_damping, 0, 0}},
          {"a row that hardly anything moves", {{1, 0, 0x1p-30}}, 1, 2, {not_converged, 3, 3}, {ok, 1, 5}},
          {"the same in other units", {{0x1p20, 0, 0x1p-10}}, 1, 2, {not_converged, 3, 3}, {ok, 1, 5}},
          {"equal rows, other accelerations", {{1, 1, 0}}, 1, 2, {not_converged, 3, 3}, {not_converged, 3, 9}},
          {"zero", regular, 0, 0, {ok, 0, 0}, {ok, 0, 0}},
          {"squares underflow", regular, 0, 0x1p-600, {not_converged, 0, 0}, {not_converged, 0, 0}},
          {"energy overflows", {{0x1p10, 0, 0x1p10}}, 0x1p509, 0x1p510, {not_converged, 0, 0}, {ok, 1, 5}}};
}

struct Iterated {
  Report report;
  MatrixX<double> answer;
};

/// The workspace holds numbers of an earlier use.
Iterated iterated(const Operator<double>& op, const Spectrum& k, double scale) {
  MatrixX<double> a(op.size(), 1);
  for (Index r = 0; r < a.rows(); ++r) a(r, 0) = scale * (r % 2 == 0 ? k.first : k.second);
  Iterated said{{}, MatrixX<double>::Zero(a.rows(), 1)};
  Workspace<double> w(op.workspace(1));
  w.fill(0.75);
  said.report = op.solve(a, said.answer, w);
  return said;
}

std::string ends_wrong(const Report& r, const End& e) {
  if (r.status != e.status) return std::string(name(r.status)) + " instead of " + std::string(name(e.status));
  if (r.iterations < e.least || r.iterations > e.most) return std::to_string(r.iterations) + " steps";
  return r.backward_error > 1 ? "a backward error of " + std::to_string(r.backward_error) : "";
}

/// The same digits and the same report.
bool scales(const Iterated& said, const Iterated& scaled, double scale) {
  return scaled.report.status == said.report.status && scaled.report.iterations == said.report.iterations &&
         scaled.report.backward_error == said.report.backward_error && judge_bits(scaled.answer / scale, said.answer).passed();
}

}  // namespace

std::string krylov_wrong(const OperatorRow& row) {
  for (const Spectrum& k : spectra()) {
    const Problem<double> problem = sliders(k.pairs, k.mass);
    const auto op = row.make<double>();
    op->analyze(problem.structure);
    if (!op->update(problem, Damping<double>::uniform(problem.structure->rows, 0)).ok()) return std::string(k.what) + ": update";
    const End& end = row.name == "cg" ? k.plain : k.preconditioned;
    const Iterated said = iterated(*op, k, 1);
    const std::string words = ends_wrong(said.report, end);
    if (!words.empty()) return std::string(row.name) + ", " + k.what + ": " + words;
    if (k.second == 0 && !said.answer.isZero(0)) return std::string(row.name) + ": an answer to zero";
    if (end.most == 0) continue;
    for (const double scale : {0x1p300, 0x1p-300})
      if (k.second < 0x1p300 && !scales(said, iterated(*op, k, scale), scale)) return std::string(row.name) + ", " + k.what + ": other digits in other units";
  }
  return {};
}

}  // namespace delassus::laws
