#include "reference/contact_oracle.h"

#include <cmath>
#include <optional>

#include "reference/contact_slips.h"
#include "reference/definition.h"

namespace delassus::reference {
namespace {

using simulation::Cone;
using simulation::ConeRows;
using simulation::ContactProblem;

using Matrix = MatrixX<Rational>;
using Vector = VectorX<Rational>;

struct Group {
  Cone cone;
  Index row, rows;
  Rational mu;
  bool off;
};

/// A λ + b of the rows, and what each group is.
struct Exact {
  Matrix A;
  Vector b;
  std::vector<Group> groups;
};

Exact exact(const ContactProblem<double>& p) {
  require(p.law == simulation::FrictionLaw::exact, "contact_solutions: exact Coulomb friction only");
  Exact e;
  const Index m = p.rows();
  if (p.mechanism) {
    e.A = dense<Rational>(p.mechanism->cast<Rational>(), Damping<Rational>::uniform(m, Rational(0))).A0;
  } else {
    e.A.resize(m, m);
    for (Index k = 0; k < p.G.size(); ++k) e.A.data()[k] = Rational(p.G.data()[k]);
  }
  e.b.resize(m);
  int contacts = 0;
  for (const ConeRows& c : p.groups) {
    const bool off = std::isinf(p.R_inverse[static_cast<std::size_t>(c.row)]);
    const double mu = c.cone == Cone::coulomb ? p.friction[static_cast<std::size_t>(c.row + 1)] : 0;
    require(c.cone != Cone::box, "contact_solutions: boxes are not taken");
    require(c.cone != Cone::coulomb || (c.rows <= 3 && p.friction[static_cast<std::size_t>(c.row + c.rows - 1)] == mu), "contact_solutions: one tangent, or two of equal coefficients");
    contacts += c.cone == Cone::coulomb && !off;
    if (c.cone == Cone::coulomb) e.groups.push_back({c.cone, c.row, c.rows, Rational(mu), off});
    else
      for (Index r = c.row; r < c.row + c.rows; ++r) e.groups.push_back({c.cone, r, 1, Rational(0), off});
    for (Index r = c.row; r < c.row + c.rows; ++r) {
      e.b[r] = Rational(p.free_velocity[r]) - Rational(p.target[r]);
      if (!off) e.A(r, r) += Rational(p.R_inverse[static_cast<std::size_t>(r)]);
    }
  }
  require(contacts <= 4, "contact_solutions: at most four contacts");
  return e;
}

/// What one assignment of modes leaves: held rows H eliminated; λ_H = Y λ_s + y, and A, b of the slipping rows.
struct Reduced {
  std::vector<Index> held, sliding;  // rows
  Matrix Y, A;
  Vector y, b;
};

std::optional<Reduced> reduced(const Exact& e, const std::vector<Index>& held, const std::vector<Index>& sliding) {
  Reduced r{held, sliding, {}, {}, {}, {}};
  const auto h = static_cast<Index>(held.size()), s = static_cast<Index>(sliding.size());
  Matrix left(h, h), right(h, s + 1);
  for (Index i = 0; i < h; ++i) {
    for (Index j = 0; j < h; ++j) left(i, j) = e.A(held[static_cast<std::size_t>(i)], held[static_cast<std::size_t>(j)]);
    for (Index j = 0; j < s; ++j) right(i, j) = -e.A(held[static_cast<std::size_t>(i)], sliding[static_cast<std::size_t>(j)]);
    right(i, s) = -e.b[held[static_cast<std::size_t>(i)]];
  }
  const PivotedLdlt<Rational> factor(left);
  if (!factor.regular()) return std::nullopt;
  const Matrix X = factor.solve(right);
  r.Y = X.leftCols(s);
  r.y = X.col(s);
  r.A.resize(s, s);
  r.b.resize(s);
  for (Index i = 0; i < s; ++i) {
    const Index row = sliding[static_cast<std::size_t>(i)];
    for (Index j = 0; j <= s; ++j) {
      Rational sum = j < s ? e.A(row, sliding[static_cast<std::size_t>(j)]) : e.b[row];
      for (Index k = 0; k < h; ++k) sum += e.A(row, held[static_cast<std::size_t>(k)]) * X(k, j);
      (j < s ? r.A(i, j) : r.b[i]) = sum;
    }
  }
  return r;
}

class Oracle {
 public:
  explicit Oracle(const ContactProblem<double>& p) : e_(exact(p)), modes_(e_.groups.size(), ContactMode::open) {}

  ContactSolutions solve() {
    assign(0);
    return std::move(found_);
  }

