// Hard rows of linkages with known mobility: right rank and right inertia however the linkage is described.
//
//   turned_linkages [--count K] [--seed S] [--rule shipped|diagonal|one_row_more] [--verbose]
//
// Of every shape of linkage_shapes.h K random configurations, each by a random tree and cut, turned, moved, in other units of
// length and mass and with its rows in random order (linkage_model.h). Held: rows left out = rows − degrees of freedom, since
// the drivers are locked; dense_refined refuses where there are some; the forces at the drivers for their unit accelerations
// are the inertia of the null space of all joints in Quad, relative to what roundings of its numbers move it by, by
// kkt_elimination and by ladder. --rule: another decision in the place of the shipped one; the program must then fail.
// Exit code 0: all hold; 1: not.
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <map>

#include "algorithms/kit/test_scalars.h"
#include "algorithms/mechanism/kinematics.h"
#include "property_tests/defects/diagonal_rule.h"
#include "property_tests/campaigns/linkage_model.h"
#include "cli/program/options.h"
#include "property_tests/laws/verdict.h"

namespace {

using namespace delassus;
using namespace delassus::laws;

struct Options {
  std::uint64_t count = 1000, seed = 1;
  std::string rule = "shipped";
  bool verbose = false;
};

struct Tally {
  std::uint64_t turns = 0, wrong_rank = 0, wrong_status = 0, wrong_inertia = 0;
  double worst = 0;
  [[nodiscard]] bool right() const { return wrong_rank + wrong_status + wrong_inertia == 0; }
};

struct Prepared {
  std::unique_ptr<Operator<double>> op;
  Report updated;
  Prepared(const OperatorRow& row, const Problem<double>& p) : op(row.make<double>()) {
    op->analyze(p.structure);
    updated = op->update(p, Damping<double>::uniform(p.structure->rows, 0));
  }
};

/// The largest error of the forces at the drivers, in units of eps · size; infinity when not answered.
double inertia_ratio(const OperatorRow& row, const Problem<double>& p, const Turned& t, const Reduced& truth, double unit) {
  const Prepared made(row, p);
  const auto d = static_cast<Index>(t.driver_rows.size());
  MatrixX<double> a = MatrixX<double>::Zero(p.structure->rows, d), f = a;
  for (Index k = 0; k < d; ++k) a(t.driver_rows[static_cast<std::size_t>(k)], k) = 1;
  Workspace<double> w(made.op->workspace(d));
  if (!made.op->solve(a, f, w).ok()) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (Index k = 0; k < d; ++k)
    for (Index r = 0; r < d; ++r) {
      const Quad error = abs(Quad(f(t.driver_rows[static_cast<std::size_t>(r)], k)) / Quad(unit) - truth.inertia(r, k));
      worst = std::max(worst, static_cast<double>(error / (Quad(unit_roundoff<double>) * truth.size(r, k))));
    }
  return worst;
}

void check(const Options& o, const LinkageShape& shape, std::uint64_t seed, Tally& tally) {
  generators::Random r(seed * 7919 + o.seed);
  const Linkage l = shape.at(r);
  const std::vector<LinkMass> masses = random_masses(l, r);
  const Reduced truth = reduced_inertia(l, masses);
  const double length = std::pow(10.0, r.integer(-3, 3)), mass = std::pow(10.0, r.integer(-3, 3));
  const Turned t = turned_model(l, masses, length, mass, r);
  const Problem<double> p = kinematics<double>(t.model, VectorX<double>::Zero(t.model.q_size()));
  ++tally.turns;
  const Index expected = p.structure->rows - p.structure->dofs();
  Index found = 0;
  if (o.rule == "diagonal") found = static_cast<Index>(Prepared(diagonal_rule(), p).op->dependent_rows().size());
  else found = static_cast<Index>(Prepared(find_operator("kkt_elimination"), p).op->dependent_rows().size());
  if (o.rule == "one_row_more") ++found;
  const bool rank = truth.inertia.size() > 0 && found == expected;
  tally.wrong_rank += rank ? 0 : 1;
  const Prepared refusing(find_operator("dense_refined"), p);
  VectorX<double> a = VectorX<double>::Ones(p.structure->rows), f = a;
  Workspace<double> w(refusing.op->workspace());
  tally.wrong_status += refusing.op->solve(a, f, w).status == (expected > 0 ? Status::lost_pivot : Status::ok) ? 0 : 1;
  double ratio = truth.inertia.size() > 0 ? 0 : std::numeric_limits<double>::infinity();
  for (const char* name : {"kkt_elimination", "ladder"})
    if (ratio < pass_below) ratio = std::max(ratio, inertia_ratio(find_operator(name), p, t, truth, mass * length * length));
  tally.wrong_inertia += ratio < pass_below ? 0 : 1;
  tally.worst = std::max(tally.worst, ratio);
  if (o.verbose && (!rank || !(ratio < pass_below)))
    std::cout << shape.name << " " << seed << ": " << found << " rows left out of " << p.structure->rows << ", " << expected << " expected; inertia " << ratio << '\n';
}

int run(const Options& o) {
  bool all = true;
  std::cout << "shape          turns  wrong rank  not refused  wrong inertia  worst ratio\n";
  for (const LinkageShape& shape : linkage_shapes()) {
    Tally t;
    for (std::uint64_t k = 0; k < o.count; ++k) check(o, shape, k, t);
    std::cout << shape.name << std::string(15 - shape.name.size(), ' ') << t.turns << "  " << t.wrong_rank << "  " << t.wrong_status << "  " << t.wrong_inertia << "  " << t.worst << '\n';
    all = all && t.right();
  }
  return all ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  options::Command app{"Hard rows of linkages, turned: ranks and inertias. Exit code 1 when one is wrong."};
  Options o;
  app.add_option("--count", o.count, "turns of every linkage")->check(options::whole(1))->capture_default_str();
  app.add_option("--seed", o.seed, "of the turns")->check(options::whole(0))->capture_default_str();
  app.add_option("--rule", o.rule, "shipped, or a wrong one")->check(options::one_of({"shipped", "diagonal", "one_row_more"}));
  app.add_flag("--verbose", o.verbose, "every failure");
  return options::run(app, argc, argv, [&] { return run(o); });
}
