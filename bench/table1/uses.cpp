#include "bench/table1/uses.h"

#include <cmath>

namespace delassus::bench {

const char* name(Use use) {
  constexpr std::array<const char*, use_count> names{"first_apply", "first_solve",   "apply",            "solve",
                                                     "new_damping", "damping_alone", "fast_first_solve", "fast_solve"};
  return names[static_cast<std::size_t>(use)];
}

Asked::Asked(const OperatorRow& row, const Problem<double>& problem, const Damping<double>& damping, const MatrixX<double>& x)
    : row_(row), problem_(problem), damping_(damping), other_(other_damping(damping)), x_(x), out_(MatrixX<double>::Zero(x.rows(), 1)),
      op_(row.make<double>()) {
  try {
    op_->analyze(problem.structure);
    workspace_ = std::make_unique<Workspace<double>>(op_->workspace());
    take_answers();
  } catch (const ModelError& refusal) {
    why_not_.fill(std::string("refused: ") + refusal.what());
    op_.reset();
  }
}

void Asked::update() { report_ = op_->update(problem_, damping_); }

void Asked::take_answers() {
  const auto has_no = [&](std::initializer_list<Use> uses, const std::string& why) {
    for (const Use u : uses)
      if (why_not_[static_cast<std::size_t>(u)].empty()) why_not_[static_cast<std::size_t>(u)] = why;
  };
  const auto solves = {Use::first_solve, Use::solve, Use::new_damping, Use::fast_first_solve, Use::fast_solve};
  const auto applies = {Use::first_apply, Use::apply};
  if (row_.solve_error != ErrorClass::refined) has_no({Use::fast_first_solve, Use::fast_solve}, "has no certificate");
  if (!row_.applies) has_no(applies, "has no apply");
  if (!row_.solves) has_no(solves, "has no solve");
  update();
  if (!report_.ok()) {
    const std::string why(name(report_.status));
    has_no(applies, why), has_no(solves, why), has_no({Use::damping_alone}, why);
    return;
  }
  if (row_.applies) {
    const Report applied = op_->apply(x_, out_, *workspace_);
    if (!applied.ok()) has_no(applies, std::string(name(applied.status)));
    product_ = out_;
  }
  if (row_.solves) {
    solved_ = op_->solve(x_, out_, *workspace_);
    if (!solved_.ok()) has_no(solves, std::string(name(solved_.status)));
    solution_ = out_;
  }
}

void Asked::ask(Use use) {
  const auto solve = [&](Accuracy wanted) { report_ = op_->solve(x_, out_, wanted, *workspace_); };
  const auto other = [&] { report_ = op_->update_damping((odd_ = !odd_) ? other_ : damping_); };
  switch (use) {
    case Use::first_apply: update(), report_ = op_->apply(x_, out_, *workspace_); break;
    case Use::first_solve: update(), solve(Accuracy::full()); break;
    case Use::apply: report_ = op_->apply(x_, out_, *workspace_); break;
    case Use::solve: solve(Accuracy::full()); break;
    case Use::new_damping: other(), solve(Accuracy::full()); break;
    case Use::damping_alone: other(); break;
    case Use::fast_first_solve: update(), solve(Accuracy::fastest()); break;
    case Use::fast_solve: solve(Accuracy::fastest()); break;
  }
}

VectorX<double> sample_vector(Index n) {
  VectorX<double> x(n);
  for (Index i = 0; i < n; ++i) {
    const double t = static_cast<double>(i + 1) * 0.6180339887498949;
    x[i] = t - std::floor(t) - 0.5;
  }
  return x;
}

Damping<double> other_damping(Damping<double> damping) {
  for (double& d : damping.diagonal) d *= 1.5;
  for (auto& block : damping.blocks) block.R_inverse *= 1.5;
  return damping;
}

}  // namespace delassus::bench