 private:
  void assign(std::size_t group) {
    if (group == e_.groups.size()) return judge();
    const Group& g = e_.groups[group];
    const bool takes[3] = {g.off || g.cone != Cone::free, !g.off, !g.off && g.cone == Cone::coulomb && g.mu > Rational(0)};
    for (const ContactMode mode : {ContactMode::open, ContactMode::held, ContactMode::slip}) {
      if (!takes[static_cast<int>(mode)]) continue;
      modes_[group] = mode;
      assign(group + 1);
    }
  }

  // Rows held at u = 0: without friction the normal only.
  [[nodiscard]] static Index held_rows(const Group& g) { return g.cone == Cone::coulomb && g.mu == Rational(0) ? 1 : g.rows; }

  void judge() {
    std::vector<Index> held, sliding;
    slipping_.clear();
    for (std::size_t k = 0; k < e_.groups.size(); ++k) {
      const Group& g = e_.groups[k];
      if (modes_[k] == ContactMode::held)
        for (Index r = 0; r < held_rows(g); ++r) held.push_back(g.row + r);
      if (modes_[k] != ContactMode::slip) continue;
      slipping_.push_back(k);
      for (Index r = 0; r < g.rows; ++r) sliding.push_back(g.row + r);
    }
    const auto r = reduced(e_, held, sliding);
    if (!r) return give_up("the rows that are held depend on each other");
    if (slipping_.empty()) return keep_rational(*r, Vector(0));
    bool plane = true, space = true;
    for (const std::size_t k : slipping_) (e_.groups[k].rows == 2 ? space : plane) = false;
    if (plane) return sides(*r);
    if (!space) return give_up("slip of one tangent and of two");
    if (slipping_.size() == 1) return quartic(*r);
    many(*r);
  }

  void give_up(const std::string& why) {
    std::string text;
    for (const ContactMode m : modes_) text += m == ContactMode::open ? "open " : m == ContactMode::held ? "held " : "slip ";
    found_.undecided.push_back(text + "(" + why + ")");
  }

  // λ of all rows from that of the sliding ones.
  [[nodiscard]] Vector whole(const Reduced& r, const Vector& sliding) const {
    Vector lambda = Vector::Constant(e_.b.size(), Rational(0));
    for (Index k = 0; k < r.Y.rows(); ++k) {
      Rational sum = r.y[k];
      for (Index j = 0; j < sliding.size(); ++j) sum += r.Y(k, j) * sliding[j];
      lambda[r.held[static_cast<std::size_t>(k)]] = sum;
    }
    for (Index k = 0; k < sliding.size(); ++k) lambda[r.sliding[static_cast<std::size_t>(k)]] = sliding[k];
    return lambda;
  }

  // The inequalities of what is open or held, of rational λ.
  [[nodiscard]] bool holds(const Vector& lambda) const {
    for (std::size_t k = 0; k < e_.groups.size(); ++k) {
      const Group& g = e_.groups[k];
      if (g.off || g.cone == Cone::free || modes_[k] == ContactMode::slip) continue;
      if (modes_[k] == ContactMode::open) {
        Rational u = e_.b[g.row];
        for (Index s = 0; s < lambda.size(); ++s) u += e_.A(g.row, s) * lambda[s];
        if (u < Rational(0)) return false;
        continue;
      }
      Rational tangent(0);
      for (Index r = 1; r < held_rows(g); ++r) tangent += lambda[g.row + r] * lambda[g.row + r];
      const Rational limit = g.mu * lambda[g.row];
      if (!(lambda[g.row] > Rational(0)) || tangent > limit * limit) return false;
    }
    return true;
  }

  // The least of the inequalities' slacks, relative: of numbers that are not exact.
  [[nodiscard]] double margin(const Vector& lambda) const {
    double least = 1, largest = 0;
    for (Index r = 0; r < lambda.size(); ++r) largest = std::max(largest, std::abs(static_cast<double>(lambda[r])));
    for (std::size_t k = 0; k < e_.groups.size(); ++k) {
      const Group& g = e_.groups[k];
      if (g.off || g.cone == Cone::free || modes_[k] == ContactMode::slip) continue;
      if (modes_[k] == ContactMode::open) {
        double u = static_cast<double>(e_.b[g.row]), size = std::abs(u);
        for (Index s = 0; s < lambda.size(); ++s) {
          const double term = static_cast<double>(e_.A(g.row, s)) * static_cast<double>(lambda[s]);
          u += term;
          size = std::max(size, std::abs(term));
        }
        least = std::min(least, size > 0 ? u / size : 0);
        continue;
      }
      double tangent = 0;
      for (Index r = 1; r < held_rows(g); ++r) tangent = std::hypot(tangent, static_cast<double>(lambda[g.row + r]));
      const auto normal = static_cast<double>(lambda[g.row]);
      least = std::min({least, normal / largest, held_rows(g) > 1 ? (static_cast<double>(g.mu) * normal - tangent) / largest : least});
    }
    return least;
  }

