// Identities between routes at thousands of bodies, exactly: in the integers modulo p = 2⁶¹ − 1.
//
//   of an operator that applies                  of one that solves
//     A x = that of aba_sweep                      V_R (A x) = x, A x by aba_sweep
//     xᵀ A y = (A x)ᵀ y
//     A x with bodies renumbered                   V_R x with bodies renumbered
//     A x with 𝒦_i as K blocks on i and π(i)       V_R x with 𝒦_i as K blocks on i and π(i)
//                                                  V_R x with armature as rows of R = armature
//
// Every number of S, H, K, 𝒦, armature, R⁻¹ (3×3 and other blocks among them) and x is drawn from all of the field: the
// identities are between rational functions of these numbers, and no positivity enters them. Every operator of the table
// that has a maker for PrimeField is held to them.
//
// What equality proves. A x = a is equivalent to one linear system in the body motions and forces, joint velocities and
// rows, U = 12 N + n + m unknowns, whose coefficients are the drawn numbers themselves. By Cramer's rule every entry of
// A x and of V_R a is a quotient of two polynomials of degree U + 1 at most. An operator that solves a wrong system of
// this form exactly (a block that is missing, misplaced, transposed, of wrong sign) has quotients of the same degree.
// The difference of the two sides has a numerator of degree d ≤ 2 (U + 1) + 1 (round trip: one quotient inside another,
// less x); for a difference that is not identically zero, a random point is a zero with probability d/p at most
// (Schwartz, Zippel). An operator that is wrong without solving any such system may double its degree at every step that
// depends on the one before: d ≤ 2^(2 + depth), which proves nothing beyond some fifty dependent steps.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "algorithms/delassus.h"
#include "algorithms/kit/test_scalars.h"
#include "generators/build.h"
#include "generators/draft.h"
#include "generators/families.h"
#include "cli/program/options.h"
#include "property_tests/laws/variants.h"

namespace {

using namespace delassus;
using laws::Variant;
using F = PrimeField;
using Matrix = MatrixX<F>;

F drawn(generators::Random& r) { return F::from(r.next() % F::p); }

Matrix drawn(generators::Random& r, Index rows, Index columns) {
  return Matrix::NullaryExpr(rows, columns, [&](Index, Index) { return drawn(r); });
}

/// Of the constraints of several rows, in order of rows, every second one has a block for R⁻¹; the other rows a number.
Damping<F> drawn_damping(generators::Random& r, const Structure& s) {
  std::vector<std::pair<Index, Index>> constraints;  // first row, rows
  for (const auto& e : s.link_constraints) constraints.emplace_back(e.row, e.rows);
  for (const auto& e : s.joint_constraints) constraints.emplace_back(e.row, e.rows);
  std::sort(constraints.begin(), constraints.end());
  Damping<F> d = Damping<F>::uniform(s.rows, F(0));
  bool block = false;
  for (const auto& [row, rows] : constraints) {
    if (rows > 1) block = !block;
    if (rows > 1 && block) {
      const Matrix half = drawn(r, rows, rows);
      d.blocks.push_back({row, half + half.transpose()});
    } else {
      for (Index k = row; k < row + rows; ++k) d.diagonal[static_cast<std::size_t>(k)] = drawn(r);
    }
  }
  return d;
}

/// The structure of a spec with numbers from all of the field.
Variant<F> drawn(const generators::Spec& spec, std::uint64_t seed) {
  const generators::Built built = generators::build(spec);
  generators::Random r(seed);
  Variant<F> out{Problem<F>(built.problem.structure), {}};
  for (auto& s : out.problem.S) s = drawn(r, 6, 1);
  for (auto& k : out.problem.K) k = drawn(r, 6, 1);
  for (F& k : out.problem.joint_K) k = drawn(r);
  for (auto& H : out.problem.H) {
    const Matrix half = drawn(r, 6, 6);
    H = half + half.transpose();
  }
  for (std::size_t k = 0; k < out.problem.armature.size(); ++k)  // of every third joint
    if (k % 3 == 0) out.problem.armature[k] = drawn(r);
  out.damping = drawn_damping(r, *built.problem.structure);
  return out;
}

generators::Spec family(const char* name, Index n) { return generators::find_family(name).make(n, 1); }

/// A random tree of every joint kind in which every fourth body closes a loop with one of those just before it, and some
/// loops are of three links.
generators::Spec looped_tree(Index n) {
  generators::Draft d("looped_tree", 1);
  for (Index k = 0; k < n; ++k) d.any_body(k == 0 ? -1 : std::max<Index>(0, d.last() - d.random.integer(0, 3)));
  for (Index k = 4; k < n; k += 4) {
    const Index other = k - d.random.integer(1, 4);
    std::vector<Index> bodies{k, other};
    if (k % 8 == 0) bodies.push_back(other == k - 1 ? k - 2 : k - 1);
    d.link(generators::ConstraintKind::generic, bodies).rows = 2;
  }
  for (Index k = 0; k < n; k += 5) d.joint_rows(k);
  d.damp(generators::DampingKind::rows, 0, 0);
  return d.spec;
}

/// Humanoids of 26 bodies in a row, each holding the next by the hand: n bodies or some more.
generators::Spec crowd(Index n) {
  const Index count = (n + 25) / 26;
  generators::Spec all = family("humanoid", 26);
  const generators::Spec one = all;
  const auto size = static_cast<Index>(one.bodies.size());
  for (Index k = 1; k < count; ++k) {
    const Index shift = k * size;
    for (auto b : one.bodies) {
      b.parent = b.parent < 0 ? b.parent : b.parent + shift;
      all.bodies.push_back(b);
    }
    for (auto c : one.links) {
      for (Index& b : c.bodies) b += shift;
      all.links.push_back(c);
    }
    for (auto c : one.joints) {
      c.body += shift;
      all.joints.push_back(c);
    }
    auto grip = one.links.back();
    grip.kind = generators::ConstraintKind::point;
    grip.bodies = {shift - 1, shift + size - 1};
    all.links.push_back(grip);
  }
  return all;
}

/// An operator prepared on a problem.
class Prepared {
 public:
  Prepared(const OperatorRow& row, const Variant<F>& v) : name_(row.name), op_(row.make<F>()) {
    op_->analyze(v.problem.structure);
    expect(op_->update(v.problem, v.damping));
  }
  [[nodiscard]] Matrix apply(const Matrix& x) const { return answer(x, &Operator<F>::apply); }
  [[nodiscard]] Matrix solve(const Matrix& x) const { return answer(x, &Operator<F>::solve); }

