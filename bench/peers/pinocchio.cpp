// Pinocchio's matrix-free operator, and the list of its rows.
#include "bench/peers/pinocchio.h"

#include <pinocchio/algorithm/delassus-operator.hpp>

namespace delassus::bench {
namespace {

class RigidBodyOperator : public WithRows {
 public:
  RigidBodyOperator(const Scene& scene, const Damping<double>& damping, const Vector& given)
      : WithRows(scene, damping, given), op_(std::cref(tree.model), std::ref(tree.data), std::cref(models), std::cref(datas)) {
    op_.updateDamping(R_inverse);
  }
  void take(Step step) override {
    switch (step) {
      case Step::kinematics: kinematics(); break;
      case Step::first_product: op_.compute(true, false); [[fallthrough]];
      case Step::product: op_.applyOnTheRight(x, y); break;
      case Step::new_damping: op_.updateDamping(next_damping()), op_.updateDecomposition(), solve(); break;
      case Step::first_solve: op_.compute(false, true); [[fallthrough]];
      case Step::solve: solve(); break;
    }
  }

 private:
  void solve() { y = x, op_.solveInPlace(y); }

  pin::DelassusOperatorRigidBodySystemsTpl<double, 0, pin::JointCollectionDefaultTpl, Anchor, std::reference_wrapper> op_;
};

}  // namespace

std::vector<PeerRow> pinocchio_peers() {
  const std::string program = "Pinocchio " PINOCCHIO_VERSION;
  std::vector<PeerRow> rows{{"pinocchio_rigid_body", program, "DelassusOperatorRigidBodySystems: the paper's operator", "aba_sweep", "lcaba", false, make_way<RigidBodyOperator>}};
  for (PeerRow& row : pinocchio_explicit(program)) rows.push_back(std::move(row));
  return rows;
}

}  // namespace delassus::bench
