// The solve of SquareRootFactor: one sweep over the fronts up, one down.
#include "algorithms/factors/square_root_factor.h"
#include "algorithms/kit/columns.h"
#include "algorithms/kit/instantiate.h"

#include <algorithm>

namespace delassus {

// Rows of front i of (0, W r₂), carried on by the fronts below; then Q_iᵀ. A row of M comes last and brings zero.
template <class T> void SquareRootFactor<T>::fit(int i, const T* right, T* x, T* c1) const {
  const Front& f = fronts_.fronts[i];
  T* const xi = x + f.row;
  T* next = xi;
  for (int c = f.first_constraint; c < f.first_constraint + f.constraints; ++c)
    next = std::copy_n(right + fronts_.constraints[c].row, fronts_.constraints[c].rows, next);
  for (int g = f.first_given; g < f.first_given + f.given; ++g) {
    const FrontPlan::Handed& h = fronts_.handed[fronts_.given[g]];
    next = std::copy_n(x + fronts_.fronts[h.source].row + h.row, h.rows, next);
  }
  std::fill(next, xi + f.stride, T(0));
  for (int k = 0; k < f.reflections; ++k) {
    const int last = f.last(k);
    reflect(xi, v_.data() + f.v + k * f.stride, beta_[f.reflection + k], last + 1);
    std::swap(xi[pivot_[f.reflection + k]], xi[last]);
    if (k < f.dofs) c1[k] = std::exchange(xi[last], T(0));
  }
}

// Q_i, and the residual of every row back to where the row came from.
template <class T> void SquareRootFactor<T>::unfit(int i, const T* w, T* x, T* residual) const {
  const Front& f = fronts_.fronts[i];
  T* const xi = x + f.row;
  for (int k = f.reflections; k-- > 0;) {
    const int last = f.last(k);
    if (k < f.dofs) xi[last] = -w[k];
    std::swap(xi[pivot_[f.reflection + k]], xi[last]);
    reflect(xi, v_.data() + f.v + k * f.stride, beta_[f.reflection + k], last + 1);
  }
  const T* next = xi;
  for (int c = f.first_constraint; c < f.first_constraint + f.constraints; ++c) {
    std::copy_n(next, fronts_.constraints[c].rows, residual + fronts_.constraints[c].row);
    next += fronts_.constraints[c].rows;
  }
  for (int g = f.first_given; g < f.first_given + f.given; ++g) {
    const FrontPlan::Handed& h = fronts_.handed[fronts_.given[g]];
    std::copy_n(next, h.rows, x + fronts_.fronts[h.source].row + h.row);
    next += h.rows;
  }
}

// w_i = T_i⁻ᵀ (P_iᵀ r₁ − (S_i P_i)ᵀ f_i);  f_π += f_i;  f_b += C_bᵀ w_i: Tᵀ w = r₁ by forces
template <class T> void SquareRootFactor<T>::push_force(int i, const T* r1, Six<T>* force, T* w) const {
  const Front& f = fronts_.fronts[i];
  const int first = plan_.first_column[i];
  const T* const r = r1 + structure_->first_dof[plan_.body[i]];
  const Six<T>*const motion = mass_.motion(i), *const basis = mass_.basis(i);
  T u[6];
  for (int k = 0; k < f.dofs; ++k) {
    u[k] = -dot(motion[k], force[i]);
    for (int j = 0; j <= k; ++j) u[k] += T(basis[k][j]) * r[j];
  }
  for (int k = 0; k < f.dofs; ++k) {
    w[k] = u[lane_[first + k]];
    for (int j = 0; j < k; ++j) w[k] -= T(t_[first + j][lane_[first + k]]) * w[j];
    w[k] *= t_inverse_[first + k];
  }
  if (f.parent_block > 0) add(force[plan_.parent[i]], force[i]);
  for (int b = 0; b < f.members; ++b)
    for (int k = 0; k < f.dofs; ++k)
      add_scaled(force[plan_.members[f.first_member + b].step], c_[f.c + b * f.dofs + k], w[k]);
}

// T_i μ_i = y_i − Σ_b C_b a_b;  ν_i = P_i μ_i;  a_i = a_π + (S_i P_i) μ_i
template <class T> void SquareRootFactor<T>::move(int i, const T* y, Six<T>* acceleration, T* dnu) const {
  const Front& f = fronts_.fronts[i];
  const int first = plan_.first_column[i];
  T mu[6];
  for (int k = f.dofs; k-- > 0;) {
    T sum = y[k];
    for (int b = 0; b < f.members; ++b)
      sum -= dot(c_[f.c + b * f.dofs + k], acceleration[plan_.members[f.first_member + b].step]);
    for (int j = k + 1; j < f.dofs; ++j) sum -= T(t_[first + k][lane_[first + j]]) * mu[lane_[first + j]];
    mu[lane_[first + k]] = sum * t_inverse_[first + k];
  }
  Six<T> a = f.parent_block > 0 ? acceleration[plan_.parent[i]] : Six<T>::zero();
  T* const nu = dnu + structure_->first_dof[plan_.body[i]];
  const Six<T>*const motion = mass_.motion(i), *const basis = mass_.basis(i);
  for (int k = 0; k < f.dofs; ++k) {
    add_scaled(a, motion[k], mu[k]);
    nu[k] = T(0);
    for (int j = k; j < f.dofs; ++j) nu[k] += T(basis[j][k]) * mu[j];
  }
  acceleration[i] = a;
}

template <class T>
void SquareRootFactor<T>::solve_kkt(const T* r1, const T* r2, T* dnu, T* dlambda, T* work) const {
  const Index m = structure_->rows, n = structure_->dofs();
  Six<T>* const body = reinterpret_cast<Six<T>*>(work);  // forces going up, accelerations going down
  T* const w = work + plan_.steps * static_cast<Index>(sizeof(Six<T>) / sizeof(T));
  T* const y = w + padded(n);
  T* const x = y + padded(n);
  T* const right = x + fronts_.rows;
  T* const residual = right + padded(m);
  root_.multiply(r2, right);
  std::fill_n(body, plan_.steps, Six<T>::zero());
  std::fill_n(w, 2 * padded(n), T(0));
  for (int i = 0; i < plan_.steps; ++i) {
    const int first = plan_.first_column[i];
    if (r1 != nullptr) push_force(i, r1, body, w + first);
    fit(i, right, x, y + first);  // y = c₁ …
    for (int k = 0; k < fronts_.fronts[i].dofs; ++k) y[first + k] += w[first + k];  // … + w
  }
  for (int i = plan_.steps; i-- > 0;) {
    move(i, y + plan_.first_column[i], body, dnu);
    unfit(i, w + plan_.first_column[i], x, residual);
  }
  root_.multiply_transposed(residual, dlambda);
}

template <class T> Index SquareRootFactor<T>::workspace() const {
  return plan_.steps * static_cast<Index>(sizeof(Six<T>) / sizeof(T)) + 2 * padded(structure_->dofs()) + fronts_.rows +
         2 * padded(structure_->rows);
}

#define DELASSUS_INSTANTIATE(T)                                                                        \
  template void SquareRootFactor<T>::solve_kkt(const T*, const T*, T*, T*, T*) const; \
  template Index SquareRootFactor<T>::workspace() const;
DELASSUS_FOR_EACH_SCALAR_WITH_ROOTS(DELASSUS_INSTANTIATE)

}  // namespace delassus