 private:
  using Phase = Report (Operator<F>::*)(ConstRef<F>, Ref<F>, Workspace<F>&) const;
  [[nodiscard]] Matrix answer(const Matrix& x, Phase phase) const {
    Workspace<F> w(op_->workspace(x.cols()));
    Matrix y(x.rows(), x.cols());
    expect(((*op_).*phase)(x, y, w));
    return y;
  }
  void expect(const Report& r) const {
    if (!r.ok()) throw std::runtime_error(std::string(name_) + ": " + std::string(delassus::name(r.status)));
  }
  std::string_view name_;
  std::unique_ptr<Operator<F>> op_;
};

Matrix appended_zeros(const Matrix& x, Index rows) {
  Matrix out = Matrix::Zero(rows, x.cols());
  out.topRows(x.rows()) = x;
  return out;
}

F dot(const Matrix& x, const Matrix& y) {
  F sum;
  for (Index k = 0; k < x.rows(); ++k) sum += x(k, 0) * y(k, 0);
  return sum;
}

/// What the two sides of an identity are computed from: `first`, with the answers to x known, and `second`, which is the
/// same numbers or a defect.
struct Sides {
  const OperatorRow& op;
  const Variant<F>& first;
  const Variant<F>& second;
  Matrix x, y, Ax, Vx;   ///< A x by aba_sweep, V_R x by the operator itself (where it solves)

