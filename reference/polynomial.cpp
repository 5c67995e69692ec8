#include "reference/polynomial.h"

#include <algorithm>
#include <utility>

namespace delassus::reference {
namespace {

int sign_of(const Rational& x) { return sgn(x.v); }

std::vector<Polynomial> sturm(const Polynomial& p) {
  std::vector<Polynomial> chain{p, p.derivative()};
  while (!chain.back().zero()) chain.push_back(remainder(chain[chain.size() - 2], chain.back()) * Polynomial(Rational(-1)));
  chain.pop_back();
  return chain;
}

int changes(const std::vector<Polynomial>& chain, const Rational& x) {
  int count = 0, last = 0;
  for (const Polynomial& p : chain) {
    const int s = sign_of(p.at(x));
    if (s == 0) continue;
    count += last != 0 && s != last;
    last = s;
  }
  return count;
}

// The values of q over [low, high] lie within these.
std::pair<Rational, Rational> range(const Polynomial& q, const Rational& low, const Rational& high) {
  Rational least(0), most(0);
  for (Index k = q.degree(); k >= 0; --k) {  // Horner with intervals
    const Rational products[4] = {least * low, least * high, most * low, most * high};
    least = *std::min_element(products, products + 4) + q[k];
    most = *std::max_element(products, products + 4) + q[k];
  }
  return {least, most};
}

}  // namespace

Polynomial::Polynomial(std::vector<Rational> ascending) : a_(std::move(ascending)) {
  while (!a_.empty() && a_.back() == Rational(0)) a_.pop_back();
}

Rational Polynomial::at(const Rational& x) const {
  Rational y(0);
  for (std::size_t k = a_.size(); k-- > 0;) y = y * x + a_[k];
  return y;
}

Polynomial Polynomial::derivative() const {
  std::vector<Rational> d;
  for (std::size_t k = 1; k < a_.size(); ++k) d.push_back(a_[k] * Rational(static_cast<long>(k)));
  return d;
}

Polynomial operator+(const Polynomial& a, const Polynomial& b) {
  std::vector<Rational> sum(std::max(a.a_.size(), b.a_.size()), Rational(0));
  for (std::size_t k = 0; k < a.a_.size(); ++k) sum[k] += a.a_[k];
  for (std::size_t k = 0; k < b.a_.size(); ++k) sum[k] += b.a_[k];
  return sum;
}

Polynomial operator*(const Polynomial& a, const Polynomial& b) {
  if (a.zero() || b.zero()) return {};
  std::vector<Rational> product(a.a_.size() + b.a_.size() - 1, Rational(0));
  for (std::size_t i = 0; i < a.a_.size(); ++i)
    for (std::size_t j = 0; j < b.a_.size(); ++j) product[i + j] += a.a_[i] * b.a_[j];
  return product;
}

Polynomial remainder(Polynomial a, const Polynomial& b) {
  while (a.degree() >= b.degree() && !a.zero()) {
    std::vector<Rational> factor(static_cast<std::size_t>(a.degree() - b.degree()) + 1, Rational(0));
    factor.back() = a[a.degree()] / b[b.degree()];
    a = a - b * Polynomial(factor);
  }
  return a;
}

Polynomial common_divisor(Polynomial a, Polynomial b) {
  while (!b.zero()) {
    Polynomial r = remainder(a, b);
    a = std::exchange(b, std::move(r));
  }
  return a.zero() ? a : a * Polynomial(Rational(1) / a[a.degree()]);
}

RealRoot::RealRoot(Polynomial square_free, Rational low, Rational high) : p_(std::move(square_free)), low_(std::move(low)), high_(std::move(high)) {}

void RealRoot::halve(Rational& low, Rational& high) const {
  const Rational middle = (low + high) / Rational(2);
  const int here = sign_of(p_.at(middle));
  if (here == 0) low = high = middle;
  else if (here == sign_of(p_.at(low))) low = middle;
  else high = middle;
}

int RealRoot::sign(const Polynomial& q) const {
  if (q.zero()) return 0;
  if (low_ == high_) return sign_of(q.at(low_));
  const Polynomial common = common_divisor(p_, q);
  if (common.degree() > 0 && sign_of(common.at(low_)) * sign_of(common.at(high_)) < 0) return 0;
  for (Rational low = low_, high = high_;;) {
    const auto [least, most] = range(q, low, high);
    if (least > Rational(0)) return 1;
    if (most < Rational(0)) return -1;
    if (low == high) return sign_of(q.at(low));
    halve(low, high);
  }
}

Rational RealRoot::within(const Rational& width) const {
  Rational low = low_, high = high_;
  while (high - low > width) halve(low, high);
  return (low + high) / Rational(2);
}

std::vector<RealRoot> real_roots(const Polynomial& p) {
  const Polynomial common = common_divisor(p, p.derivative());
  Polynomial square_free = p;
  if (common.degree() > 0) {  // p / common
    std::vector<Rational> quotient(static_cast<std::size_t>(p.degree() - common.degree()) + 1, Rational(0));
    for (Polynomial rest = p; rest.degree() >= common.degree() && !rest.zero();) {
      const Index k = rest.degree() - common.degree();
      const Rational factor = rest[rest.degree()] / common[common.degree()];
      std::vector<Rational> term(static_cast<std::size_t>(k) + 1, Rational(0));
      term.back() = factor;
      quotient[static_cast<std::size_t>(k)] = factor;
      rest = rest - common * Polynomial(term);
    }
    square_free = Polynomial(quotient);
  }
  std::vector<RealRoot> roots;
  if (square_free.degree() < 1) return roots;
  Rational bound(1);  // Cauchy's
  for (Index k = 0; k < square_free.degree(); ++k) bound = std::max(bound, Rational(1) + abs(square_free[k] / square_free[square_free.degree()]));
  const auto chain = sturm(square_free);
  std::vector<std::pair<Rational, Rational>> pending{{-bound, bound}};
  while (!pending.empty()) {
    const auto [low, high] = pending.back();
    pending.pop_back();
    const int count = changes(chain, low) - changes(chain, high);  // in (low, high]
    if (count == 0) continue;
    if (sign_of(square_free.at(high)) == 0) {
      if (count == 1) {
        roots.emplace_back(square_free, high, high);
        continue;
      }
    } else if (count == 1 && sign_of(square_free.at(low)) != 0) {
      roots.emplace_back(square_free, low, high);
      continue;
    }
    const Rational middle = (low + high) / Rational(2);
    pending.emplace_back(middle, high);
    pending.emplace_back(low, middle);  // on top: roots come out ascending
  }
  return roots;
}

}  // namespace delassus::reference
