// Which printed lines of the paper are wrong, in exact arithmetic: every line of printed_algorithms.h is taken as printed,
// one at a time, on random mechanisms of growing size; the corrected transcription must equal the definition on all of
// them, each printed line must differ on some. What exposes a line is shrunk (generators/shrink.h) and printed: once from
// constraints of any kind, once from physical ones only, (K, −K) between two bodies and unary rows.
//   paper_lines [--markdown]
#include <cstdio>
#include <optional>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "algorithms/kit/test_scalars.h"
#include "generators/build.h"
#include "generators/shrink.h"
#include "cli/program/options.h"
#include "property_tests/defects/printed_algorithms.h"
#include "reference/definition.h"

namespace {

using namespace delassus;
using namespace delassus::paper;

// A spec of `bodies` bodies whose every choice comes from the seed.
// Physical: link constraints are points between any two bodies or to the ground, up to four of them.
generators::Spec draw(Index bodies, std::uint64_t seed, bool physical) {
  std::mt19937_64 g(seed * 64 + static_cast<std::uint64_t>(bodies));
  const auto between = [&](Index a, Index b) { return a + static_cast<Index>(g() % static_cast<std::uint64_t>(b - a + 1)); };
  using generators::JointKind;
  constexpr JointKind joints[] = {JointKind::revolute, JointKind::revolute, JointKind::prismatic, JointKind::universal,
                                  JointKind::spherical};
  generators::Spec spec{.family = "paper_lines", .seed = seed, .bodies = {}, .links = {}, .joints = {}, .turn = {}};
  for (Index i = 0; i < bodies; ++i) {
    generators::BodySpec b;
    b.parent = between(-1, i - 1);
    b.joint = joints[between(0, 4)];
    b.axis = {static_cast<int>(between(-2, 2)), static_cast<int>(between(-2, 2)), 1};
    b.offset = {1, static_cast<int>(between(-1, 1)), static_cast<int>(between(-1, 1))};
    if (between(0, 2) == 0) b.armature_decade = 0;
    b.seed = g();
    spec.bodies.push_back(b);
  }
  const generators::DampingSpec damping{.kind = generators::DampingKind::rows, .low = -1, .high = 1, .seed = g()};
  const auto some_bodies = [&](Index most) {
    std::vector<Index> some;
    for (Index i = 0; i < bodies && static_cast<Index>(some.size()) < most; ++i)
      if (between(0, 1) == 0) some.push_back(i);
    return some.empty() ? std::vector<Index>{bodies - 1} : some;
  };
  const auto any_pair = [&]() -> std::vector<Index> {
    const Index a = between(0, bodies - 1), b = between(0, bodies - 1);
    return a == b ? std::vector<Index>{a} : std::vector<Index>{std::min(a, b), std::max(a, b)};
  };
  for (Index e = between(0, physical ? 4 : 2); e-- > 0;) {
    generators::LinkConstraintSpec c;
    c.kind = between(0, 2) == 0 || physical ? generators::ConstraintKind::point : generators::ConstraintKind::generic;
    c.rows = between(1, 2);
    c.bodies = physical ? any_pair() : some_bodies(c.kind == generators::ConstraintKind::point ? 2 : 3);
    c.seed = g();
    c.damping = damping;
    spec.links.push_back(c);
  }
  for (Index e = between(0, 2); e-- > 0;) {
    generators::JointConstraintSpec j{.body = between(0, bodies - 1), .rows = 1, .seed = g(), .damping = damping};
    spec.joints.push_back(j);
  }
  return spec;
}

std::string describe(const Problem<double>& p) {
  const Structure& s = *p.structure;
  std::string text = "parents (";
  for (Index i = 0; i < s.bodies(); ++i) text += (i ? "," : "") + std::to_string(s.parent[i] + 1);
  text += "), n (";
  for (Index i = 0; i < s.bodies(); ++i) text += (i ? "," : "") + std::to_string(s.dofs(i));
  text += ")";
  for (const auto& e : s.link_constraints) {
    text += ", links (";
    for (std::size_t l = 0; l < e.links.size(); ++l) text += (l ? "," : "") + std::to_string(e.links[l].body + 1);
    text += ")";
  }
  for (const auto& j : s.joint_constraints) text += ", joint row on " + std::to_string(j.body + 1);
  for (const double a : p.armature)
    if (a != 0) return text + ", armature";
  return text;
}

/// One problem in rational numbers, and what the definition says.
struct Question {
  explicit Question(const generators::Built& b)
      : p(b.problem.cast<Rational>()), dense(reference::dense(p, b.damping.cast<Rational>())),
        R(MatrixX<Rational>::Zero(p.structure->rows, p.structure->rows)) {
    for (Index r = 0; r < R.rows(); ++r) R(r, r) = Rational(1) / Rational(b.damping.diagonal[static_cast<std::size_t>(r)]);
  }
  Problem<Rational> p;
  reference::Dense<Rational> dense;
  MatrixX<Rational> R;
};

/// The transcription with these lines as printed differs from the definition, or is not defined.
bool differs(const Question& q, Lines lines, bool apply, bool solve) {
  Transcription<Rational> t(q.p, q.R, lines);
  VectorX<Rational> x(q.R.rows());
  for (Index r = 0; r < x.size(); ++r) x[r] = Rational(static_cast<int>(1 + 2 * r));
  if (apply) {
    const VectorX<Rational> y = t.apply(x);
    if (y.size() != x.size() || y != VectorX<Rational>(q.dense.A0 * x)) return true;
  }
  if (!solve) return false;
  const VectorX<Rational> f = t.solve(x);  // A f = x decides, no inverse needed
  return f.size() != x.size() || x != VectorX<Rational>(q.dense.A() * f);
}
bool differs(const Question& q, Printed line) { return differs(q, only(line), of_apply(line), !of_apply(line)); }

// Equation (3) against (2a) and (2b): with a_des = J M⁻¹ (τ + Jᵀλ) the force λ must satisfy Λ⁻¹ λ = right side.
// Returns {printed right side −g is wrong, corrected right side +g is wrong}, g = a_des − J M⁻¹ τ (no bias terms).
std::pair<bool, bool> equation_3_differs(const reference::Dense<Rational>& d) {
  VectorX<Rational> lambda(d.J.rows()), tau(d.J.cols());
  for (Index r = 0; r < lambda.size(); ++r) lambda[r] = Rational(static_cast<int>(1 + r));
  for (Index c = 0; c < tau.size(); ++c) tau[c] = Rational(static_cast<int>(2 - c));
  const VectorX<Rational> free = d.M_inv_Jt.transpose() * tau;
  const VectorX<Rational> a_des = free + d.A0 * lambda, g = a_des - free, left = d.A0 * lambda;
  return {left != VectorX<Rational>(-g), left != g};
}

/// The mechanisms of one kind, and what was found on them.
struct Pool {
  std::vector<std::pair<generators::Spec, Question>> all;
  int corrected_wrong = 0, equation_3 = 0, algorithm_4 = 0;
};

Pool pool(bool physical) {
  Pool out;
  for (Index bodies = 1; bodies <= 5; ++bodies)
    for (std::uint64_t seed = 0; seed < (physical ? 40 : 60); ++seed) {
      const generators::Spec spec = draw(bodies, seed, physical);
      const generators::Built built = generators::build(spec);
      if (built.problem.structure->rows == 0) continue;
      const Question q(built);
      const auto [printed_wrong, correct_wrong] = equation_3_differs(q.dense);
      out.equation_3 += printed_wrong;
      out.corrected_wrong += differs(q, 0, true, true) || correct_wrong;
      out.algorithm_4 += differs(q, algorithm_4, false, true);
      out.all.emplace_back(spec, q);
    }
  return out;
}

struct Exposed {
  int count = 0;
  std::string smallest = "none of those drawn";
};

/// How many mechanisms expose a line, and the smallest to which the first of them shrink.
Exposed exposed(const Pool& pool, Printed line) {
  constexpr int most_shrunk = 6;
  Exposed out;
  std::optional<std::tuple<Index, Index, Index, std::size_t>> size;
  for (const auto& [spec, q] : pool.all) {
    if (!differs(q, line) || ++out.count > most_shrunk) continue;
    const generators::Shrunk s = generators::shrink(spec, [&](const generators::Spec& smaller) {
      const generators::Built b = generators::build(smaller);
      return b.problem.structure->rows > 0 && differs(Question(b), line);
    });
    const generators::Built b = generators::build(s.spec);
    const Structure& of = *b.problem.structure;
    const std::string text = describe(b.problem);
    const std::tuple found{of.bodies(), of.rows, of.dofs(), text.size()};
    if (size && *size <= found) continue;
    size = found;
    out.smallest = text;
  }
  return out;
}

int run(bool markdown) {
  const Pool any = pool(false), physical = pool(true);
  const auto problems = static_cast<int>(any.all.size());
  const char* const row = markdown ? "| %s | `%s` | `%s` | %d of %d | %s | %s |\n"
                                   : "%s: %s → %s\n    differs on %d of %d; smallest: %s\n    physical: %s\n";
  int survivors = any.equation_3 == 0;
  if (markdown)
    std::printf("| where | printed | correct | differs on | smallest mechanism | with (K, −K) and unary rows only |\n|---|---|---|---|---|---|\n");
  for (const Line& line : lines) {
    const Exposed e = exposed(any, line.id);
    const Exposed by_physical = exposed(physical, line.id);
    survivors += (e.count == 0) + (by_physical.count == 0);
    std::printf(row, line.where, line.printed, line.correct, e.count, problems, e.smallest.c_str(), by_physical.smallest.c_str());
  }
  std::printf(row, "equation (3)", "Λ⁻¹λ = −g", "Λ⁻¹λ = +g", any.equation_3, problems, "any with J ≠ 0", "the same");
  if (!markdown) {
    std::printf("Algorithm 4 with every line as printed: equal to the definition on %d of %d mechanisms\n", problems - any.algorithm_4, problems);
    std::printf("every line corrected: equal on %d of %d, exactly; of the physical ones on %zu of %zu\n", problems - any.corrected_wrong,
                problems, physical.all.size() - static_cast<std::size_t>(physical.corrected_wrong), physical.all.size());
    std::printf("%d times a printed line was not exposed\n", survivors);
  }
  return any.corrected_wrong + physical.corrected_wrong + survivors == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  options::Command app{"The paper's lines as printed, one at a time, in rational numbers (docs/paper_notes.md).\n"
               "Exit code 1 when a printed line is not exposed, or a corrected one is wrong."};
  bool markdown = false;
  app.add_flag("--markdown", markdown, "a table for a page");
  return delassus::options::run(app, argc, argv, [&] { return run(markdown); });
}