  [[nodiscard]] Matrix apply(const Variant<F>& v, const Matrix& f) const { return Prepared(op, v).apply(f); }
  [[nodiscard]] Matrix solve(const Variant<F>& v, const Matrix& a) const { return Prepared(op, v).solve(a); }
  [[nodiscard]] Variant<F> relabelled() const { return laws::relabelled(second.problem, second.damping, 3); }
  [[nodiscard]] Variant<F> as_links() const { return laws::joint_rows_as_links(second.problem, second.damping); }
};

bool armature_as_rows(const Sides& s) {
  const Variant<F> rows = laws::armature_as_rows(s.second.problem, s.second.damping);
  return s.solve(rows, appended_zeros(s.x, rows.problem.structure->rows)).topRows(s.x.rows()) == s.Vx;
}

struct Identity {
  const char* name;
  bool solves;   ///< about V_R, not about A
  bool (*holds)(const Sides&);
};

const Identity identities[] = {
    {"A x = aba_sweep", false, [](const Sides& s) { return s.apply(s.second, s.x) == s.Ax; }},
    {"symmetric", false, [](const Sides& s) { return dot(s.x, s.apply(s.second, s.y)) == dot(s.Ax, s.y); }},
    {"relabelled A x", false, [](const Sides& s) { return s.apply(s.relabelled(), s.x) == s.Ax; }},
    {"joint rows as links, A x", false, [](const Sides& s) { return s.apply(s.as_links(), s.x) == s.Ax; }},
    {"round trip", true, [](const Sides& s) { return s.solve(s.second, s.Ax) == s.x; }},
    {"relabelled V x", true, [](const Sides& s) { return s.solve(s.relabelled(), s.x) == s.Vx; }},
    {"joint rows as links, V x", true, [](const Sides& s) { return s.solve(s.as_links(), s.x) == s.Vx; }},
    {"armature as rows", true, armature_as_rows},
};

struct Count {
  int asked = 0, broken = 0;
  std::string which;
};

Count broken(const OperatorRow& op, const Variant<F>& first, const Variant<F>& second) {
  generators::Random r(7);
  const Index m = first.problem.structure->rows;
  Sides s{op, first, second, drawn(r, m, 2), drawn(r, m, 1), {}, {}};
  s.Ax = Prepared(find_operator("aba_sweep"), first).apply(s.x);
  if (op.solves) s.Vx = s.solve(first, s.x);
  Count out;
  for (const Identity& i : identities) {
    if (i.solves ? !op.solves : !op.applies) continue;
    ++out.asked;
    if (i.holds(s)) continue;
    ++out.broken;
    out.which += std::string(" | ") + i.name;
  }
  return out;
}

// One number changed by one, which every identity must notice.
void in_H(Variant<F>& v) { v.problem.H.back()(5, 5) += F(1); }
void in_armature(Variant<F>& v) { v.problem.armature.front() += F(1); }
void in_joint_K(Variant<F>& v) { v.problem.joint_K.back() += F(1); }
void in_a_block(Variant<F>& v) {
  MatrixX<F>& B = v.damping.blocks.back().R_inverse;
  B(0, 1) = B(1, 0) = B(0, 1) + F(1);
}
void in_a_third_link(Variant<F>& v) {
  for (const auto& e : v.problem.structure->link_constraints)
    if (e.links.size() > 2) return void(v.problem.K[static_cast<std::size_t>(e.links[2].first)][4] += F(1));
  throw std::logic_error("no constraint of three links");
}

struct Mechanism {
  const char* name;
  Index bodies;
  generators::Spec (*spec)(Index bodies);
  const char* where;
  void (*spoil)(Variant<F>&);
};

const Mechanism mechanisms[] = {
    {"swimmer", 4000, [](Index n) { return family("swimmer", n); }, "armature", in_armature},
    {"comb", 3000, [](Index n) { return family("comb", n); }, "a block of R⁻¹", in_a_block},
    {"looped tree", 3000, looped_tree, "K of a third link", in_a_third_link},
    {"crowd", 2080, crowd, "𝒦", in_joint_K},
    {"contacts", 2000, [](Index n) { return family("contacts", n); }, "H", in_H},
};

/// Operators whose cost grows faster than a mechanism does take a part of every size.
Index bodies_for(const OperatorRow& op, Index bodies) { return op.holds == Holds::sparse ? bodies : bodies / 50; }

/// Bound on the probability that a wrong identity of this problem holds.
double survival(const Structure& s) {
  const double unknowns = static_cast<double>(12 * s.bodies() + s.dofs() + s.rows);
  return (2 * (unknowns + 1) + 1) / static_cast<double>(F::p);
}

/// Returns whether every identity holds, and fails when a number is changed.
bool check(const OperatorRow& op, const Mechanism& mechanism) {
  const Variant<F> v = drawn(mechanism.spec(bodies_for(op, mechanism.bodies)), 11);
  Variant<F> spoiled = v;
  mechanism.spoil(spoiled);
  const Structure& s = *v.problem.structure;
  const auto start = std::chrono::steady_clock::now();
  const Count fails = broken(op, v, v), noticed = broken(op, v, spoiled);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("  %-12s %5ld bodies %6ld freedoms %6ld rows, survival of a wrong identity < %.1e, %.2f s\n", mechanism.name,
              static_cast<long>(s.bodies()), static_cast<long>(s.dofs()), static_cast<long>(s.rows), survival(s), seconds);
  std::printf("    %s%s; one number changed in %s: %d of %d fail\n", fails.broken == 0 ? "all hold" : "BROKEN",
              fails.which.c_str(), mechanism.where, noticed.broken, noticed.asked);
  return fails.broken == 0 && noticed.broken == noticed.asked;
}

int run(const std::string& only) {
  if (!only.empty() && !std::get<Maker<F>>(find_operator(only).makers))
    throw ModelError("", "--op " + only, "is not served in PrimeField", "an operator with a maker for it");
  bool good = true;
  for (const OperatorRow& op : operators()) {
    if (!std::get<Maker<F>>(op.makers) || (!only.empty() && only != op.name)) continue;
    std::printf("%s\n", std::string(op.name).c_str());
    for (const Mechanism& m : mechanisms) good = check(op, m) && good;
  }
  std::printf(good ? "every identity holds, every one notices a changed number\n" : "FAILED\n");
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  options::Command app{"Identities between routes at thousands of bodies, exactly: in the integers modulo 2⁶¹ − 1.\n"
               "Exit code 1 when one is broken, or does not notice a changed number."};
  std::string op;
  app.add_option("--op", op, "only this operator");
  return delassus::options::run(app, argc, argv, [&] { return run(op); });
}
