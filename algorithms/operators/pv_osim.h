// pv_osim, pv_osimr: the Delassus matrix in propagation form, in the whole tree and in the contracted one.
//
// What     A₀ = J M⁻¹Jᵀ by carrying each row of J inwards through the articulated-body factor of M; A = A₀ + R⁻¹ as explicit.h.
// Formula  pv_osim   G_i = κ_i S_i + 𝒦_i,  A₀ += G_i D_i⁻¹G_iᵀ,  κ_π += κ_i − G_i D_i⁻¹U_iᵀ
//          pv_osimr  A₀,rs = κ_r(l) Ω_l κ_s(l)ᵀ at the body l where two rows meet, and G D⁻¹Gᵀ at roots and joints with rows
//          A row starts at each of its bodies and adds up where its branches meet: loops and n-ary constraints as any other.
// Singular M: lost_pivot at a joint's first degree of freedom; A as explicit.h.
// How      row_propagation.h.
// Cost     update: the factor of M, 330 n; then pv_osim O(m²d), pv_osimr O(n + m²); and m³/3 for the factor of A.
// Workspace  for a pair that of the sweeps; row_propagation.h.
// Error    apply componentwise: every entry is a sum over paths of products that the entry's own sensitivity contains, each
//          rounded once per joint passed, like the vectors of aba_sweep. solve normwise κ(A).
// Source   A. S. Sathya, W. Decré, J. Swevers, PV-OSIMr, 2024; loops: docs/paper_notes.md.
#pragma once

#include "algorithms/factors/row_propagation.h"
#include "algorithms/operators/explicit.h"

namespace delassus {

template <class T, Tree tree> class PvOsimWith : public ExplicitBySweeps<T> {
 protected:
  void analyze_form() override {
    ExplicitBySweeps<T>::analyze_form();
    rows_.analyze(*this->structure(), this->plan_, tree);
  }
  void form(const Problem<T>& problem, MatrixX<T>& A0) override {
    this->factor_M_.move_rows(problem);
    rows_.load(problem);
    rows_.form(this->factor_M_, A0);
  }
  [[nodiscard]] Index form_bytes() const override { return ExplicitBySweeps<T>::form_bytes() + rows_.bytes(); }

 private:
  RowPropagation<T> rows_;
};

template <class T> using PvOsim = PvOsimWith<T, Tree::whole>;
template <class T> using PvOsimR = PvOsimWith<T, Tree::contracted>;

}  // namespace delassus
