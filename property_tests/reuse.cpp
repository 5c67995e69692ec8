#include "property_tests/reuse.h"

#include <algorithm>

#include "property_tests/route.h"

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

bool same(const Report& a, const Report& b) { return a.status == b.status && a.where == b.where && a.iterations == b.iterations; }
bool same(const Said& a, const Said& b) { return same(a.report, b.report) && judge_bits(a.answer, b.answer).passed(); }

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

std::string trace_of_use(const OperatorRow& row, const Case& before, const Case& c) {
  const auto fresh = row.make<double>(), used = row.make<double>();
  fresh->analyze(c.problem.structure);
  const Report updated = fresh->update(c.problem, c.damping);
  const Said expected = asked(row, *fresh, c.seed);

  used->analyze(before.problem.structure);
  static_cast<void>(used->update(before.problem, before.damping));
  static_cast<void>(asked(row, *used, before.seed));
  used->analyze(c.problem.structure);
  const Case blocks = with_partial_blocks(c, c.seed);
  static_cast<void>(used->update(blocks.problem, blocks.damping));
  static_cast<void>(asked(row, *used, c.seed));
  const std::string where = std::string(row.name) + " after " + before.label + " on " + c.label;
  if (!same(used->update_damping(c.damping), updated) || !same(asked(row, *used, c.seed), expected)) return where + ": another answer at a new damping";
  if (!same(used->update(c.problem, c.damping), updated) || !same(asked(row, *used, c.seed), expected)) return where + ": another answer";
  if (used->bytes() != fresh->bytes()) return where + ": other memory";
  return {};
}

}  // namespace delassus::laws
