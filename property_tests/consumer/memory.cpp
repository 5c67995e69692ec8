// Numbers that this program allocates and the library reads and writes, and the other way round: one of them may be compiled with
// other flags. Crashes, or says no, where the two do not align or free alike.
#include "algorithms/delassus.h"
#include "algorithms/mechanism/mechanism.h"

int main() {
  using namespace delassus;
  Model model;
  for (Index i = 0; i < 3; ++i) {
    Body link{.name = std::string(1, static_cast<char>('a' + i)), .parent = i - 1, .mass = 1.0, .com = {0, 0, -0.5}};
    link.inertia.diagonal() << 0.1, 0.1, 0.01;
    link.joint.axis = {0, 1, 0};
    model.add(link);
  }
  model.constraints.push_back({.name = "tip", .kind = Constraint::Kind::point, .a = {2, {.translation = {0, 0, -1}}}});
  const VectorX<double> q{{0.3, 0.4, 0.5}};
  const Problem<double> given = kinematics<double>(model, q);
  const auto damping = Damping<double>::uniform(3, 1e-3);
  Mechanism<double> mechanism(model, given.structure);
  mechanism.update(q);

  std::vector<Problem<double>> kept;  // at addresses of all kinds
  for (int k = 0; k < 16; ++k) {
    kept.push_back(given);
    const Problem<double>& p = kept.back();
    for (const OperatorRow& row : operators()) {
      const auto op = row.make<double>();
      op->analyze(p.structure);
      if (!op->update(p, damping).ok()) return 1;
    }
    kept.push_back(given);
    Problem<double>& filled = kept.back();
    for (auto& H : filled.H) H.setZero();
    mechanism.fill(filled);
    if (filled.H != given.H || filled.S != given.S) return 2;
  }
  for (Index k = 0; k < 8; ++k) {
    VectorX<double> there = neutral(model), moved = integrate<double>(model, q, VectorX<double>::Zero(3));
    if (there.size() != 3 || moved.size() != 3) return 3;
    there = std::move(moved);
    there.resize(100 + k);
  }
  return 0;
}
