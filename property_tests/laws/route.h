// One way to an answer: an operator prepared on a problem. Used by the laws only.
#pragma once

#include "generators/random.h"
#include "property_tests/laws/known.h"

namespace delassus::laws {

template <class T> using Dense = MatrixX<Wide<T>>;

/// A status other than ok where an answer was promised.
struct Broken : std::runtime_error {
  Broken(const char* phase, const Report& r)
      : std::runtime_error(std::string(phase) + ": " + std::string(name(r.status)) + (r.where < 0 ? "" : " at " + std::to_string(r.where))),
        status(r.status) {}
  Status status;
};

/// What an operator came to, whatever that is: an answer, or a refusal.
template <class T> struct Ran {
  Report updated, called;
  MatrixX<T> y;
};

template <class T> class Route {
 public:
  Route(const OperatorRow& row, const Problem<T>& problem, const Damping<T>& damping) : op_(row.make<T>()) {
    op_->analyze(problem.structure);
    updated_ = op_->update(problem, damping);
  }
  /// A x or A⁻¹ x in the operator's own scalar. Shapes m×k. @throws Broken.
  [[nodiscard]] MatrixX<T> narrow(Function f, const MatrixX<T>& x) const {
    Workspace<T> w(op_->workspace(x.cols()));
    return narrow(f, x, w);
  }
  [[nodiscard]] MatrixX<T> narrow(Function f, const MatrixX<T>& x, Workspace<T>& w) const {
    if (f == Function::solve && !updated_.ok()) throw Broken("update", updated_);
    Ran<T> r = run(f, x, w);
    if (!r.called.ok()) throw Broken(f == Function::apply ? "apply" : "solve", r.called);
    return std::move(r.y);
  }
  /// The same in the scalar errors are computed in.
  [[nodiscard]] MatrixX<Wide<T>> operator()(Function f, const MatrixX<T>& x) const {
    return converted<Wide<T>>(narrow(f, x));
  }
  /// The same, refusals included.
  [[nodiscard]] Ran<T> run(Function f, const MatrixX<T>& x) const {
    Workspace<T> w(op_->workspace(x.cols()));
    return run(f, x, w);
  }
  [[nodiscard]] Ran<T> run(Function f, const MatrixX<T>& x, Workspace<T>& w) const {
    MatrixX<T> y = MatrixX<T>::Zero(x.rows(), x.cols());
    const Report r = f == Function::apply ? op_->apply(x, y, w) : op_->solve(x, y, w);
    return {updated_, r, std::move(y)};
  }
  /// What update said last.
  Report& updated() { return updated_; }
  Operator<T>& get() { return *op_; }

 private:
  std::unique_ptr<Operator<T>> op_;
  Report updated_;
};

/// The same outcome: the same statuses, places and numbers of steps, and the same bits.
[[nodiscard]] inline Verdict judge_runs(const Ran<double>& x, const Ran<double>& y) {
  const auto same = [](const Report& a, const Report& b) {
    return a.status == b.status && a.where == b.where && a.iterations == b.iterations;
  };
  const auto words = [](const Ran<double>& r) {
    return std::string(name(r.updated.status)) + ", " + std::string(name(r.called.status)) + " at " +
           std::to_string(r.called.where) + " after " + std::to_string(r.called.iterations) + " steps";
  };
  if (same(x.updated, y.updated) && same(x.called, y.called)) return judge_bits(x.y, y.y);
  return failure(words(x) + "; " + words(y), "identical bits");
}

/// Entries k/8, |k| ≤ 8, never zero: sums and products with small integers are exact. Shapes m×k.
template <class T> [[nodiscard]] MatrixX<T> vectors(Index rows, Index columns, std::uint64_t seed) {
  generators::Random random(seed * 7919 + 5);
  MatrixX<T> x(rows, columns);
  for (Index c = 0; c < columns; ++c)
    for (Index r = 0; r < rows; ++r) {
      const int k = random.integer(1, 8);
      x(r, c) = T((random.coin() ? k : -k) / 8.0);
    }
  return x;
}

/// x = y within eps · bound (double), or equal (Rational). `bound` is evaluated for double only.
template <class T, class Bound>
[[nodiscard]] Verdict agree(const MatrixX<Wide<T>>& x, const MatrixX<Wide<T>>& y, std::string_view name, Bound bound) {
  if constexpr (ScalarTraits<T>::exact) return judge_equal(x, y);
  else return judge(x - y, bound(), unit_roundoff<T>, name);
}

/// The problem and damping of a case in another scalar.
template <class T> [[nodiscard]] Variant<T> numbers(const Case& c) {
  return {c.problem.template cast<T>(), c.damping.template cast<T>()};
}

/// |x| of a matrix.
template <class T> [[nodiscard]] MatrixX<T> magnitude(MatrixX<T> x) {
  for (Index c = 0; c < x.cols(); ++c)
    for (Index r = 0; r < x.rows(); ++r) x(r, c) = abs(T(x(r, c)));
  return x;
}

/// Rounded to the operator's scalar.
template <class T> [[nodiscard]] MatrixX<T> narrowed(const MatrixX<Wide<T>>& x) { return converted<T>(x); }

/// X Y, also for scalars for which Eigen's blocked product is slow to compile.
template <class T> [[nodiscard]] MatrixX<T> times(const MatrixX<T>& X, const MatrixX<T>& Y) { return reference::product<T>(X, Y); }

}  // namespace delassus::laws
