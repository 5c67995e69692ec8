#include "algorithms/dynamics/tree_operators.h"

#include <algorithm>

#include "algorithms/factors/factor.h"
#include "algorithms/kit/instantiate.h"
#include "algorithms/operators/operator.h"

namespace delassus {

template <class T> struct TreeOperators<T>::Numbers {
  std::shared_ptr<const Structure> structure;
  Plan plan;
  Factor<T> factor;
  Problem<T> copy;
  const Problem<T>* problem = nullptr;
  std::vector<Six<T>> body;  // motions, then forces
  std::vector<T> none, rates;
  Workspace<T> sweep{0};
  Report factored;
  bool is_factored = false;

  explicit Numbers(std::shared_ptr<const Structure> s) : structure(std::move(s)) {
    require(structure != nullptr, "TreeOperators: no structure");
    structure->validate();
    plan = make_plan(*structure, Matrix::M);
    factor.analyze(*structure, plan);
    body.assign(static_cast<std::size_t>(structure->bodies()), Six<T>::zero());
    none.assign(static_cast<std::size_t>(structure->rows), T(0));
    rates = none;
    sweep = Workspace<T>(std::max(factor.solve_workspace(), factor.workspace()));
  }

  void check(ConstRef<T> in, Index in_rows, ConstRef<T> out, Index out_rows) const {
    require(problem != nullptr, "TreeOperators: call update first");
    require(in.rows() == in_rows && out.rows() == out_rows, "TreeOperators: n rows on the side of joints, m on that of constraints");
    require(in.cols() == out.cols(), "TreeOperators: input and output must have the same number of columns");
  }

  Report factor_now() {
    if (is_factored) return factored;
    is_factored = true;
    factored = factor.start(*problem);
    if (factored.ok()) factored = factor.update_undamped();
    return factored;
  }

  /// a_i = a_π + S_i ν_i
  void outwards(const T* nu) {
    for (Index i = 0; i < structure->bodies(); ++i) {
      body[i] = structure->parent[i] == ground ? Six<T>::zero() : body[structure->parent[i]];
      for (Index k = structure->first_dof[i]; k < structure->first_dof[i + 1]; ++k) add(body[i], scaled(load(problem->S[k]), nu[k]));
    }
  }

  /// τ_k += S_kᵀ f_i; f_π += f_i
  void inwards(T* tau) {
    for (Index i = structure->bodies(); i-- > 0;) {
      for (Index k = structure->first_dof[i]; k < structure->first_dof[i + 1]; ++k) tau[k] += dot(load(problem->S[k]), body[i]);
      if (structure->parent[i] != ground) add(body[structure->parent[i]], body[i]);
    }
  }

  void rows_of_motion(const T* nu, T* a) const {
    for (const auto& e : structure->link_constraints)
      for (Index r = 0; r < e.rows; ++r) {
        a[e.row + r] = T(0);
        for (const auto& link : e.links) a[e.row + r] += dot(load(problem->K[link.first + r]), body[link.body]);
      }
    for (const auto& e : structure->joint_constraints) {
      const Index n = structure->dofs(e.body), first = structure->first_dof[e.body];
      for (Index r = 0; r < e.rows; ++r) {
        a[e.row + r] = T(0);
        for (Index c = 0; c < n; ++c) a[e.row + r] += problem->joint_K[e.first + r * n + c] * nu[first + c];
      }
    }
  }

  void forces_of_rows(const T* lambda, T* tau) {
    std::fill(body.begin(), body.end(), Six<T>::zero());
    std::fill(tau, tau + structure->dofs(), T(0));
    for (const auto& e : structure->link_constraints)
      for (const auto& link : e.links)
        for (Index r = 0; r < e.rows; ++r) add(body[link.body], scaled(load(problem->K[link.first + r]), lambda[e.row + r]));
    for (const auto& e : structure->joint_constraints) {
      const Index n = structure->dofs(e.body), first = structure->first_dof[e.body];
      for (Index r = 0; r < e.rows; ++r)
        for (Index c = 0; c < n; ++c) tau[first + c] += problem->joint_K[e.first + r * n + c] * lambda[e.row + r];
    }
  }
};

template <class T> TreeOperators<T>::TreeOperators(std::shared_ptr<const Structure> structure) : own_(std::make_unique<Numbers>(std::move(structure))) {}
template <class T> TreeOperators<T>::TreeOperators(TreeOperators&&) noexcept = default;
template <class T> TreeOperators<T>::~TreeOperators() = default;

template <class T> void TreeOperators<T>::take(const Problem<T>& problem) {
  require(problem.structure == own_->structure, "TreeOperators::update: the problem has another structure");
  problem.check_sizes();
  own_->problem = &problem;
  own_->is_factored = false;
}

template <class T> Report TreeOperators<T>::update(const Problem<T>& problem) {
  require(problem.structure == own_->structure, "TreeOperators::update: the problem has another structure");
  own_->copy = problem;
  take(own_->copy);
  return own_->factor_now();
}

template <class T> std::pair<const Factor<T>*, Report> TreeOperators<T>::factor() {
  require(own_->problem != nullptr, "TreeOperators: call update first");
  return {&own_->factor, own_->factor_now()};
}

template <class T> const Plan& TreeOperators<T>::plan() const { return own_->plan; }

template <class T> const Problem<T>& TreeOperators<T>::problem() const {
  require(own_->problem != nullptr, "TreeOperators: call update first");
  return *own_->problem;
}

template <class T> void TreeOperators<T>::J(ConstRef<T> nu, Ref<T> a) {
  Numbers& own = *own_;
  own.check(nu, own.structure->dofs(), a, own.structure->rows);
  for (Index c = 0; c < nu.cols(); ++c) {
    const T* const x = nu.data() + c * nu.outerStride();
    own.outwards(x);
    own.rows_of_motion(x, a.data() + c * a.outerStride());
  }
}

template <class T> void TreeOperators<T>::J_transposed(ConstRef<T> lambda, Ref<T> tau) {
  Numbers& own = *own_;
  own.check(lambda, own.structure->rows, tau, own.structure->dofs());
  for (Index c = 0; c < lambda.cols(); ++c) {
    T* const y = tau.data() + c * tau.outerStride();
    own.forces_of_rows(lambda.data() + c * lambda.outerStride(), y);
    own.inwards(y);
  }
}

template <class T> void TreeOperators<T>::M(ConstRef<T> nu, Ref<T> tau) {
  Numbers& own = *own_;
  own.check(nu, own.structure->dofs(), tau, own.structure->dofs());
  for (Index c = 0; c < nu.cols(); ++c) {
    const T* const x = nu.data() + c * nu.outerStride();
    T* const y = tau.data() + c * tau.outerStride();
    own.outwards(x);
    for (Index i = 0; i < own.structure->bodies(); ++i) own.body[i] = multiply(load(own.problem->H[i]), own.body[i]);
    for (Index k = 0; k < own.structure->dofs(); ++k) y[k] = own.problem->armature[k] * x[k];
    own.inwards(y);
  }
}

template <class T> Report TreeOperators<T>::M_inverse(ConstRef<T> tau, Ref<T> nu) {
  Numbers& own = *own_;
  own.check(tau, own.structure->dofs(), nu, own.structure->dofs());
  if (!own.factor_now().ok()) nu.setConstant(ScalarTraits<T>::nan());
  for (Index c = 0; c < tau.cols() && own.factored.ok(); ++c)
    own.factor.solve(own.none.data(), tau.data() + c * tau.outerStride(), own.rates.data(), nu.data() + c * nu.outerStride(), own.sweep.data());
  return own.factored;
}

template <class T> Report TreeOperators<T>::delassus(ConstRef<T> lambda, Ref<T> a) {
  Numbers& own = *own_;
  own.check(lambda, own.structure->rows, a, own.structure->rows);
  if (!own.factor_now().ok()) a.setConstant(ScalarTraits<T>::nan());
  for (Index c = 0; c < lambda.cols() && own.factored.ok(); ++c)
    own.factor.project(lambda.data() + c * lambda.outerStride(), a.data() + c * a.outerStride(), own.sweep.data());
  return own.factored;
}

#define DELASSUS_INSTANTIATE(T) template class TreeOperators<T>;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