  void keep(const Vector& lambda, double width = 0) {
    ContactSolution s{modes_, VectorX<double>(lambda.size()), width};
    for (Index r = 0; r < lambda.size(); ++r) s.lambda[r] = static_cast<double>(lambda[r]);
    found_.all.push_back(std::move(s));
  }

  void keep_rational(const Reduced& r, const Vector& sliding) {
    const Vector lambda = whole(r, sliding);
    if (holds(lambda)) keep(lambda);
  }

  // One tangent: λ_t = −σ μ λ_n, u_n = 0 of each, for every choice of sides σ.
  void sides(const Reduced& r) {
    const auto k = static_cast<Index>(slipping_.size());
    for (int choice = 0; choice < (1 << k); ++choice) {
      const auto side = [&](Index j) { return Rational((choice >> j & 1) != 0 ? -1 : 1) * e_.groups[slipping_[static_cast<std::size_t>(j)]].mu; };
      Matrix S(k, k);
      for (Index i = 0; i < k; ++i)
        for (Index j = 0; j < k; ++j) S(i, j) = r.A(2 * i, 2 * j) - side(j) * r.A(2 * i, 2 * j + 1);
      const auto normal = cramer(S, r);
      if (!normal) {
        give_up("normal rows depend on each other while slipping");
        continue;
      }
      Vector sliding(2 * k);
      bool fits = true;
      for (Index j = 0; j < k; ++j) {
        sliding[2 * j] = (*normal)[j];
        sliding[2 * j + 1] = -side(j) * (*normal)[j];
        fits = fits && (*normal)[j] > Rational(0);
      }
      for (Index i = 0; i < k && fits; ++i) {
        Rational u = r.b[2 * i + 1];
        for (Index j = 0; j < 2 * k; ++j) u += r.A(2 * i + 1, j) * sliding[j];
        fits = u * side(i) > Rational(0);
      }
      if (fits) keep_rational(r, sliding);
    }
  }

  // S is not symmetric: Gauss with the largest pivot.
  [[nodiscard]] static std::optional<Vector> cramer(Matrix S, const Reduced& r) {
    const Index k = S.rows();
    Vector x(k);
    for (Index i = 0; i < k; ++i) x[i] = -r.b[2 * i];
    for (Index c = 0; c < k; ++c) {
      Index p = c;
      for (Index i = c + 1; i < k; ++i)
        if (abs(S(i, c)) > abs(S(p, c))) p = i;
      if (S(p, c) == Rational(0)) return std::nullopt;
      S.row(c).swap(S.row(p));
      std::swap(x[c], x[p]);
      for (Index i = 0; i < k; ++i) {
        if (i == c) continue;
        const Rational f = S(i, c) / S(c, c);
        for (Index j = c; j < k; ++j) S(i, j) -= f * S(c, j);
        x[i] -= f * x[c];
      }
    }
    for (Index i = 0; i < k; ++i) x[i] = x[i] / S(i, i);
    return x;
  }

  /// λ_n q (1 + t²)^k and the like as polynomials in t: everything of the mode times the positive 1 + t² and the factor q.
  struct Slip {
    Polynomial one, c, s;  // 1 + t², 1 − t², 2t
    Polynomial q;          // (1 + t²) q
    Polynomial sliding[3]; // λ_n, λ_t1, λ_t2 times (1 + t²) q … λ_n (1 + t²) q = −b_n (1 + t²)
  };
  [[nodiscard]] Slip slip(const Reduced& r, const Rational& mu) const {
    Slip f;
    f.one = Polynomial({Rational(1), Rational(0), Rational(1)});
    f.c = Polynomial({Rational(1), Rational(0), Rational(-1)});
    f.s = Polynomial({Rational(0), Rational(2)});
    f.q = Polynomial(r.A(0, 0)) * f.one - Polynomial(mu * r.A(0, 1)) * f.c - Polynomial(mu * r.A(0, 2)) * f.s;
    f.sliding[0] = Polynomial(-r.b[0]) * f.one;
    f.sliding[1] = Polynomial(mu * r.b[0]) * f.c;
    f.sliding[2] = Polynomial(mu * r.b[0]) * f.s;
    return f;
  }

  void quartic(const Reduced& r) {
    const Rational mu = e_.groups[slipping_[0]].mu;
    const Slip f = slip(r, mu);
    Polynomial u[2];  // u_t times (1 + t²) q
    for (Index i = 0; i < 2; ++i) {
      u[i] = Polynomial(r.b[i + 1]) * f.q;
      for (Index j = 0; j < 3; ++j) u[i] = u[i] + Polynomial(r.A(i + 1, j)) * f.sliding[j];
    }
    const Polynomial across = f.c * u[1] - f.s * u[0], along = f.c * u[0] + f.s * u[1];
    if (across.zero()) return give_up("every direction of slip balances");
    if (r.b[0] == Rational(0)) {
      if (!real_roots(f.q).empty() || f.q.degree() < 2) give_up("slip without a free normal velocity");
      return;
    }
    for (const RealRoot& root : real_roots(across)) {
      const int q = root.sign(f.q);
      if (q * root.sign(f.sliding[0]) <= 0 || q * root.sign(along) <= 0) continue;
      if (others(r, f, [&](const Polynomial& x) { return root.sign(x); }, q)) keep(at(r, mu, root.within(Rational(0x1p-133))));
    }
    at_infinity(r, mu, across);
  }

