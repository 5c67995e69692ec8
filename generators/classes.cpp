#include "algorithms/kit/test_scalars.h"
#include "generators/classes.h"

#include <algorithm>

namespace delassus::generators {
namespace {

using Row = std::vector<PrimeField>;

PrimeField dot(const Vector6<double>& x, const Vector6<double>& y) {
  PrimeField sum;
  for (Index k = 0; k < 6; ++k) sum += PrimeField(x[k]) * PrimeField(y[k]);
  return sum;
}

/// J by the definition: K_e^i S_j for every j on the path from i to the root, and 𝒦_i at joint i.
std::vector<Row> jacobian(const Problem<double>& p) {
  const Structure& s = *p.structure;
  std::vector<Row> J(static_cast<std::size_t>(s.rows), Row(static_cast<std::size_t>(s.dofs())));
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (Index i = link.body; i != ground; i = s.parent[static_cast<std::size_t>(i)])
        for (Index d = s.first_dof[static_cast<std::size_t>(i)]; d < s.first_dof[static_cast<std::size_t>(i) + 1]; ++d)
          for (Index r = 0; r < e.rows; ++r)
            J[static_cast<std::size_t>(e.row + r)][static_cast<std::size_t>(d)] +=
                dot(p.K[static_cast<std::size_t>(link.first + r)], p.S[static_cast<std::size_t>(d)]);
  for (const auto& e : s.joint_constraints) {
    const Index n = s.dofs(e.body), first = s.first_dof[static_cast<std::size_t>(e.body)];
    for (Index r = 0; r < e.rows; ++r)
      for (Index k = 0; k < n; ++k)
        J[static_cast<std::size_t>(e.row + r)][static_cast<std::size_t>(first + k)] =
            PrimeField(p.joint_K[static_cast<std::size_t>(e.first + r * n + k)]);
  }
  return J;
}

Index rank(std::vector<Row> rows) {
  std::size_t done = 0;
  const std::size_t columns = rows.empty() ? 0 : rows[0].size();
  for (std::size_t c = 0; c < columns && done < rows.size(); ++c) {
    const auto first = rows.begin() + static_cast<std::ptrdiff_t>(done);
    const auto pivot = std::find_if(first, rows.end(), [c](const Row& x) { return x[c].v != 0; });
    if (pivot == rows.end()) continue;
    std::swap(*first, *pivot);
    const PrimeField inverse = rows[done][c].inverse();
    for (std::size_t r = done + 1; r < rows.size(); ++r) {
      if (rows[r][c].v == 0) continue;
      const PrimeField factor = rows[r][c] * inverse;
      for (std::size_t k = c; k < columns; ++k) rows[r][k] -= factor * rows[done][k];
    }
    ++done;
  }
  return static_cast<Index>(done);
}

/// Bodies that move between the attached bodies of a constraint: some of those are below it, but not all.
std::vector<bool> loop_bodies(const Structure& s, const Structure::LinkConstraint& e) {
  std::vector<std::size_t> below(static_cast<std::size_t>(s.bodies()), 0);
  for (const auto& link : e.links)
    for (Index i = link.body; i != ground; i = s.parent[static_cast<std::size_t>(i)]) ++below[static_cast<std::size_t>(i)];
  std::vector<bool> in(below.size());
  for (std::size_t i = 0; i < in.size(); ++i) in[i] = below[i] > 0 && below[i] < e.links.size();
  return in;
}

bool closed_loop(const Facts& f) {
  const auto& all = f.built.problem.structure->link_constraints;
  return std::any_of(all.begin(), all.end(), [](const auto& e) { return e.links.size() > 1; });
}

/// Two loops that are not the same bodies and have a body in common.
bool coupled_loops(const Facts& f) {
  const Structure& s = *f.built.problem.structure;
  std::vector<std::vector<bool>> loops;
  for (const auto& e : s.link_constraints)
    if (e.links.size() > 1) loops.push_back(loop_bodies(s, e));
  for (std::size_t a = 0; a < loops.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      if (loops[a] == loops[b]) continue;
      for (std::size_t i = 0; i < loops[a].size(); ++i)
        if (loops[a][i] && loops[b][i]) return true;
    }
  return false;
}

bool redundant_rows(const Facts& f) { return f.rank < f.built.problem.structure->rows; }

bool rank_deficient(const Facts& f) {
  const Structure& s = *f.built.problem.structure;
  return f.rank < std::min(s.rows, s.dofs());
}

bool joint_friction(const Facts& f) {
  return std::any_of(f.spec.joints.begin(), f.spec.joints.end(), [](const auto& c) { return c.rows == 0; });
}

/// max ≥ factor · min over the positive ones.
bool spread(const std::vector<double>& x, double factor) {
  double low = 0, high = 0;
  for (const double v : x) {
    if (!(v > 0)) continue;
    low = low == 0 ? v : std::min(low, v);
    high = std::max(high, v);
  }
  return low > 0 && high >= factor * low;
}

bool wide_damping(const Facts& f) { return spread(f.built.damping.diagonal, 1e20); }

bool mass_ratio(const Facts& f) {
  std::vector<double> mass;
  for (const Matrix6<double>& H : f.built.problem.H) mass.push_back(H(3, 3));
  return spread(mass, 1e6);
}

bool long_chain(const Facts& f) {
  const Structure& s = *f.built.problem.structure;
  std::vector<int> depth(s.parent.size(), 1);
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (s.parent[i] != ground) depth[i] = depth[static_cast<std::size_t>(s.parent[i])] + 1;
  return std::any_of(depth.begin(), depth.end(), [](int d) { return d > 200; });
}

bool several_trees(const Facts& f) {
  const auto& parent = f.built.problem.structure->parent;
  return std::count(parent.begin(), parent.end(), ground) > 1;
}

bool no_constraints(const Facts& f) { return f.built.problem.structure->rows == 0; }

}  // namespace

const std::vector<ClassRow>& classes() {
  static const std::vector<ClassRow> table{
      {"closed loops", "a constraint between two or more bodies", 0.40, closed_loop},
      {"coupled loops", "two different loops that share a body", 0.15, coupled_loops},
      {"redundant rows", "rank J < rows", 0.15, redundant_rows},
      {"rank-deficient J", "rank J < min(rows, dofs)", 0.15, rank_deficient},
      {"joint friction", "a row for every degree of freedom of a joint", 0.20, joint_friction},
      {"20-decade damping", "largest R⁻¹ ≥ 1e20 times the smallest positive one", 0.04, wide_damping},
      {"mass ratio above 1e6", "largest mass ≥ 1e6 times the smallest positive one", 0.10, mass_ratio},
      {"chains above 200", "more than 200 bodies on a path to the ground", 0.002, long_chain},
      {"several trees", "two or more bodies joined to the ground", 0.15, several_trees},
      {"no constraints", "no rows", 0.04, no_constraints},
  };
  return table;
}

Index rank_of_J(const Problem<double>& problem) { return rank(jacobian(problem)); }

std::vector<bool> classes_of(const Spec& spec, const Built& built) {
  const Facts facts{spec, built, rank_of_J(built.problem)};
  std::vector<bool> in;
  for (const ClassRow& row : classes()) in.push_back(row.holds(facts));
  return in;
}

}  // namespace delassus::generators
