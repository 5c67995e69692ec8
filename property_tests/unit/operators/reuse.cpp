#include "algorithms/kit/test_scalars.h"
#include "property_tests/unit/operators/reuse.h"

#include <algorithm>

#include "generators/build.h"
#include "property_tests/laws/route.h"

namespace delassus::laws {
namespace {

MatrixX<double> block(Index rows) {  // dominated by its diagonal
  MatrixX<double> B(rows, rows);
  for (Index r = 0; r < rows; ++r)
    for (Index c = 0; c < rows; ++c) B(r, c) = r == c ? 0.5 + 0.125 * static_cast<double>(r) : (r + c) % 2 == 0 ? 0.0625 : -0.03125;
  return B;
}

struct Said {
  Report report;
  MatrixX<double> answer;
};

Said asked(const OperatorRow& row, const Operator<double>& op, std::uint64_t seed) {
  const MatrixX<double> x = vectors<double>(op.size(), 2, seed);
  Said said{{}, MatrixX<double>::Zero(x.rows(), x.cols())};
  Workspace<double> w(op.workspace(2));
  said.report = row.solves ? op.solve(x, said.answer, w) : op.apply(x, said.answer, w);
  return said;
}

/// Whether it writes behind the workspace it asked for.
bool oversteps(const OperatorRow& row, const Operator<double>& op) {
  constexpr Index behind = 64;
  for (const Index columns : {1, 2, 9}) {
    const Index size = op.workspace(columns);
    const MatrixX<double> x = vectors<double>(op.size(), columns, 1);
    MatrixX<double> y = x;
    Workspace<double> memory(size + behind), w(memory.data(), size);
    memory.fill(0.375);
    if (row.applies) static_cast<void>(op.apply(x, y, w));
    if (row.solves) static_cast<void>(op.solve(x, y, w));
    if (std::any_of(memory.data() + size, memory.data() + size + behind, [](double v) { return v != 0.375; })) return true;
  }
  return false;
}

bool same(const Report& a, const Report& b) { return a.status == b.status && a.where == b.where && a.iterations == b.iterations; }
bool same(const Said& a, const Said& b) { return same(a.report, b.report) && judge_bits(a.answer, b.answer).passed(); }

template <class T> std::string forgotten(const OperatorRow& row, const Problem<double>& regular, const Damping<double>& given, bool held) {
  const Problem<T> good = regular.template cast<T>();
  const Damping<T> damping = given.template cast<T>();
  const Index tip = good.structure->first_dof[good.structure->bodies() - 1];
  Problem<T> bad = good;
  for (Index k = 0; k < 36; ++k) bad.H.back().data()[k] = T(0);
  std::fill(bad.armature.begin(), bad.armature.end(), T(0));
  const auto op = row.make<T>();
  op->analyze(good.structure);
  const MatrixX<T> x = vectors<T>(op->size(), 1, 1);
  MatrixX<T> y = x;
  Workspace<T> w(op->workspace(1));
  std::string words;
  const auto expect = [&](const std::string& when, const Report& r, Status status, Index where) {
    if (words.empty() && (r.status != status || (status != Status::ok && r.where != where)))
      words = std::string(row.name) + (held ? ", tip held, " : ", ") + when + ": " + std::string(name(r.status)) + " at " + std::to_string(r.where);
  };
  const auto expect_all = [&](const std::string& when, const Report& updated, Status status, Index where) {
    const bool of_M = status == Status::lost_pivot;
    const bool left_to_solve = of_M && updated.ok() && row.solves;  // M is factored when a certificate is asked for
    if ((!row.applies || of_M) && !left_to_solve) expect(when, updated, status, where);
    if (row.applies) expect(when + ", apply", op->apply(x, y, w), of_M ? status : Status::ok, where);
    if (row.solves) expect(when + ", solve", op->solve(x, y, w), status, where);
  };
  expect_all("singular M", op->update(bad, damping), Status::lost_pivot, tip);
  expect_all("its new damping", op->update_damping(damping), Status::lost_pivot, tip);
  expect_all("regular M", op->update(good, damping), Status::ok, 0);
  const Status refused = row.zero_damping || !row.solves ? Status::ok : Status::zero_damping;
  for (const Index named : {0, 1}) {  // the first row, or the second, depends on those before in R⁻¹
    Damping<T> hard = damping;
    std::fill(hard.diagonal.begin(), hard.diagonal.end(), T(0));
    hard.blocks = {{0, MatrixX<T>::Constant(3, 3, T(0))}};
    for (Index r = 0; r < 3; ++r) hard.blocks[0].R_inverse(r, r) = T(named);
    hard.blocks[0].R_inverse(0, 1) = hard.blocks[0].R_inverse(1, 0) = T(named);
    const Report hardened = op->update_damping(hard);  // not held, one joint has three rows: A may be singular
    if (held || !row.zero_damping) expect_all("singular block", hardened, refused, named);
    if (named == 0) hard.blocks.clear();
    const Report plain = op->update_damping(hard);
    if (named == 0 && (held || !row.zero_damping)) expect_all("hard rows", plain, refused, 0);
    expect_all("damped again", op->update_damping(damping), Status::ok, 0);
  }
  return words;
}

/// A free body, and another one on `tip` freedoms, or none (−1).
Problem<double> free_body(Index tip, bool held) {
  Structure s;
  s.add_body(ground, 6);
  if (tip >= 0) s.add_body(0, tip);
  s.add_link_constraint(3, tip >= 0 && held ? std::vector<Index>{0, 1} : std::vector<Index>{0});
  Problem<double> p(std::make_shared<const Structure>(std::move(s)));
  for (auto& H : p.H) H.diagonal() << 2, 3, 4, 5, 5, 5;
  for (std::size_t c = 0; c < p.S.size(); ++c) {
    p.S[c][static_cast<Index>(c % 6)] = 1;
    if (c >= 6) p.S[c][5 - static_cast<Index>(c % 6)] = 0.5;
  }
  for (std::size_t r = 0; r < p.K.size(); ++r) p.K[r][static_cast<Index>(r)] = 1;
  return p;
}

}  // namespace

Case with_partial_blocks(const Case& c, std::uint64_t seed) {
  const Structure& s = *c.problem.structure;
  Damping<double> d{std::vector<double>(static_cast<std::size_t>(s.rows), 1), {}};
  for (std::size_t r = 0; r < d.diagonal.size(); ++r)
    if (c.damping.diagonal[r] > 0) d.diagonal[r] = c.damping.diagonal[r];
  const auto add = [&](Index row, Index rows) {
    if (rows == 0) return;
    d.blocks.push_back({row, block(rows)});
    std::fill_n(d.diagonal.begin() + row, rows, 0.0);
  };
  const auto constrain = [&](const auto& e) {
    switch (seed++ % 5) {
      case 0: return add(e.row, e.rows);
      case 1: return add(e.row, e.rows - 1);
      case 2: return add(e.row + 1, e.rows - 1);
      case 3: return add(e.row, e.rows / 2), add(e.row + e.rows / 2, e.rows - e.rows / 2);
      default: return;
    }
  };
  std::for_each(s.link_constraints.begin(), s.link_constraints.end(), constrain);
  std::for_each(s.joint_constraints.begin(), s.joint_constraints.end(), constrain);
  std::sort(d.blocks.begin(), d.blocks.end(), [](const auto& a, const auto& b) { return a.row < b.row; });
  return make_case(c.problem, std::move(d), c.label + " with partial blocks", c.seed, c.exact);
}

Case without_freedoms() {
  Structure s;
  s.add_body(ground, 0);
  s.add_body(0, 0);
  s.add_link_constraint(3, {0, 1});
  Problem<double> p(std::make_shared<const Structure>(std::move(s)));
  for (auto& H : p.H) H.setIdentity();
  for (auto& K : p.K) K.setOnes();
  return make_case(std::move(p), Damping<double>::uniform(3, 0.5), "no freedoms", 1, true);
}

Case rows_on_a_free_joint() {
  Structure s;
  s.add_body(ground, 6);
  s.add_body(0, 1);
  s.add_joint_constraint(2, 0);
  s.add_link_constraint(2, {0, 1});
  Problem<double> p(std::make_shared<const Structure>(std::move(s)));
  for (auto& H : p.H) H.diagonal() << 2, 3, 4, 5, 5, 5;
  for (Index c = 0; c < 6; ++c) p.S[static_cast<std::size_t>(c)][c] = 1;
  p.S[6] << 0, 1, 0, 0.5, 0, -1;
  const MatrixX<double> numbers = vectors<double>(static_cast<Index>(6 * p.K.size() + p.joint_K.size()), 1, 3);
  for (std::size_t k = 0; k < p.K.size(); ++k) p.K[k] = numbers.block(static_cast<Index>(6 * k), 0, 6, 1);
  for (std::size_t k = 0; k < p.joint_K.size(); ++k) p.joint_K[k] = numbers(static_cast<Index>(6 * p.K.size() + k), 0);
  return make_case(std::move(p), Damping<double>::uniform(4, 0.25), "rows on a free joint", 1, true);
}

Case three_rows_on_one_freedom(Index hard) {
  Structure s;
  s.add_body(ground, 1);
  s.add_link_constraint(3, {0});
  Problem<double> p(std::make_shared<const Structure>(std::move(s)));
  p.H[0].diagonal() << 2, 3, 4, 5, 5, 5;
  p.S[0] << 0, 0, 1, 0, 1, 0;
  for (Index r = 0; r < 3; ++r) p.K[static_cast<std::size_t>(r)] << 1, 0, 0.5, 0, static_cast<double>(r + 1), 2;
  std::vector<double> R_inverse = {0.5, 0.25};
  R_inverse.insert(R_inverse.begin() + hard, 0);
  return make_case(std::move(p), {R_inverse, {}}, "three rows on one freedom", 1, true);
}

std::string trace_of_use(const OperatorRow& row, const Case& before, const Case& c) {
  const auto fresh = row.make<double>(), used = row.make<double>();
  fresh->analyze(c.problem.structure);
  const Report updated = fresh->update(c.problem, c.damping);
  const Said expected = asked(row, *fresh, c.seed);

  used->analyze(before.problem.structure);
  static_cast<void>(used->update(before.problem, before.damping));
  static_cast<void>(asked(row, *used, before.seed));
  used->analyze(c.problem.structure);
  static_cast<void>(used->update(c.problem, c.damping));
  for (std::uint64_t shift = 1; shift <= 5; ++shift) static_cast<void>(used->update_damping(with_partial_blocks(c, c.seed + shift).damping));
  static_cast<void>(asked(row, *used, c.seed));
  const std::string where = std::string(row.name) + " after " + before.label + " on " + c.label;
  if (!same(used->update_damping(c.damping), updated) || !same(asked(row, *used, c.seed), expected)) return where + ": another answer at a new damping";
  if (!same(used->update(c.problem, c.damping), updated) || !same(asked(row, *used, c.seed), expected)) return where + ": another answer";
  if (oversteps(row, *used)) return where + ": written behind the workspace";
  if (used->bytes() != fresh->bytes() || used->workspace() != fresh->workspace()) return where + ": other memory";
  return {};
}

std::string lost_pivot_forgotten(const OperatorRow& row, bool held) {
  if (held && row.solve_error == ErrorClass::amplified) return {};  // M + JᵀRJ is regular
  generators::Spec spec = generators::find_family("chain").make(3, 1);
  spec.links.resize(1);
  spec.links[0].bodies = {held ? 2 : 0};
  const Problem<double> chain = generators::build(spec).problem;
  // A step that is not one of the simple ones, and the first degree of freedom of all.
  std::vector<Problem<double>> problems = {chain, free_body(2, held)};
  if (held) problems.push_back(free_body(-1, held));
  std::string words;
  for (const Problem<double>& problem : problems) {
    if (words.empty()) words = forgotten<double>(row, problem, Damping<double>::uniform(3, 0.5), held);
    if (words.empty() && std::get<Maker<Rational>>(row.makers)) words = forgotten<Rational>(row, problem, Damping<double>::uniform(3, 0.5), held);
  }
  return words;
}

}  // namespace delassus::laws
