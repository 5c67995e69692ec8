#include "algorithms/dynamics/dynamics.h"

#include <algorithm>

#include "algorithms/factors/factor.h"
#include "algorithms/kit/instantiate.h"
#include "algorithms/operators/operators.h"

namespace delassus {

template <class T> void crba(const Problem<T>& problem, MatrixX<T>& M) {
  const Structure& s = *problem.structure;
  M.resize(s.dofs(), s.dofs());
  M.setConstant(T(0));
  std::vector<SixBySix<T>> composite(problem.H.size());
  std::transform(problem.H.begin(), problem.H.end(), composite.begin(), [](const Matrix6<T>& H) { return load(H); });
  for (Index i = s.bodies(); i-- > 0;) {
    if (s.parent[i] != ground) add(composite[s.parent[i]], composite[i]);
    for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k) {
      const Six<T> force = multiply(composite[i], load(problem.S[k]));  // on the bodies from i outwards, per ν̇_k
      for (Index on = i; on != ground; on = s.parent[on])
        for (Index j = s.first_dof[on]; j < s.first_dof[on + 1] && j <= k; ++j) M(j, k) = M(k, j) = dot(load(problem.S[j]), force);
      M(k, k) += problem.armature[k];
    }
  }
}

template <class T> struct ForwardDynamics<T>::Numbers {
  std::shared_ptr<const Structure> structure;
  Plan plan;
  Factor<T> factor;
  std::unique_ptr<Operator<T>> op;
  Workspace<T> work, sweep;
  VectorX<T> none, rate;                 // no forces on the rows; their accelerations
  MatrixX<T> force, wanted, motion, rows;  // of the pair: n × 1, m × 1
  Report factored;

  Numbers(std::shared_ptr<const Structure> s, const OperatorRow& row)
      : structure(std::move(s)), plan(make_plan(*structure, Matrix::M)), op(row.make<T>()), work(0), sweep(0) {
    factor.analyze(*structure, plan);
    op->analyze(structure);
    work = Workspace<T>(op->kkt_workspace());
    sweep = Workspace<T>(factor.solve_workspace());
    none.setConstant(structure->rows, T(0));
    rate = none;
    force = motion = MatrixX<T>::Constant(structure->dofs(), 1, T(0));
    wanted = rows = MatrixX<T>::Constant(structure->rows, 1, T(0));
  }
};

template <class T>
ForwardDynamics<T>::ForwardDynamics(std::shared_ptr<const Structure> structure, std::string_view op)
    : own_(std::make_unique<Numbers>(std::move(structure), find_operator(op))) {}
template <class T> ForwardDynamics<T>::ForwardDynamics(ForwardDynamics&&) noexcept = default;
template <class T> ForwardDynamics<T>::~ForwardDynamics() = default;

template <class T> Report ForwardDynamics<T>::update(const Problem<T>& problem, const Damping<T>& damping) {
  Numbers& own = *own_;
  own.factored = own.factor.start(problem);
  if (own.factored.ok()) own.factored = own.factor.update_undamped();
  const Report of_rows = own.op->update(problem, damping);
  return own.factored.ok() ? of_rows : own.factored;
}

template <class T> Report ForwardDynamics<T>::update_damping(const Damping<T>& damping) { return own_->op->update_damping(damping); }

template <class T> Report ForwardDynamics<T>::aba(const VectorX<T>& f, VectorX<T>& acceleration) {
  Numbers& own = *own_;
  const Index n = own.structure->dofs();
  require(f.size() == n, "aba: the forces do not have one entry per degree of freedom");
  acceleration.setConstant(n, ScalarTraits<T>::nan());
  if (!own.factored.ok()) return own.factored;
  own.factor.solve(own.none.data(), f.data(), own.rate.data(), acceleration.data(), own.sweep.data());
  return {};
}

template <class T>
Report ForwardDynamics<T>::constrained_aba(const VectorX<T>& f, const VectorX<T>& a, Accuracy wanted, VectorX<T>& acceleration,
                                           VectorX<T>& lambda) {
  Numbers& own = *own_;
  const Index m = own.structure->rows, n = own.structure->dofs();
  require(f.size() == n, "constrained_aba: the forces do not have one entry per degree of freedom");
  require(a.size() == m, "constrained_aba: the accelerations do not have one entry per row");
  acceleration.setConstant(n, ScalarTraits<T>::nan());
  lambda.setConstant(m, ScalarTraits<T>::nan());
  if (!own.factored.ok()) return own.factored;
  own.force.col(0) = f;
  own.wanted.col(0) = a;
  const Report report = own.op->solve_kkt(own.force, own.wanted, own.motion, own.rows, wanted, own.work);
  acceleration = own.motion.col(0);
  lambda = own.rows.col(0);
  return report;
}

template <class T>
Dynamics<T>::Dynamics(const Model& model, const Vector3<T>& g, std::string_view op)
    : g_(g), mechanism_(model), motion_(mechanism_), problem_(mechanism_.structure()), forward_(mechanism_.structure(), op) {}

template <class T> Report Dynamics<T>::update(const VectorX<T>& q, const VectorX<T>& nu, const Damping<T>& damping) {
  mechanism_.update(q);
  mechanism_.fill(problem_);
  motion_.update(nu);
  motion_.bias_forces(g_, c_);
  motion_.bias_rows(rows_);
  return forward_.update(problem_, damping);
}

template <class T> Report Dynamics<T>::aba(const VectorX<T>& tau, VectorX<T>& acceleration) {
  require(tau.size() == c_.size(), "aba: τ does not have one entry per degree of freedom");
  force_ = tau - c_;
  return forward_.aba(force_, acceleration);
}

template <class T>
Report Dynamics<T>::constrained_aba(const VectorX<T>& tau, const VectorX<T>& a, VectorX<T>& acceleration, VectorX<T>& lambda,
                                    Accuracy wanted) {
  require(tau.size() == c_.size(), "constrained_aba: τ does not have one entry per degree of freedom");
  require(a.size() == rows_.size(), "constrained_aba: the accelerations do not have one entry per row");
  force_ = tau - c_;
  target_ = a - rows_;
  return forward_.constrained_aba(force_, target_, wanted, acceleration, lambda);
}

#define DELASSUS_INSTANTIATE(T)                              \
  template void crba<T>(const Problem<T>&, MatrixX<T>&);     \
  template class ForwardDynamics<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)
#undef DELASSUS_INSTANTIATE
#define DELASSUS_INSTANTIATE(T) template class Dynamics<T>;
DELASSUS_FOR_EACH_SCALAR_WITH_ROOTS(DELASSUS_INSTANTIATE)
#undef DELASSUS_INSTANTIATE

}  // namespace delassus
