#include "reference/contact_slips.h"

#include "reference/interval.h"

namespace delassus::reference {
namespace {

using Box = std::array<Interval, 4>;
using Sides = std::array<double, 4>;

Interval enclosed(const Rational& x) {
  const auto d = static_cast<double>(x);
  return outwards(d, d);
}

// Both are monotone: of t² and of t in [−1, 1]. Slightly beyond 1 the sine is covered by 1.
Interval cosine(const Interval& t) {
  const double most = std::max(std::abs(t.low), std::abs(t.high)), least = t.has_zero() ? 0 : std::min(std::abs(t.low), std::abs(t.high));
  const auto f = [](double x) { return (1 - x * x) / (1 + x * x); };
  const Interval r = outwards(f(most), f(least));
  return {r.low - 0x1p-50, r.high + 0x1p-50};
}
Interval sine(const Interval& t) {
  const auto f = [](double x) { return 2 * x / (1 + x * x); };
  Interval r{std::min(f(t.low), f(t.high)) - 0x1p-50, std::max(f(t.low), f(t.high)) + 0x1p-50};
  if (t.low <= 1 && t.high >= 1) r.high = 1;
  if (t.low <= -1 && t.high >= -1) r.low = -1;
  return r;
}
// 1/(1 + t²), falling in t²
Interval shrink(const Interval& t) {
  const double most = std::max(std::abs(t.low), std::abs(t.high)), least = t.has_zero() ? 0 : std::min(std::abs(t.low), std::abs(t.high));
  return {1 / (1 + most * most) - 0x1p-50, 1 / (1 + least * least) + 0x1p-50};
}

template <class V> V determinant(const std::array<std::array<V, 4>, 4>& a, std::size_t k) {
  if (k == 1) return a[0][0];
  if (k == 2) return a[0][0] * a[1][1] - a[0][1] * a[1][0];
  V sum(0.0);
  for (std::size_t c = 0; c < k; ++c) {  // along the first row
    std::array<std::array<V, 4>, 4> minor{};
    for (std::size_t i = 1; i < k; ++i)
      for (std::size_t j = 0, to = 0; j < k; ++j)
        if (j != c) minor[i - 1][to++] = a[i][j];
    const V term = a[0][c] * determinant(minor, k - 1);
    sum = c % 2 == 0 ? sum + term : sum - term;
  }
  return sum;
}

template <class V> struct Values {
  V D, N[4], across[4], along[4], c[4], s[4];
};

class Search {
 public:
  Search(const MatrixX<Rational>& A, const VectorX<Rational>& b, const std::vector<double>& mu) : k_(mu.size()), mu_(mu) {
    for (Index i = 0; i < A.rows(); ++i) {
      for (Index j = 0; j < A.cols(); ++j) A_.push_back(enclosed(A(i, j)));
      b_.push_back(enclosed(b[i]));
    }
  }

  std::vector<SlipBox> all() {
    for (int choice = 0; choice < (1 << k_); ++choice) {
      for (std::size_t i = 0; i < k_; ++i) sides_[i] = (choice >> i & 1) != 0 ? -1 : 1;
      Box start{};
      for (std::size_t i = 0; i < k_; ++i) start[i] = {-1 - 0x1p-6, 1 + 0x1p-6};
      branch(start);
    }
    return std::move(found_);
  }

 private:
  [[nodiscard]] const Interval& A(std::size_t i, std::size_t j) const { return A_[i * 3 * k_ + j]; }

  template <class V> void direction(const Interval& t, std::size_t i, V& c, V& s) const {
    c = V(Interval(sides_[i]) * cosine(t));
    s = V(Interval(sides_[i]) * sine(t));
    if constexpr (std::is_same_v<V, Slope>) {  // ċ = −s 2/(1 + t²), ṡ = c 2/(1 + t²)
      const Interval rate = Interval(2) * shrink(t);
      c.by[i] = -(s.value * rate);
      s.by[i] = c.value * rate;
    }
  }

  template <class V> Values<V> values(const Box& t) const {
    Values<V> f;
    for (std::size_t i = 0; i < k_; ++i) direction(t[i], i, f.c[i], f.s[i]);
    // row r of A times (1, −μ d_j)
    const auto pushed = [&](std::size_t r, std::size_t j) {
      return V(A(r, 3 * j)) - V(Interval(mu_[j])) * (V(A(r, 3 * j + 1)) * f.c[j] + V(A(r, 3 * j + 2)) * f.s[j]);
    };
    std::array<std::array<V, 4>, 4> S{};
    for (std::size_t i = 0; i < k_; ++i)
      for (std::size_t j = 0; j < k_; ++j) S[i][j] = pushed(3 * i, j);
    f.D = determinant(S, k_);
    for (std::size_t j = 0; j < k_; ++j) {
      auto replaced = S;
      for (std::size_t i = 0; i < k_; ++i) replaced[i][j] = V(-b_[3 * i]);
      f.N[j] = determinant(replaced, k_);
    }
    for (std::size_t i = 0; i < k_; ++i) {
      V u[2];
      for (std::size_t a = 0; a < 2; ++a) {
        u[a] = V(b_[3 * i + 1 + a]) * f.D;
        for (std::size_t j = 0; j < k_; ++j) u[a] = u[a] + pushed(3 * i + 1 + a, j) * f.N[j];
      }
      f.across[i] = f.c[i] * u[1] - f.s[i] * u[0];
      f.along[i] = f.c[i] * u[0] + f.s[i] * u[1];
    }
    return f;
  }

