// The solve of SquareRootFactor: one sweep over the fronts up, one down.
#include "algorithms/square_root_factor.h"

#include <algorithm>

#include "algorithms/columns.h"

namespace delassus {

// Rows of front i of (0, W r₂), carried on by the fronts below; then Q_iᵀ.
template <class T> void SquareRootFactor<T>::fit(int i, const T* right, T* x) const {
  const Front& f = fronts_.fronts[i];
  T* const xi = x + f.row;
  T* next = xi;
  for (int c = f.first_constraint; c < f.first_constraint + f.constraints; ++c)
    next = std::copy_n(right + fronts_.constraints[c].row, fronts_.constraints[c].rows, next);
  for (int g = f.first_given; g < f.first_given + f.given; ++g) {
    const FrontPlan::Handed& h = fronts_.handed[fronts_.given[g]];
    const int count = handed_count_[fronts_.given[g]];
    if (h.source < plan_.first_active) next = std::fill_n(next, count, T(0));  // no row, no residual
    else {
      const Index source = fronts_.fronts[h.source].row;
      for (int r = 0; r < count; ++r) *next++ = x[source + pivot_[source + h.row + r]];
    }
  }
  std::fill(next, xi + f.stride, T(0));
  reflections(f).apply(xi, reflections_[i], rows_[i]);
}

// Q_i, and the residual of every row back to where the row came from.
template <class T> void SquareRootFactor<T>::unfit(int i, T* x, T* residual) const {
  const Front& f = fronts_.fronts[i];
  T* const xi = x + f.row;
  reflections(f).apply_transposed(xi, reflections_[i], rows_[i]);
  const T* next = xi;
  for (int c = f.first_constraint; c < f.first_constraint + f.constraints; ++c) {
    std::copy_n(next, fronts_.constraints[c].rows, residual + fronts_.constraints[c].row);
    next += fronts_.constraints[c].rows;
  }
  for (int g = f.first_given; g < f.first_given + f.given; ++g) {
    const FrontPlan::Handed& h = fronts_.handed[fronts_.given[g]];
    const int count = handed_count_[fronts_.given[g]];
    const Index source = fronts_.fronts[h.source].row;
    if (h.source >= plan_.first_active)
      for (int r = 0; r < count; ++r) x[source + pivot_[source + h.row + r]] = next[r];
    next += count;
  }
}

// w_i = T_i⁻ᵀ (r₁ − S_iᵀ f_i);  f_π += f_i;  f_b += C_bᵀ w_i: Tᵀ w = r₁ by forces
template <class T> void SquareRootFactor<T>::push_force(int i, const T* r1, Six<T>* force, T* w) const {
  const Front& f = fronts_.fronts[i];
  const int first = plan_.first_column[i];
  const T* const r = r1 + structure_->first_dof[plan_.body[i]];
  T u[6];
  for (int k = 0; k < f.dofs; ++k) u[k] = r[k] - dot(s_[first + k], force[i]);
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

// T_i ν_i = y_i − Σ_b C_b a_b;  a_i = a_π + S_i ν_i
template <class T> void SquareRootFactor<T>::move(int i, const T* y, Six<T>* acceleration, T* dnu) const {
  const Front& f = fronts_.fronts[i];
  const int first = plan_.first_column[i];
  T* const nu = dnu + structure_->first_dof[plan_.body[i]];
  Six<T> a = f.parent_block > 0 ? acceleration[plan_.parent[i]] : Six<T>::zero();
  for (int k = f.dofs; k-- > 0;) {
    T sum = y[k];
    for (int b = 0; b < f.members; ++b)
      sum -= dot(c_[f.c + b * f.dofs + k], acceleration[plan_.members[f.first_member + b].step]);
    for (int j = k + 1; j < f.dofs; ++j) sum -= T(t_[first + k][lane_[first + j]]) * nu[lane_[first + j]];
    nu[lane_[first + k]] = sum * t_inverse_[first + k];
  }
  for (int k = 0; k < f.dofs; ++k) add_scaled(a, s_[first + k], nu[k]);
  acceleration[i] = a;
}

template <class T>
void SquareRootFactor<T>::solve_kkt(const T* r1, const T* r2, T* dnu, T* dlambda, T* work) const {
  const Index m = structure_->rows;
  Six<T>* const body = reinterpret_cast<Six<T>*>(work);  // forces going up, accelerations going down
  T* const y = work + plan_.steps * static_cast<Index>(sizeof(Six<T>) / sizeof(T));
  T* const x = y + padded(structure_->dofs());
  T* const right = x + padded(fronts_.rows);
  T* const residual = right + padded(m);
  root_.multiply(r2, right);
  std::fill_n(body, plan_.steps, Six<T>::zero());
  for (int i = 0; i < plan_.steps; ++i) {
    const int n = fronts_.fronts[i].dofs;
    T* const yi = y + plan_.first_column[i];
    std::fill_n(yi, n, T(0));
    if (r1 != nullptr) push_force(i, r1, body, yi);
    if (i < plan_.first_active) continue;
    fit(i, right, x);
    for (int k = 0; k < n; ++k) {  // y = w + c₁; −w takes the place of c₁
      T& c1 = x[fronts_.fronts[i].row + pivot_[fronts_.fronts[i].row + k]];
      const T w = yi[k];
      yi[k] += c1;
      c1 = -w;
    }
  }
  for (int i = plan_.steps; i-- > 0;) {
    move(i, y + plan_.first_column[i], body, dnu);
    if (i >= plan_.first_active) unfit(i, x, residual);
  }
  root_.multiply_transposed(residual, dlambda);
}

template <class T> Index SquareRootFactor<T>::workspace() const {
  return plan_.steps * static_cast<Index>(sizeof(Six<T>) / sizeof(T)) + padded(structure_->dofs()) +
         padded(fronts_.rows) + 2 * padded(structure_->rows) + 8;
}

#define DELASSUS_INSTANTIATE(T)                                                                        \
  template void SquareRootFactor<T>::solve_kkt(const T*, const T*, T*, T*, T*) const; \
  template Index SquareRootFactor<T>::workspace() const;
DELASSUS_INSTANTIATE(double)
DELASSUS_INSTANTIATE(float)
DELASSUS_INSTANTIATE(Quad)
DELASSUS_INSTANTIATE(Counted)

}  // namespace delassus
