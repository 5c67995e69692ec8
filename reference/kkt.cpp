#include "algorithms/kit/test_scalars.h"
#include "reference/kkt.h"

namespace delassus::reference {

namespace {

template <class T> void add(std::vector<KktEntry<T>>& entries, Index row, Index column, const T& value) {
  if (!(value == T(0))) entries.push_back({row, column, value});
}

template <class T> void add_bodies(Kkt<T>& out, const Problem<T>& p) {
  const Structure& s = *p.structure;
  for (Index i = 0; i < s.bodies(); ++i) {
    for (Index c = 0; c < 6; ++c)
      for (Index r = c; r < 6; ++r) add(out.motion, out.layout.a(i) + r, out.layout.a(i) + c, p.H[i](r, c));
    for (Index r = 0; r < 6; ++r) {
      add(out.motion, out.layout.phi(i) + r, out.layout.a(i) + r, T(1));
      if (s.parent[i] != ground) add(out.motion, out.layout.phi(i) + r, out.layout.a(s.parent[i]) + r, T(-1));
      for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k)
        add(out.motion, out.layout.nu(k), out.layout.phi(i) + r, T(-p.S[k][r]));
    }
    for (Index k = s.first_dof[i]; k < s.first_dof[i + 1]; ++k)
      add(out.motion, out.layout.nu(k), out.layout.nu(k), p.armature[k]);
  }
}

template <class T> void add_constraints(Kkt<T>& out, const Problem<T>& p) {
  const Structure& s = *p.structure;
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (Index r = 0; r < e.rows; ++r)
        for (Index c = 0; c < 6; ++c)
          add(out.constraints, out.layout.mu(e.row + r), out.layout.a(link.body) + c, p.K[link.first + r][c]);
  for (const auto& j : s.joint_constraints) {
    const Index n = s.dofs(j.body);
    for (Index r = 0; r < j.rows; ++r)
      for (Index k = 0; k < n; ++k)
        add(out.constraints, out.layout.mu(j.row + r), out.layout.nu(s.first_dof[j.body] + k), p.joint_K[j.first + r * n + k]);
  }
}

template <class T> void add_damping(Kkt<T>& out, const Damping<T>& damping) {
  for (Index r = 0; r < out.layout.rows; ++r) add(out.damping, r, r, damping.diagonal[r]);
  for (const auto& block : damping.blocks)
    for (Index j = 0; j < block.R_inverse.cols(); ++j)
      for (Index i = j; i < block.R_inverse.rows(); ++i)
        add(out.damping, block.row + i, block.row + j, block.R_inverse(i, j));
}

}  // namespace

template <class T> Kkt<T> kkt(const Problem<T>& problem, const Damping<T>& damping) {
  problem.check_sizes();
  const Structure& s = *problem.structure;
  require(static_cast<Index>(damping.diagonal.size()) == s.rows, "kkt: damping does not fit");
  Kkt<T> out;
  out.layout = {s.bodies(), s.dofs(), s.rows};
  add_bodies(out, problem);
  add_constraints(out, problem);
  add_damping(out, damping);
  return out;
}

template <class T> MatrixX<T> Kkt<T>::forces(const MatrixX<T>& f) const {
  MatrixX<T> out = MatrixX<T>::Constant(layout.motion_size(), f.cols(), T(0));
  for (Index c = 0; c < f.cols(); ++c)
    for (const auto& e : constraints) out(e.column, c) += e.value * f(e.row - layout.motion_size(), c);
  return out;
}

template <class T> MatrixX<T> Kkt<T>::accelerations(const MatrixX<T>& motion_unknowns, const MatrixX<T>& f) const {
  MatrixX<T> out = MatrixX<T>::Constant(layout.rows, f.cols(), T(0));
  for (Index c = 0; c < f.cols(); ++c) {
    for (const auto& e : constraints) out(e.row - layout.motion_size(), c) += e.value * motion_unknowns(e.column, c);
    for (const auto& e : damping) {
      out(e.row, c) += e.value * f(e.column, c);
      if (e.row != e.column) out(e.column, c) += e.value * f(e.row, c);
    }
  }
  return out;
}

template <class T> std::vector<KktEntry<T>> Kkt<T>::entries(bool with_rows) const {
  std::vector<KktEntry<T>> all = motion;
  if (!with_rows) return all;
  all.insert(all.end(), constraints.begin(), constraints.end());
  for (const auto& e : damping) all.push_back({layout.mu(e.row), layout.mu(e.column), T(-e.value)});
  return all;
}

#define DELASSUS_INSTANTIATE(T)   \
  template struct Kkt<T>;         \
  template Kkt<T> kkt(const Problem<T>&, const Damping<T>&);
DELASSUS_INSTANTIATE(double)
DELASSUS_INSTANTIATE(Quad)
DELASSUS_INSTANTIATE(Rational)

}  // namespace delassus::reference