  enum class Holds : std::uint8_t { no, perhaps, yes };
  [[nodiscard]] Holds inequalities(const Values<Interval>& f) const {
    bool sure = true;
    for (std::size_t i = 0; i < k_; ++i) {
      const Interval normal = f.N[i] * f.D, along = f.along[i] * f.D;
      if (normal.high <= 0 || along.high <= 0) return Holds::no;
      sure = sure && normal.low > 0 && along.low > 0;
    }
    return sure ? Holds::yes : Holds::perhaps;
  }

  // K = y − Y F(y) + (1 − Y F'(X)) (X − y). 1: one root, X is K; 0: none; −1: not known.
  int krawczyk(Box& X) const {
    Box y{};
    for (std::size_t i = 0; i < k_; ++i) y[i] = X[i].middle();
    const auto at = values<Interval>(y);
    const auto over = values<Slope>(X);
    MatrixX<double> F(k_, k_);
    for (std::size_t i = 0; i < k_; ++i)
      for (std::size_t j = 0; j < k_; ++j) F(static_cast<Index>(i), static_cast<Index>(j)) = over.across[i].by[j].middle();
    if (!F.allFinite()) return -1;
    const Eigen::FullPivLU<MatrixX<double>> lu(F);
    if (!lu.isInvertible()) return -1;
    const MatrixX<double> Y = lu.inverse();
    bool inside = true;
    Box next = X;
    for (std::size_t i = 0; i < k_; ++i) {
      Interval sum = y[i];
      for (std::size_t j = 0; j < k_; ++j) {
        const Interval yij(Y(static_cast<Index>(i), static_cast<Index>(j)));
        sum = sum - yij * at.across[j];
        Interval entry(i == j ? 1.0 : 0.0);
        for (std::size_t l = 0; l < k_; ++l) entry = entry - Interval(Y(static_cast<Index>(i), static_cast<Index>(l))) * over.across[l].by[j];
        sum = sum + entry * (X[j] - y[j]);
      }
      if (sum.low > X[i].high || sum.high < X[i].low) return 0;
      inside = inside && sum.low > X[i].low && sum.high < X[i].high;
      next[i] = {std::max(sum.low, X[i].low), std::min(sum.high, X[i].high)};
    }
    if (!inside) return -1;
    X = next;
    return 1;
  }

  void keep(const Box& X, bool certified) {
    SlipBox box;
    box.certified = certified;
    const auto f = values<Interval>(X);
    box.lambda.resize(static_cast<Index>(3 * k_));
    for (std::size_t i = 0; i < k_; ++i) {
      box.width = std::max(box.width, X[i].width());
      const double normal = f.N[i].middle() / f.D.middle();
      const auto r = static_cast<Index>(3 * i);
      box.lambda[r] = normal;
      box.lambda[r + 1] = -mu_[i] * normal * f.c[i].middle();
      box.lambda[r + 2] = -mu_[i] * normal * f.s[i].middle();
    }
    for (const SlipBox& other : found_)  // where the two halves of a circle overlap
      if (other.certified == certified && (other.lambda - box.lambda).norm() <= 1e-7 * box.lambda.norm()) return;
    found_.push_back(std::move(box));
  }

  void branch(const Box& start) {
    std::vector<Box> pending{start};
    while (!pending.empty()) {
      Box X = pending.back();
      pending.pop_back();
      if (++boxes_ > max_slip_boxes) return keep(X, false);
      const auto f = values<Interval>(X);
      bool none = inequalities(f) == Holds::no;
      for (std::size_t i = 0; i < k_; ++i) none = none || !f.across[i].has_zero();
      if (none) continue;
      std::size_t widest = 0;
      for (std::size_t i = 0; i < k_; ++i)
        if (X[i].width() > X[widest].width()) widest = i;
      const int known = X[widest].width() < 0.2 ? krawczyk(X) : -1;
      if (known == 0) continue;
      if (known == 1) {
        for (int again = 0; again < 8; ++again)
          if (krawczyk(X) != 1) break;
        const Holds holds = inequalities(values<Interval>(X));
        if (holds != Holds::no) keep(X, holds == Holds::yes);
        continue;
      }
      if (X[widest].width() < 0x1p-20) {
        keep(X, false);
        continue;
      }
      Box left = X, right = X;
      left[widest].high = right[widest].low = X[widest].middle();
      pending.push_back(left);
      pending.push_back(right);
    }
  }

  std::size_t k_;
  std::vector<double> mu_;
  std::vector<Interval> A_, b_;
  Sides sides_{};
  int boxes_ = 0;
  std::vector<SlipBox> found_;
};

}  // namespace

std::vector<SlipBox> contact_slips(const MatrixX<Rational>& A, const VectorX<Rational>& b, const std::vector<double>& mu) { return Search(A, b, mu).all(); }

}  // namespace delassus::reference
