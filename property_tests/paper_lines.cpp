// Which printed lines of the paper are wrong, in exact arithmetic: every line of printed_algorithms.h is taken as printed,
// one at a time, on random mechanisms of growing size; the corrected transcription must equal the definition on all of
// them, each printed line must differ on some. Prints the smallest mechanism that exposes each.
//   paper_lines [--markdown]
#include <cstdio>
#include <optional>
#include <random>
#include <string>
#include <tuple>

#include "generators/build.h"
#include "property_tests/printed_algorithms.h"
#include "reference/definition.h"

namespace {

using namespace delassus;
using namespace delassus::paper;

// A spec of `bodies` bodies whose every choice comes from the seed.
generators::Spec draw(Index bodies, std::uint64_t seed) {
  std::mt19937_64 g(seed * 64 + static_cast<std::uint64_t>(bodies));
  const auto between = [&](Index a, Index b) { return a + static_cast<Index>(g() % static_cast<std::uint64_t>(b - a + 1)); };
  using generators::JointKind;
  constexpr JointKind joints[] = {JointKind::revolute, JointKind::revolute, JointKind::prismatic, JointKind::universal,
                                  JointKind::spherical};
  generators::Spec spec{.family = "paper_lines", .seed = seed, .bodies = {}, .links = {}, .joints = {}};
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
  for (Index e = between(0, 2); e-- > 0;) {
    generators::LinkConstraintSpec c;
    c.kind = between(0, 2) == 0 ? generators::ConstraintKind::point : generators::ConstraintKind::generic;
    c.rows = between(1, 2);
    const Index most = std::min<Index>(bodies, c.kind == generators::ConstraintKind::point ? 2 : 3);
    for (Index i = 0; i < bodies && static_cast<Index>(c.bodies.size()) < most; ++i)
      if (between(0, 1) == 0) c.bodies.push_back(i);
    if (c.bodies.empty()) c.bodies.push_back(bodies - 1);
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

struct Found {
  int exposed = 0;
  std::optional<std::tuple<Index, Index, Index>> size;
  std::string smallest;
};

bool differs(const Problem<Rational>& p, const std::vector<Rational>& R, const reference::Dense<Rational>& d, Printed line) {
  Transcription<Rational> t(p, R, line);
  VectorX<Rational> x(p.structure->rows);
  for (Index r = 0; r < x.size(); ++r) x[r] = Rational(static_cast<int>(1 + 2 * r));
  const bool forward = line == Printed::none || line == Printed::alg2_no_armature || line == Printed::merged_apply_sign;
  const bool inverse = line == Printed::none || !forward;
  if (forward) {
    const VectorX<Rational> y = t.apply(x);
    if (y.size() != x.size() || y != VectorX<Rational>(d.A0 * x)) return true;
  }
  if (!inverse) return false;
  const VectorX<Rational> f = t.solve(x);  // A f = x decides, no inverse needed
  return f.size() != x.size() || x != VectorX<Rational>(d.A() * f);
}

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

}  // namespace

int main(int argc, char** argv) {
  const bool markdown = argc > 1 && std::string(argv[1]) == "--markdown";
  Found found[static_cast<int>(Printed::count)];
  int problems = 0, corrected_wrong = 0, equation_3 = 0;
  for (Index bodies = 1; bodies <= 5; ++bodies)
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      const auto built = generators::build(draw(bodies, seed));
      const Structure& s = *built.problem.structure;
      if (s.rows == 0) continue;
      ++problems;
      const auto p = built.problem.cast<Rational>();
      std::vector<Rational> R;
      for (const double r : built.damping.diagonal) R.push_back(Rational(1) / Rational(r));
      const auto dense = reference::dense(p, built.damping.cast<Rational>());
      corrected_wrong += differs(p, R, dense, Printed::none);
      const auto [printed_wrong, correct_wrong] = equation_3_differs(dense);
      equation_3 += printed_wrong;
      corrected_wrong += correct_wrong;
      for (const Line& line : lines) {
        if (!differs(p, R, dense, line.id)) continue;
        Found& f = found[static_cast<int>(line.id)];
        ++f.exposed;
        const std::tuple size{s.bodies(), s.rows, s.dofs()};
        if (!f.size || size < *f.size) {
          f.size = size;
          f.smallest = describe(built.problem);
        }
      }
    }

  int survivors = equation_3 == 0;
  if (markdown) std::printf("| where | printed | correct | differs on | smallest mechanism found |\n|---|---|---|---|---|\n");
  for (const Line& line : lines) {
    const Found& f = found[static_cast<int>(line.id)];
    survivors += f.exposed == 0;
    std::printf(markdown ? "| %s | `%s` | `%s` | %d of %d | %s |\n" : "%-40s %-28s → %-28s differs on %3d of %d; %s\n", line.where,
                line.printed, line.correct, f.exposed, problems, f.smallest.c_str());
  }
  std::printf(markdown ? "| %s | `%s` | `%s` | %d of %d | any with J ≠ 0 |\n" : "%-40s %-28s → %-28s differs on %3d of %d; any with J ≠ 0\n",
              "equation (3)", "Λ⁻¹λ = −g", "Λ⁻¹λ = +g", equation_3, problems);
  if (!markdown) {
    std::printf("corrected: equal to the definition on %d of %d mechanisms, exactly\n", problems - corrected_wrong, problems);
    std::printf("%d printed lines never exposed\n", survivors);
  }
  return corrected_wrong == 0 && survivors == 0 ? 0 : 1;
}
