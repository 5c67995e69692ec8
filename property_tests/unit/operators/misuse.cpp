#include "algorithms/kit/test_scalars.h"
#include "property_tests/unit/operators/misuse.h"

#include <algorithm>
#include <functional>
#include <new>
#include <stdexcept>

#include "property_tests/laws/verdict.h"

namespace delassus {
namespace {

// Two bodies; rows 0–2 link them, 3–4 belong to a joint, 5 to one body.
std::shared_ptr<const Structure> structure() {
  Structure s;
  s.add_body(ground, 6);
  s.add_body(0, 2);
  s.add_link_constraint(3, {0, 1});
  s.add_joint_constraint(2, 1);
  s.add_link_constraint(1, {1});
  return std::make_shared<const Structure>(std::move(s));
}

Problem<double> problem_on(std::shared_ptr<const Structure> s) {
  Problem<double> p(std::move(s));
  for (auto& H : p.H) H.setIdentity();
  for (std::size_t c = 0; c < p.S.size(); ++c) p.S[c][static_cast<Index>(c % 6)] = 1;
  for (std::size_t r = 0; r < p.K.size(); ++r) p.K[r][static_cast<Index>(r % 6)] = 1;
  p.joint_K = {1, 0, 0, 1};
  return p;
}

#if !defined(__SANITIZE_ADDRESS__)
/// One constraint whose damping may be a block that no machine holds.
std::shared_ptr<const Structure> beyond_memory() {
  Structure s;
  s.add_body(ground, 1);
  s.add_link_constraint(30'000'000, {0});
  return std::make_shared<const Structure>(std::move(s));
}
#endif

struct Square {
  Index row, size;
};

Damping<double> damped(std::initializer_list<Square> squares) {
  Damping<double> d = Damping<double>::uniform(6, 1);
  for (const Square& b : squares) {
    d.blocks.push_back({b.row, MatrixX<double>::Identity(b.size, b.size)});
    for (Index row = std::max<Index>(b.row, 0); row < std::min<Index>(b.row + b.size, 6); ++row) d.diagonal[static_cast<std::size_t>(row)] = 0;
  }
  return d;
}

template <class Error = std::logic_error> bool throws(const std::function<Report()>& use) {
  try {
    static_cast<void>(use());
  } catch (const Error&) {
    return true;
  }
  return false;
}

std::string wrong_sizes(Operator<double>& op, const Problem<double>& problem) {
  const Damping<double> proper[] = {damped({}), damped({{0, 3}}), damped({{1, 2}}), damped({{0, 2}, {2, 1}}), damped({{3, 2}}),
                                    damped({{3, 1}, {4, 1}}), damped({{5, 1}}), damped({{0, 3}, {3, 2}, {5, 1}})};
  for (const auto& d : proper)
    if (throws([&] { return op.update(problem, d); }) || throws([&] { return op.update_damping(d); }))
      return "refuses a damping with " + std::to_string(d.blocks.size()) + " blocks, the first at " + std::to_string(d.blocks.empty() ? -1 : d.blocks[0].row);
  Damping<double> wrong[] = {Damping<double>::uniform(5, 1), Damping<double>::uniform(7, 1), damped({{0, 4}}), damped({{2, 2}}),
                             damped({{4, 2}}), damped({{-1, 2}}), damped({{5, 2}}), damped({{0, 2}, {1, 2}}), damped({{3, 1}, {0, 1}}),
                             damped({{0, 1}, {2, 2}}), damped({{1, 0}}), damped({}), damped({})};
  std::end(wrong)[-2].blocks.push_back({0, MatrixX<double>::Identity(2, 3)});
  std::end(wrong)[-1].blocks.push_back({0, MatrixX<double>::Identity(3, 2)});
  for (const auto& d : wrong)
    if (!throws([&] { return op.update(problem, d); }) || !throws([&] { return op.update_damping(d); }))
      return "takes damping " + std::to_string(&d - wrong) + " of the wrong ones";
  return {};
}

std::string wrong_phase(const OperatorRow& row, const Problem<double>& problem) {
  const auto op = row.make<double>();
  const MatrixX<double> x = MatrixX<double>::Ones(6, 2);
  MatrixX<double> y = x;
  Workspace<double> w(10000);
  const auto use = [&] { return row.applies ? op->apply(x, y, w) : op->solve(x, y, w); };
  if (!throws([&] { op->analyze(nullptr); return Report{}; })) return "analyzes nothing";
  auto gap = std::make_shared<Structure>(*problem.structure);
  ++gap->rows;
  if (!throws<ModelError>([&] { op->analyze(gap); return Report{}; })) return "analyzes a structure with a row of no constraint";
  if (!throws([&] { return op->update(problem, damped({})); })) return "updates before analyze";
  if (!throws([&] { return static_cast<void>(op->workspace()), Report{}; }) || !throws([&] { return static_cast<void>(op->bytes()), Report{}; }))
    return "knows its memory before analyze";
  op->analyze(problem.structure);
  if (!throws([&] { return op->update_damping(damped({})); })) return "updates the damping before the numbers";
  if (!throws(use)) return "answers before update";
  if (!throws([&] { return op->update(problem_on(structure()), damped({})); })) return "takes another structure";
  Problem<double> shorter = problem;
  shorter.K.pop_back();
  if (!throws([&] { return op->update(shorter, damped({})); })) return "takes a problem that lacks a row";
  static_cast<void>(op->update(problem, damped({})));
  if (throws(use)) return "does not answer";
#if !defined(__SANITIZE_ADDRESS__)  // which ends the program
  if (!throws<std::bad_alloc>([&] { op->analyze(beyond_memory()); return Report{}; })) return "finds memory for a block of 10¹⁵ numbers";
  if (!throws([&] { return op->update(problem, damped({})); }) || !throws(use)) return "is analyzed after an analyze that threw";
  op->analyze(problem.structure);
  static_cast<void>(op->update(problem, damped({})));
  if (throws(use)) return "does not answer after an analyze that threw";
#endif
  op->analyze(problem.structure);
  if (!throws(use)) return "answers after analyze alone";
  return {};
}

/// Input and output in one matrix: any number of both is refused, columns side by side and rows one above the other are not.
std::string shared_numbers(const OperatorRow& row, Operator<double>& op) {
  MatrixX<double> all = MatrixX<double>::Ones(13, 4);
  Workspace<double> w(op.workspace(2));
  const auto used = [&](Index in_row, Index in_column, Index out_row, Index out_column, Index columns) {
    const auto in = all.block(in_row, in_column, 6, columns);
    auto out = all.block(out_row, out_column, 6, columns);
    const bool applied = row.applies && !throws([&] { return op.apply(in, out, w); });
    const bool solved = row.solves && !throws([&] { return op.solve(in, out, w); });
    return applied || solved;
  };
  if (!used(0, 0, 6, 0, 2) || !used(7, 0, 1, 0, 2) || !used(0, 0, 0, 2, 2) || !used(0, 2, 0, 0, 2) || !used(0, 0, 6, 1, 2) || !used(6, 1, 0, 0, 2))
    return "refuses two parts of one matrix";
  if (used(0, 0, 5, 0, 1) || used(5, 0, 0, 0, 1) || used(0, 0, 3, 0, 2) || used(3, 0, 0, 0, 2) || used(0, 0, 0, 1, 2) || used(0, 1, 0, 0, 2) || used(0, 0, 5, 1, 2))
    return "writes where it reads";
  return {};
}

std::string wrong_shape(const OperatorRow& row, Operator<double>& op) {
  const auto refuses = [&](Index rows, Index columns, Index out_rows, Index out_columns, Index scalars) {
    const MatrixX<double> x = MatrixX<double>::Ones(rows, columns);
    MatrixX<double> y = MatrixX<double>::Ones(out_rows, out_columns);
    Workspace<double> w(scalars);
    const bool applied = !row.applies || throws([&] { return op.apply(x, y, w); });
    const bool solved = !row.solves || throws([&] { return op.solve(x, y, w); });
    return applied && solved && (!row.solves || throws([&] { return op.solve(x, y, Accuracy::full(), w); }));
  };
  const Index enough = op.workspace(2);
  if (refuses(6, 2, 6, 2, enough) || refuses(6, 0, 6, 0, enough)) return "refuses what fits";
  if (!refuses(5, 2, 6, 2, enough) || !refuses(6, 2, 5, 2, enough) || !refuses(7, 2, 7, 2, enough)) return "takes other rows";
  if (!refuses(6, 2, 6, 1, enough) || !refuses(6, 1, 6, 2, enough)) return "takes other columns";
  if (enough > 0 && !refuses(6, 2, 6, 2, enough - 1)) return "takes a workspace too small";
  MatrixX<double> x = MatrixX<double>::Ones(6, 2);
  Workspace<double> w(enough);
  if (row.applies && !throws([&] { return op.apply(x, x, w); })) return "applies in place";
  if (row.solves && !throws([&] { return op.solve(x, x, w); })) return "solves in place";
  if (std::string words = shared_numbers(row, op); !words.empty()) return words;
  MatrixX<double> y = x;
  for (const double error : {-1.0, std::numeric_limits<double>::quiet_NaN()})
    if (row.solves && !throws([&] { return op.solve(x, y, Accuracy{error}, w); })) return "wants an error that is no number";
  if (row.solves && !throws([&] { return op.solve(x, y, Accuracy{0, -1}, w); })) return "wants fewer steps than none";
  if (row.solves && throws([&] { return op.solve(x, y, Accuracy::fastest(), w); })) return "refuses to be fast";
  return {};
}

/// One row, A = 2: one number is answered too, a NaN is not; no column: nothing to say, even of a singular M.
std::string little_answered(const OperatorRow& row) {
  Structure s;
  s.add_body(ground, 1);
  s.add_link_constraint(1, {0});
  Problem<double> p(std::make_shared<const Structure>(std::move(s)));
  p.S[0][0] = p.K[0][0] = 1;
  p.H[0].setIdentity();
  const auto op = row.make<double>();
  op->analyze(p.structure);
  Workspace<double> w(op->workspace(1));
  MatrixX<double> x = MatrixX<double>::Constant(1, 1, 3), y(1, 1), none(1, 0), no_answer(1, 0);
  const std::function<Report(const MatrixX<double>&, MatrixX<double>&)> ways[] = {
      [&](const auto& in, auto& out) { return op->apply(in, out, w); }, [&](const auto& in, auto& out) { return op->solve(in, out, w); },
      [&](const auto& in, auto& out) { return op->solve(in, out, Accuracy::full(), w); }, [&](const auto& in, auto& out) { return op->solve(in, out, {0.5}, w); }};
  for (const auto& way : ways) {
    if (&way == ways ? !row.applies : !row.solves) continue;
    static_cast<void>(op->update(p, Damping<double>::uniform(1, 1)));
    const double expected = &way == ways ? 6 : 1.5;
    x(0, 0) = 3;
    y(0, 0) = 0;
    if (!way(x, y).ok() || !laws::judge(y.cast<Quad>() - MatrixX<Quad>::Constant(1, 1, Quad(expected)), MatrixX<Quad>::Constant(1, 1, Quad(expected)), unit_roundoff<float>, "itself").passed())
      return "does not answer one number";
    x(0, 0) = std::numeric_limits<double>::quiet_NaN();
    if (way(x, y).status != Status::not_finite) return "takes a NaN for a number";
    Problem<double> singular = p;
    singular.H[0].setZero();
    static_cast<void>(op->update(singular, Damping<double>::uniform(1, 1)));
    if (!way(none, no_answer).ok()) return "refuses nothing";
  }
  return {};
}

}  // namespace

std::string misuse_accepted(const OperatorRow& row) {
  const Problem<double> problem = problem_on(structure());
  const auto op = row.make<double>();
  op->analyze(problem.structure);
  std::string words = wrong_sizes(*op, problem);
  if (words.empty()) words = wrong_phase(row, problem);
  static_cast<void>(op->update(problem, damped({})));
  if (words.empty()) words = wrong_shape(row, *op);
  if (words.empty()) words = little_answered(row);
  return words.empty() ? words : std::string(row.name) + " " + words;
}

}  // namespace delassus
