// Pinocchio's constraint Cholesky, EFPA and PV-OSIMr. The last two know one body per constraint and one damping for all rows; they and
// the first begin at q.
#include "bench/peers/pinocchio.h"

#include <pinocchio/algorithm/constraint-cholesky.hpp>
#include <pinocchio/algorithm/delassus-operator.hpp>
#include <pinocchio/algorithm/delassus.hpp>

namespace delassus::bench {
namespace {

class ConstraintCholesky : public WithRows {
 public:
  ConstraintCholesky(const Scene& scene, const Damping<double>& damping, const Vector& given)
      : WithRows(scene, damping, given), factor_(tree.model, tree.data, models, datas) {
    factor_.updateDamping(R_inverse);
  }
  void take(Step step) override {
    switch (step) {
      case Step::kinematics: kinematics(); break;
      case Step::first_product: compute(false); [[fallthrough]];
      case Step::product: factor_.getDelassusOperatorCholeskyExpression().applyOnTheRight(x, y); break;
      case Step::new_damping: factor_.updateDamping(next_damping()), factor_.computeDelassusCholeskyDecomposition(), solve(); break;
      case Step::first_solve: compute(true); [[fallthrough]];
      case Step::solve: solve(); break;
    }
  }

 private:
  void compute(bool solves) {
    pin::crba(tree.model, tree.data, tree.q, pin::Convention::WORLD);
    calculate();
    factor_.compute(tree.model, tree.data, models, datas, true, solves);
  }
  void solve() { y = x, factor_.getDelassusOperatorCholeskyExpression().solveInPlace(y); }

  pin::ConstraintCholeskyDecomposition factor_;
};

/// A0, or Λ_R explicitly by the inversion lemma, by EFPA or PV-OSIMr; both fill the upper triangle.
template <bool pv> class Explicit : public Common {
 public:
  Explicit(const Scene& scene, const Damping<double>& damping, const Vector& given) : Common(scene, damping, given), A_(Matrix::Zero(given.size(), given.size())), Lambda_(A_) {
    if ((R_inverse.array() != R_inverse[0]).any()) refuse("damping", "differs between rows", "one number: EFPA and PV-OSIMr of Pinocchio take no more");
    for (const Constraint& c : scene.model.constraints) {
      if (c.a.body != ground && c.b.body != ground) refuse(c.name, "between two bodies", "a body and the ground: EFPA and PV-OSIMr of Pinocchio know no other");
      const Ends e = ends_of(tree, c);  // the first end is the ground
      const Index row = 3 * static_cast<Index>(models_.size());
      models_.emplace_back(pin::CONTACT_3D, tree.model, e.second, e.on_second, pin::LOCAL);
      signs.segment(row, 3).setConstant(e.sign);
    }
    for (const auto& m : models_) datas_.emplace_back(m);
    x = in_rows(signs, given);
    if (pv) pin::initPvDelassus(tree.model, tree.data, models_);
  }
  void take(Step step) override {
    switch (step) {
      case Step::kinematics: break;
      case Step::first_product: form(); [[fallthrough]];
      case Step::product: y.noalias() = A_.selfadjointView<Eigen::Upper>() * x, y += R_inverse.cwiseProduct(x); break;
      case Step::new_damping: invert(next_damping()[0]), solve(); break;
      case Step::first_solve: invert(R_inverse[0]); [[fallthrough]];
      case Step::solve: solve(); break;
    }
  }

 private:
  void form() {
    if constexpr (pv) pin::computePvDelassusMatrix(tree.model, tree.data, tree.q, models_, datas_, A_, 0.);
    else pin::computeDelassusMatrix(tree.model, tree.data, tree.q, models_, datas_, A_);
  }
  void invert(double mu) { pin::computeDampedDelassusMatrixInverse(tree.model, tree.data, tree.q, models_, datas_, Lambda_, mu, false, pv); }
  void solve() { y.noalias() = Lambda_.selfadjointView<Eigen::Upper>() * x; }

  std::vector<pin::RigidConstraintModel> models_;
  std::vector<pin::RigidConstraintData> datas_;
  Matrix A_, Lambda_;
};

}  // namespace

std::vector<PeerRow> pinocchio_explicit(const std::string& program) {
  return {{"pinocchio_cholesky", program, "crba, then ConstraintCholeskyDecomposition", "ltl_osim", "ltl_osim", true, make_way<ConstraintCholesky>},
          {"pinocchio_efpa", program, "computeDelassusMatrix; its damped inverse as a matrix", "efpa", "caba_osim", true, make_way<Explicit<false>>},
          {"pinocchio_pv_osimr", program, "computePvDelassusMatrix; its damped inverse as a matrix", "pv_osimr", "caba_osimr", true, make_way<Explicit<true>>}};
}

}  // namespace delassus::bench
