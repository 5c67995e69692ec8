// The two sweeps of Factor: y = J M_R⁻¹ Jᵀ x over the active steps; ν = M_R⁻¹(Jᵀx + τ) over all.
#include "algorithms/factors/factor.h"
#include "algorithms/kit/instantiate.h"

namespace delassus {
namespace {
// V's from a buffer of V's: f of every active body, then u of every active column.
template <class V> Six<V>* forces(V* work) { return reinterpret_cast<Six<V>*>(work); }
}  // namespace

// Alg. 1, lines 1–6: f_i = Σ K_e^iᵀ x_e, u_i = 𝒦ᵢᵀ x_i (in the basis of D).
template <class T> template <class V> void Factor<T>::scatter(const V* x, Six<V>* f, V* u) const {
  for (int i = 0; i < plan_->active(); ++i) f[i] = Six<V>::zero();
  for (int c = 0; c < plan_->active_columns(); ++c) u[c] = V{};
  rows_->scatter(x, f);
  for (const JointRows& j : joint_rows_)
    for (Index r = 0; r < j.rows; ++r)
      for (int c = 0; c < j.dofs; ++c) u[j.column + c] += x[j.row + r] * joint_k_[j.first + r * j.dofs + c];
}

// u = τ + Sᵀf; f_π += f_i; f_j −= W_j D⁻¹ u; u ← D⁻¹u      (Alg. 2, lines 2–6; Alg. 4, lines 13, 23, 31)
template <class T> template <class V> void Factor<T>::backward(Plan::Runs runs, Six<V>* f, V* u) const {
  const int a = plan_->first_active, column0 = plan_->first_column[a];
  for (const Plan::Run& run : runs) {
    if (run.chain) {
      Six<V> fi = f[run.begin - a];
      for (int i = run.begin; i < run.end; ++i) {
        const int c = plan_->first_column[i];
        V& uc = u[c - column0];
        uc += dot(s_[c], fi);
        add(fi, f[plan_->parent[i] - a]);
        subtract_scaled(fi, w_[plan_->first_w[i]], uc);
        uc *= d_inverse_[c];
      }
      f[plan_->parent[run.end - 1] - a] = fi;
      continue;
    }
    if (run.simple && run.dofs == 1) {
      for (int i = run.begin; i < run.end; ++i) {
        const int c = plan_->first_column[i];
        Six<V> fi = f[i - a];
        V& uc = u[c - column0];
        uc += dot(s_[c], fi);
        subtract_scaled(fi, w_[plan_->first_w[i]], uc);
        add(f[plan_->parent[i] - a], fi);
        uc *= d_inverse_[c];
      }
      continue;
    }
    for (int i = run.begin; i < run.end; ++i) {
      const int first = plan_->first_column[i];
      V* const ui = u + first - column0;
      add_dots(ui, s_.data() + first, f[i - a], run.dofs);
      if (plan_->parent[i] >= 0) add(f[plan_->parent[i] - a], f[i - a]);
      const Six<T>* w = w_.data() + plan_->first_w[i];
      for (int k = plan_->first_member[i]; k < plan_->first_member[i + 1]; ++k) {
        Six<V> fj = f[plan_->members[k].step - a];
        for (int c = 0; c < run.dofs; ++c) subtract_scaled(fj, *w++, ui[c]);
        f[plan_->members[k].step - a] = fj;
      }
      for (int c = 0; c < run.dofs; ++c) ui[c] *= d_inverse_[first + c];
    }
  }
}

// ν = D⁻¹u − Σ_j (W_j D⁻¹)ᵀ a_j; a_i = a_π + S_i ν      (Alg. 4, lines 33–37); a takes the place of f
template <class T> template <class V> void Factor<T>::forward(Plan::Runs runs, Six<V>* f, V* u) const {
  const int a = plan_->first_active, column0 = plan_->first_column[a];
  for (auto run = runs.rbegin(); run != runs.rend(); ++run) {
    if (run->simple && run->dofs == 1) {
      Six<V> ai = f[plan_->parent[run->end - 1] - a];
      for (int i = run->end; i-- > run->begin;) {
        const int c = plan_->first_column[i];
        if (!run->chain) ai = f[plan_->parent[i] - a];
        V& uc = u[c - column0];
        uc -= dot(w_[plan_->first_w[i]], ai);
        add_scaled(ai, s_[c], uc);
        f[i - a] = ai;
      }
      continue;
    }
    for (int i = run->end; i-- > run->begin;) {
      const int first = plan_->first_column[i], n = run->dofs;
      V* const ui = u + first - column0;
      const Six<T>* w = w_.data() + plan_->first_w[i];
      for (int k = plan_->first_member[i]; k < plan_->first_member[i + 1]; ++k, w += n)
        subtract_dots(ui, w, f[plan_->members[k].step - a], n);
      Six<V> ai = plan_->parent[i] >= 0 ? f[plan_->parent[i] - a] : Six<V>::zero();
      for (int c = 0; c < n; ++c) add_scaled(ai, s_[first + c], ui[c]);
      f[i - a] = ai;
    }
  }
}

// Alg. 3, lines 4–8: y_e = Σ K_e^i a_i, y_i = 𝒦ᵢ ν_i.
template <class T> template <class V> void Factor<T>::gather(const Six<V>* f, const V* u, V* y) const {
  rows_->gather(f, y);
  for (const JointRows& j : joint_rows_)
    for (Index r = 0; r < j.rows; ++r) {
      V sum{};
      for (int c = 0; c < j.dofs; ++c) sum += u[j.column + c] * joint_k_[j.first + r * j.dofs + c];
      y[j.row + r] = sum;
    }
}

template <class T> template <class V> void Factor<T>::project(const V* x, V* y, V* work) const {
  Six<V>* const f = forces(work);
  V* const u = work + plan_->active() * (sizeof(Six<V>) / sizeof(V));
  scatter(x, f, u);
  backward(plan_->active_runs(), f, u);
  forward(plan_->active_runs(), f, u);
  gather(f, u, y);
}

template <class T> template <class V> struct Factor<T>::Whole {
  Six<V>*const f, *const active_f;
  V *const u, *const active_u;
  Whole(const Plan& plan, V* work)
      : f(forces(work)), active_f(f + plan.first_active), u(work + plan.steps * static_cast<Index>(sizeof(Six<V>) / sizeof(V))),
        active_u(u + plan.first_column[plan.first_active]) {
    std::fill(f, active_f, Six<V>::zero());
    std::fill(u, active_u, V{});
  }
};

// u += Eᵀτ
template <class T> template <class V> void Factor<T>::add_torques(const V* tau, V* u) const {
  for (int i = 0; i < plan_->steps; ++i) {
    const int first = plan_->first_column[i], n = plan_->first_column[i + 1] - first;
    const V* const t = tau + structure_->first_dof[plan_->body[i]];
    if (n == 1) u[first] += t[0];
    if (n <= 1) continue;
    const Six<V> of_joint = load(t, n);
    const Six<T>* const e = e_.data() + vector_of_[i];
    for (int c = 0; c < n; ++c) u[first + c] += dot(e[c], of_joint);
  }
}

// ν = E u
template <class T> template <class V> void Factor<T>::velocities(const V* u, V* nu) const {
  for (int i = 0; i < plan_->steps; ++i) {
    const int first = plan_->first_column[i], n = plan_->first_column[i + 1] - first;
    V* const v = nu + structure_->first_dof[plan_->body[i]];
    if (n == 1) v[0] = u[first];
    if (n <= 1) continue;
    const Six<T>* const e = e_.data() + vector_of_[i];
    Six<V> of_joint = scaled(e[0], u[first]);
    for (int c = 1; c < n; ++c) add_scaled(of_joint, e[c], u[first + c]);
    for (int c = 0; c < n; ++c) v[c] = of_joint[c];
  }
}

template <class T> template <class V> void Factor<T>::solve(const V* x, const V* tau, V* y, V* nu, V* work) const {
  const Whole<V> all(*plan_, work);
  scatter(x, all.active_f, all.active_u);
  if (tau != nullptr) add_torques(tau, all.u);
  backward(tau != nullptr ? plan_->all_runs() : plan_->active_runs(), all.active_f, all.active_u);
  forward(plan_->all_runs(), all.active_f, all.active_u);
  gather(all.active_f, all.active_u, y);
  velocities(all.u, nu);
}

template <class T> template <class V> V Factor<T>::energy(const V* tau, V* work) const {
  const Whole<V> all(*plan_, work);
  const int columns = plan_->first_column[plan_->steps];
  std::fill(all.active_f, all.f + plan_->steps, Six<V>::zero());
  std::fill(all.active_u, all.u + columns, V{});
  add_torques(tau, all.u);
  backward(plan_->all_runs(), all.active_f, all.active_u);
  V sum{};  // Σ u² / D
  for (int c = 0; c < columns; ++c) sum += all.u[c] * all.u[c] / d_inverse_[c];
  return sum;
}

template <class T> template <class V> void Factor<T>::half(const V* x, V* z, V* work) const {
  Six<V>* const f = forces(work);
  V* const u = work + plan_->active() * static_cast<Index>(sizeof(Six<V>) / sizeof(V));
  scatter(x, f, u);
  backward(plan_->active_runs(), f, u);
  std::copy(u, u + plan_->active_columns(), z);
}

// Ω_i = S D⁻¹Sᵀ + (I − S Wᵀ) Ω_π (I − W Sᵀ); of ν_i, in the basis of D:  D⁻¹ + Wᵀ Ω_π W, its columns
template <class T> void Factor<T>::mobility(int i, SixBySix<T>* omega, Six<T> (&V)[6]) const {
  const int first = plan_->first_column[i], n = plan_->first_column[i + 1] - first, p = plan_->parent[i];
  const Six<T>* const w = w_.data() + plan_->first_w[i];
  omega[i] = p < 0 ? SixBySix<T>::zero() : omega[p];
  for (int c = 0; c < n; ++c) {
    V[c] = scaled(unit_vector<T>(c), d_inverse_[first + c]);
    if (p < 0) {
      add_outer(omega[i], s_[first + c], scaled(s_[first + c], d_inverse_[first + c]));
      continue;
    }
    const Six<T> pushed = multiply(omega[p], w[c]);
    subtract_outer(omega[i], s_[first + c], pushed);
    subtract_outer(omega[i], pushed, s_[first + c]);
    for (int e = 0; e < n; ++e) V[c].v[e] += dot(w[e], pushed);
  }
  for (int c = 0; c < n && p >= 0; ++c) {
    Six<T> moved = Six<T>::zero();
    for (int e = 0; e < n; ++e) add_scaled(moved, s_[first + e], T(V[c][e]));
    add_outer(omega[i], s_[first + c], moved);
  }
}

// From the roots outwards.
template <class T> void Factor<T>::row_mobility(T* d, SixBySix<T>* omega) const {
  for (int i = plan_->steps; i-- > 0;) {
    const int n = plan_->first_column[i + 1] - plan_->first_column[i];
    Six<T> V[6];
    mobility(i, omega, V);
    const int step = i - plan_->first_active;
    for (int j = step < 0 ? 0 : first_joint_rows_[step]; step >= 0 && j < first_joint_rows_[step + 1]; ++j)
      for (Index r = 0; r < joint_rows_[j].rows; ++r) {
        const T* const k = joint_k_.data() + joint_rows_[j].first + r * n;
        T& of_row = d[joint_rows_[j].row + r] = T(0);
        for (int c = 0; c < n; ++c)
          for (int e = 0; e < n; ++e) of_row += k[c] * V[c][e] * k[e];
      }
  }
  rows_->mobility(omega + plan_->first_active, d);
}

// The diagonal of E V Eᵀ of every joint.
template <class T> void Factor<T>::joint_mobility(T* d, SixBySix<T>* omega) const {
  for (int i = plan_->steps; i-- > 0;) {
    const int n = plan_->first_column[i + 1] - plan_->first_column[i];
    Six<T> V[6];
    mobility(i, omega, V);
    T* const of_joint = d + structure_->first_dof[plan_->body[i]];
    if (n == 1) of_joint[0] = V[0][0];
    if (n <= 1) continue;
    const Six<T>* const E = e_.data() + vector_of_[i];
    Six<T> sum = Six<T>::zero();
    for (int c = 0; c < n; ++c) {
      Six<T> column = Six<T>::zero();
      for (int e = 0; e < n; ++e) add_scaled(column, E[e], T(V[c][e]));
      add(sum, product(E[c], column));
    }
    for (int j = 0; j < n; ++j) of_joint[j] = sum[j];
  }
}

#define DELASSUS_INSTANTIATE(T) template void Factor<T>::solve<T>(const T*, const T*, T*, T*, T*) const; template T Factor<T>::energy<T>(const T*, T*) const; \
  template void Factor<T>::project<T>(const T*, T*, T*) const; template void Factor<T>::row_mobility(T*, SixBySix<T>*) const; \
  template void Factor<T>::joint_mobility(T*, SixBySix<T>*) const; template void Factor<T>::half<T>(const T*, T*, T*) const;
DELASSUS_FOR_EACH_SCALAR(DELASSUS_INSTANTIATE)
#ifdef DELASSUS_EXACT
DELASSUS_INSTANTIATE(Stochastic)
template void Factor<Stochastic>::scatter(const Stochastic*, Six<Stochastic>*, Stochastic*) const;
template void Factor<Stochastic>::backward(Plan::Runs, Six<Stochastic>*, Stochastic*) const;
template void Factor<Stochastic>::forward(Plan::Runs, Six<Stochastic>*, Stochastic*) const;
template void Factor<Stochastic>::gather(const Six<Stochastic>*, const Stochastic*, Stochastic*) const;
#else
template void Factor<double>::project<Lanes8>(const Lanes8*, Lanes8*, Lanes8*) const;
template void Factor<double>::solve<Lanes8>(const Lanes8*, const Lanes8*, Lanes8*, Lanes8*, Lanes8*) const;
template Lanes8 Factor<double>::energy<Lanes8>(const Lanes8*, Lanes8*) const;
template void Factor<double>::half<Lanes8>(const Lanes8*, Lanes8*, Lanes8*) const;
template void Factor<float>::half<Lanes8f>(const Lanes8f*, Lanes8f*, Lanes8f*) const;
template void Factor<float>::project<Lanes8f>(const Lanes8f*, Lanes8f*, Lanes8f*) const;
template void Factor<float>::solve<Lanes8f>(const Lanes8f*, const Lanes8f*, Lanes8f*, Lanes8f*, Lanes8f*) const;
#endif

}  // namespace delassus
