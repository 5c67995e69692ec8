// What the second readings of robot files (urdf_witness.h, sdf_witness.h) share: rotations, links placed at q, and the
// sums over them. Textbook formulas, no recursion, everything in Quad; nothing here knows a file format or the library's
// algorithms.
//
//   M   = Σ_i m_i Jv_iᵀ Jv_i + Jw_iᵀ R_i I_i R_iᵀ Jw_i,   J_i column by column from the freedoms that move link i
//   A0  = J M⁻¹ Jᵀ
//
// Bounds of the verdict. A rotation carries an error relative to s, the number of rotations it is the product of, a
// position one relative to s ℓ, ℓ the length of the path to it from the tree's reference point, hence for freedoms k, l
//   M: Σ_i s_i (m_i v_ik v_il + |I_i| w_ik w_il) + armature,  v_ik = ℓ_i + ℓ_k, w_ik = 1 (turning) or v = 1, w = 0 (sliding)
//   J: s_i for angular rows, s_i (ℓ_i + ℓ_k) or s_i for linear ones
//   A: G|X| + |X|ᵀJ_bᵀ + ε G|M⁻¹|Gᵀ,  X = M⁻¹Jᵀ,  G = J_b + |X|ᵀ M_b (to second order: entries that cancel are no zeros)
// Zero bounds (a freedom that does not move the link) demand zeros.
#pragma once

#include <array>
#include <vector>

#include "algorithms/kit/test_scalars.h"
#include "algorithms/mechanism/model.h"

namespace delassus::reference {

/// What a model of the file must say at q.
struct WitnessMatrices {
  MatrixX<Quad> M, J, A0;
  MatrixX<Quad> M_bound, J_bound, A_bound;
  bool regular = false;   ///< M is positive definite; otherwise A0 and A_bound are empty
};

namespace witness {

using Triple = std::array<double, 3>;
using Real3 = Vector3<Quad>;
using Real33 = Matrix3<Quad>;

struct Transform {
  Real33 R = Real33::Identity();
  Real3 p = Real3::Constant(Quad(0));
};
[[nodiscard]] Transform operator*(const Transform& a, const Transform& b);
[[nodiscard]] Transform inverse(const Transform& x);

[[nodiscard]] Real3 wide(const Triple& x);
[[nodiscard]] Quad length(const Real3& x);
/// By angle t about a unit axis: 1 + sin t [a] + (1 − cos t) [a]².
[[nodiscard]] Real33 turned(const Real3& axis, const Quad& t);
/// Fixed axes: roll about x, then pitch about y, then yaw about z.
[[nodiscard]] Real33 of_rpy(const Triple& rpy);
/// Of any length but 0.
[[nodiscard]] Real33 of_quaternion(const Quad& w, const Real3& v);

/// One freedom: the velocity of a point x on what it moves is v + w × (x − o).
struct Freedom {
  Real3 w = Real3::Constant(Quad(0)), v = Real3::Constant(Quad(0)), o = Real3::Constant(Quad(0));
  Quad reach;          ///< ℓ of o
  bool turns = false;
};

/// A link at q.
struct Placed {
  Transform X;
  Quad reach;                     ///< ℓ of the origin
  Quad steps = Quad(1);           ///< s: factors of the product of rotations that X.R is
  std::vector<Index> freedoms;    ///< that move it
};

struct Solid {
  double mass = 0;                ///< [kg]
  Transform centre;               ///< of the inertial frame in the link
  std::array<double, 6> inertia{};  ///< ixx ixy ixz iyy iyz izz [kg m²]
};

/// Adds what a link puts into M and its bound.
void add_link(const Solid& solid, const Placed& at, const std::vector<Freedom>& freedoms, MatrixX<Quad>& M, MatrixX<Quad>& bound);
/// Adds six rows from row r on: angular, linear, of a link, in its own axes at its origin.
void add_weld(const Placed& at, const std::vector<Freedom>& freedoms, Index r, MatrixX<Quad>& J, MatrixX<Quad>& bound);
/// A0 and its bound from M and J.
void couple(WitnessMatrices& matrices);

}  // namespace witness
}  // namespace delassus::reference
