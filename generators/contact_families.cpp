#include "generators/contact_families.h"

#include "generators/build.h"
#include "generators/draft.h"
#include "reference/definition.h"

namespace delassus {
namespace {

using generators::ConstraintKind;
using generators::Draft;
using generators::JointKind;

generators::Spec bodies(const PileSpec& s) {
  Draft d("pile", s.seed);
  for (Index k = 0; k < s.bodies; ++k) {
    auto& b = d.body(s.joints && k > 0 ? k - 1 : -1, s.joints && k > 0 ? JointKind::revolute : JointKind::floating);
    b.mass_decade = s.mass_decades > 0 ? d.random.integer(0, s.mass_decades) : 0;
  }
  for (Index k = 0; k < s.contacts; ++k) {
    if (s.distinct > 0 && k >= s.distinct) {
      d.spec.links.push_back(d.spec.links[static_cast<std::size_t>(k - s.distinct)]);
      continue;
    }
    const Index a = k % s.bodies;
    const Index other = d.random.integer(0, 2) == 0 ? -1 : d.random.integer(0, static_cast<int>(s.bodies) - 1);
    if (other < 0 || other == a) d.link(ConstraintKind::contact, {a});
    else d.link(ConstraintKind::contact, {a, other});
  }
  return d.spec;
}

}  // namespace

simulation::ContactProblem<double> pile(const PileSpec& s) {
  const auto built = generators::build(bodies(s));
  const Index m = built.problem.structure->rows;
  simulation::ContactProblem<double> p;
  p.resize(m);
  p.law = s.law;
  p.mechanism = std::make_shared<const Problem<double>>(built.problem);
  generators::Random random(s.seed + 17);
  for (Index k = 0; k < s.contacts; ++k) simulation::append_contact(p, s.friction * (1 + random.integer(0, 4) / 4.0) / 2);
  const auto dense = reference::dense(built.problem, Damping<double>::uniform(m, 0.0));
  VectorX<double> v(built.problem.structure->dofs());
  for (double& x : v) x = random.integer(-16, 16) / 8.0;
  p.free_velocity = reference::product<double>(dense.J, v);
  const double mean = m > 0 ? dense.A0.diagonal().mean() : 1;
  p.R_inverse.assign(static_cast<std::size_t>(m), s.damping * mean);
  return p;
}

simulation::ContactProblem<double> as_matrix(const simulation::ContactProblem<double>& p) {
  simulation::ContactProblem<double> q = p;
  q.G = reference::dense(*p.mechanism, Damping<double>::uniform(p.rows(), 0.0)).A0;
  for (Index c = 0; c < q.G.cols(); ++c)
    for (Index r = 0; r < c; ++r) q.G(r, c) = q.G(c, r);
  q.mechanism = nullptr;
  return q;
}

}  // namespace delassus