  // t = ∞ is d = (−1, 0), a rational direction.
  void at_infinity(const Reduced& r, const Rational& mu, const Polynomial& across) {
    if (across.degree() == 4) return;
    const Rational q = r.A(0, 0) + mu * r.A(0, 1);
    if (q == Rational(0)) return;
    Vector sliding(3);
    sliding << -r.b[0] / q, mu * -r.b[0] / q, Rational(0);
    if (!(sliding[0] > Rational(0))) return;
    Rational u(r.b[1]);
    for (Index j = 0; j < 3; ++j) u += r.A(1, j) * sliding[j];
    if (u < Rational(0)) keep_rational(r, sliding);
  }

  [[nodiscard]] Vector at(const Reduced& r, const Rational& mu, const Rational& t) const {
    const Rational one = Rational(1) + t * t, c = (Rational(1) - t * t) / one, s = Rational(2) * t / one;
    const Rational normal = -r.b[0] / (r.A(0, 0) - mu * (r.A(0, 1) * c + r.A(0, 2) * s));
    Vector sliding(3);
    sliding << normal, -mu * normal * c, -mu * normal * s;
    return whole(r, sliding);
  }

  // The inequalities of what is open or held, at a root; everything times (1 + t²) q, whose sign is q.
  template <class Sign> [[nodiscard]] bool others(const Reduced& r, const Slip& f, const Sign& sign, int q) const {
    std::vector<Polynomial> lambda(static_cast<std::size_t>(e_.b.size()));
    for (Index k = 0; k < r.Y.rows(); ++k) {
      Polynomial sum = Polynomial(r.y[k]) * f.q;
      for (Index j = 0; j < 3; ++j) sum = sum + Polynomial(r.Y(k, j)) * f.sliding[j];
      lambda[static_cast<std::size_t>(r.held[static_cast<std::size_t>(k)])] = sum;
    }
    for (Index j = 0; j < 3; ++j) lambda[static_cast<std::size_t>(r.sliding[static_cast<std::size_t>(j)])] = f.sliding[j];
    for (std::size_t k = 0; k < e_.groups.size(); ++k) {
      const Group& g = e_.groups[k];
      if (g.off || g.cone == Cone::free || modes_[k] == ContactMode::slip) continue;
      if (modes_[k] == ContactMode::open) {
        Polynomial u = Polynomial(e_.b[g.row]) * f.q;
        for (Index s = 0; s < e_.b.size(); ++s) u = u + Polynomial(e_.A(g.row, s)) * lambda[static_cast<std::size_t>(s)];
        if (q * sign(u) < 0) return false;
        continue;
      }
      const auto& normal = lambda[static_cast<std::size_t>(g.row)];
      if (q * sign(normal) <= 0) return false;
      Polynomial room = Polynomial(g.mu * g.mu) * normal * normal;
      for (Index i = 1; i < held_rows(g); ++i) room = room - lambda[static_cast<std::size_t>(g.row + i)] * lambda[static_cast<std::size_t>(g.row + i)];
      if (held_rows(g) > 1 && sign(room) < 0) return false;
    }
    return true;
  }

  void many(const Reduced& r) {
    std::vector<double> mu;
    for (const std::size_t k : slipping_) mu.push_back(static_cast<double>(e_.groups[k].mu));
    const auto boxes = contact_slips(r.A, r.b, mu);
    for (const SlipBox& box : boxes) {
      if (!box.certified) {
        give_up("a box of directions of width " + std::to_string(box.width));
        continue;
      }
      Vector sliding(box.lambda.size());
      for (Index k = 0; k < sliding.size(); ++k) sliding[k] = Rational(box.lambda[k]);
      const Vector lambda = whole(r, sliding);
      const double room = margin(lambda);
      if (std::abs(room) < 1e-7) give_up("an inequality within 1e-7 of its bound");
      else if (room > 0) keep(lambda, box.width);
    }
  }

  Exact e_;
  std::vector<ContactMode> modes_;
  std::vector<std::size_t> slipping_;
  ContactSolutions found_;
};

}  // namespace

ContactSolutions contact_solutions(const ContactProblem<double>& p) { return Oracle(p).solve(); }

}  // namespace delassus::reference
