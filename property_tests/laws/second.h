// An operator on two descriptions whose rows correspond. Used by the laws only.
#pragma once

#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/laws_algebra.h"
#include "property_tests/laws/parts.h"
#include "property_tests/laws/route.h"

namespace delassus::laws {

/// x on the rows of the second description; 0 on added ones. Shapes m×k → from.size()×k.
template <class T> [[nodiscard]] MatrixX<T> spread(const MatrixX<T>& x, const std::vector<Index>& from) {
  MatrixX<T> out = MatrixX<T>::Constant(static_cast<Index>(from.size()), x.cols(), T(0));
  for (Index r = 0; r < out.rows(); ++r)
    if (from[static_cast<std::size_t>(r)] >= 0) out.row(r) = x.row(from[static_cast<std::size_t>(r)]);
  return out;
}

/// Back: the sum of the rows with the same origin, 0 where a row has none there. Shapes from.size()×k → m×k.
template <class T> [[nodiscard]] MatrixX<T> gathered(const MatrixX<T>& y, const std::vector<Index>& from, Index rows) {
  MatrixX<T> out = MatrixX<T>::Constant(rows, y.cols(), T(0));
  for (Index r = 0; r < y.rows(); ++r)
    if (from[static_cast<std::size_t>(r)] >= 0) out.row(from[static_cast<std::size_t>(r)]) += y.row(r);
  return out;
}

/// x, zero on the rows that no row of the second description comes from.
template <class T> [[nodiscard]] MatrixX<T> restricted(const MatrixX<T>& x, const std::vector<Index>& from) {
  MatrixX<T> out = MatrixX<T>::Constant(x.rows(), x.cols(), T(0));
  for (const Index r : from)
    if (r >= 0) out.row(r) = x.row(r);
  return out;
}

/// The case of a second description, made once.
template <class Make>
[[nodiscard]] const Case& second_case(const Case& c, const char* name, Make make, Data data = Data::rounded) {
  return variant(c, name, [&](const Case& of) { return make(of.problem, of.damping).numbers; }, data);
}

/// Reason why F of the case and of the other one cannot be compared.
template <class T> [[nodiscard]] const char* why_not_second(Function f, const OperatorRow& op, const Case& c, const Case& other) {
  if (const char* reason = why_not<T>(f, op, c)) return reason;
  if (f == Function::solve && !op.zero_damping && !damped(other)) return "needs R⁻¹ > 0";
  if (const char* reason = why_no_bound(f, other)) return reason;
  return ScalarTraits<T>::exact ? nullptr : why_not<double>(f, op, other);
}

/// F x = F' x' on the rows both have, where x is zero on the others. The bound is that of the case, and that of `other`
/// (of the case again where the second description has the same M and J: pass c itself with `same_matrices`).
template <class T>
[[nodiscard]] Verdict same_answer(Function f, const OperatorRow& op, const Case& c, const Second<T>& second,
                                  const Case& other, bool same_matrices = false) {
  const auto [p, d] = numbers<T>(c);
  const MatrixX<T> x = restricted<T>(vectors<T>(c.rows(), 2, c.seed), second.from);
  const MatrixX<T> there = spread<T>(x, second.from);
  const Dense<T> first = restricted<Wide<T>>(Route<T>(op, p, d)(f, x), second.from);
  const Dense<T> answer = gathered<Wide<T>>(Route<T>(op, second.numbers.problem, second.numbers.damping)(f, there), second.from, c.rows());
  return agree<T>(first, answer, bound_name(f, op, same_matrices ? Data::given : other.known->data), [&]() -> MatrixX<Quad> {
    if constexpr (ScalarTraits<T>::exact) return {};
    else {
      const MatrixX<Quad> own = error_bound(f, op, c, x);
      return own + (same_matrices ? own : gathered<Quad>(error_bound(f, op, other, there), second.from, c.rows()));
    }
  });
}

/// F with some rows eliminated: Y − Z W⁻¹ Y_out with (Y Z) = F (x E), E the unit vectors of the rows out, W = Z_out.
/// First-order bound: b(Y) + b(Z)|g| + |Z W⁻¹| (b(Y_out) + b(W)|g|), g = W⁻¹ Y_out. Rows out are zero.
template <class T> class Eliminated {
 public:
  Eliminated(Function f, const OperatorRow& op, const Case& c, const Problem<T>& p, const Damping<T>& d,
             const MatrixX<T>& x, std::vector<Index> out)
      : out_(std::move(out)) {
    MatrixX<T> columns = MatrixX<T>::Constant(x.rows(), x.cols() + count(), T(0));
    columns.leftCols(x.cols()) = x;
    for (Index k = 0; k < count(); ++k) columns(out_[static_cast<std::size_t>(k)], x.cols() + k) = T(1);
    const Dense<T> both = Route<T>(op, p, d)(f, columns);
    Y_ = both.leftCols(x.cols());
    Z_ = both.rightCols(count());
    const reference::PivotedLdlt<Wide<T>> W(picked(Z_));
    regular_ = W.regular();
    W_inverse_ = ScalarTraits<T>::exact || regular_ ? W.inverse() : Dense<T>(Dense<T>::Constant(count(), count(), Wide<T>(0)));
    if constexpr (!ScalarTraits<T>::exact) bound_ = error_bound(f, op, c, columns);
  }

  [[nodiscard]] Dense<T> value() const {
    Dense<T> y = Y_ - times<Wide<T>>(Z_, force());
    for (const Index r : out_) y.row(r).setConstant(Wide<T>(0));
    return y;
  }
  [[nodiscard]] MatrixX<Quad> bound() const {
    const MatrixX<Quad> g = magnitude(force()), ZW = magnitude(times<Quad>(Z_, W_inverse_));
    const MatrixX<Quad> bY = bound_.leftCols(Y_.cols()), bZ = bound_.rightCols(count());
    const MatrixX<Quad> inner = picked(bY) + times<Quad>(picked(bZ), g);
    return bY + times<Quad>(bZ, g) + times<Quad>(ZW, inner);
  }
  /// The bound holds to first order: W is regular whatever the errors allowed in it.
  [[nodiscard]] bool certain() const {
    const MatrixX<Quad> change = times<Quad>(magnitude(W_inverse_), picked(MatrixX<Quad>(bound_.rightCols(count()))));
    Quad largest(0);
    for (Index r = 0; r < change.rows(); ++r) largest = std::max(largest, Quad(change.row(r).sum()));
    return regular_ && Quad(2 * pass_below * unit_roundoff<double>) * largest < Quad(1);
  }

 private:
  [[nodiscard]] Index count() const { return static_cast<Index>(out_.size()); }
  template <class W> [[nodiscard]] MatrixX<W> picked(const MatrixX<W>& x) const {
    MatrixX<W> y(count(), x.cols());
    for (Index k = 0; k < count(); ++k) y.row(k) = x.row(out_[static_cast<std::size_t>(k)]);
    return y;
  }
  [[nodiscard]] Dense<T> force() const { return times<Wide<T>>(W_inverse_, picked(Y_)); }

  std::vector<Index> out_;
  bool regular_ = true;
  Dense<T> Y_, Z_, W_inverse_;
  MatrixX<Quad> bound_;
};

}  // namespace delassus::laws
