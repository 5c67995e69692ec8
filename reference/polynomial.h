// Polynomials of one variable with rational coefficients, and their real roots, exactly.
//
// How      Sturm's sequence counts the roots in (a, b]; bisection until each interval holds one. A root is then that interval and the
//          square-free polynomial; the sign of another polynomial there is 0 where their common divisor has the root, and else what
//          interval arithmetic on a narrow enough interval says.
// Cost     for the degrees of the contact oracle (8 at most) no matter.
// Source   C. Sturm 1829.
#pragma once

#include <vector>

#include "algorithms/kit/exact.h"
#include "algorithms/kit/spatial.h"

namespace delassus::reference {

/// Σ a_k x^k; no leading zeros, empty: 0.
class Polynomial {
 public:
  Polynomial() = default;
  Polynomial(std::vector<Rational> ascending);
  Polynomial(const Rational& constant) : Polynomial(std::vector<Rational>{constant}) {}
  [[nodiscard]] bool zero() const { return a_.empty(); }
  [[nodiscard]] Index degree() const { return static_cast<Index>(a_.size()) - 1; }  ///< −1: zero
  [[nodiscard]] const Rational& operator[](Index k) const { return a_[static_cast<std::size_t>(k)]; }
  [[nodiscard]] Rational at(const Rational& x) const;
  [[nodiscard]] Polynomial derivative() const;
  friend Polynomial operator+(const Polynomial& a, const Polynomial& b);
  friend Polynomial operator*(const Polynomial& a, const Polynomial& b);
  friend Polynomial operator-(const Polynomial& a, const Polynomial& b) { return a + b * Polynomial(Rational(-1)); }

 private:
  std::vector<Rational> a_;
};

/// a modulo b, b not zero.
[[nodiscard]] Polynomial remainder(Polynomial a, const Polynomial& b);
/// The monic greatest common divisor.
[[nodiscard]] Polynomial common_divisor(Polynomial a, Polynomial b);

/// One real root of a square-free polynomial, alone in [low, high]; low = high where it is known exactly.
class RealRoot {
 public:
  RealRoot(Polynomial square_free, Rational low, Rational high);
  /// −1, 0 or 1: the sign of q at the root.
  [[nodiscard]] int sign(const Polynomial& q) const;
  /// The root within ± width.
  [[nodiscard]] Rational within(const Rational& width) const;

 private:
  void halve(Rational& low, Rational& high) const;
  Polynomial p_;
  Rational low_, high_;
};

/// All real roots of p, each once, ascending. p not zero.
[[nodiscard]] std::vector<RealRoot> real_roots(const Polynomial& p);

}  // namespace delassus::reference
