// What velocities do: twists, velocity products, bias forces c(q, ν), J̇ν, and inverse dynamics (RNEA).
//
// What     Of a Mechanism at its last q and joint velocities ν:
//            twists             J_i ν                       accelerations at rest, ν̇ = 0:   J̇_i ν
//            bias forces        c(q, ν) of  M ν̇ + c = τ + Jᵀλ                  (paper, equation 2a)
//            bias of the rows   J̇ν, so that the rows accelerate by  J ν̇ + J̇ν   (2b: a_des = −J̇ν)
//            rnea               τ = M ν̇ + c
// How      Newton–Euler in 3-vectors, world axes; p_i the origin of body i's frame, r = p_i − p_π, and (ω_J, v_J) the motion of the
//          joint:
//            ω_i = ω_π + ω_J,   v_i = v_π + ω_π × r + v_J
//            α_i = α_π + ω_π × ω_J + e_ω,   a_i = a_π + α_π × r + ω_π × (ω_π × r + 2 v_J) + e_v
//            e_ω = ω_1 × ω_2 for the two axes of a universal joint,  e_v = ω_J × v_J for a floating one, whose v is in body axes
//            F_i = m (a_c − g),  N_i = I α + ω × I ω about the centre of mass c;  summed inwards,  c_k = S_kᵀ (N; F).
//          v_i is taken relative to the velocity of the tree's reference point: how fast a robot travels costs no digit but where
//          its own joint velocities say so. The velocities of reference points enter as differences, where rows join two trees or
//          a tree and the world, and in `general` rows and twists.
// Rows     are those of Mechanism (model.h), differentiated as they stand: frames fixed on their bodies, axes those of frame a. At a
//          contact that is the acceleration of the two material points; how its point rolls on is the scene's business. Rows on
//          joints, limits and couplings have constant numbers 𝒦 in ν: their J̇ν is zero.
// Armature turns about its own joint only: A_k ν̇_k, no bias (as with every library that keeps it on the diagonal of M).
// Cost     O(N + m): about 230 operations a body for c, 60 a row's frame. Nothing allocates after the constructor.
// Error    componentwise: eps of the terms that are added.
// Scalars  as Mechanism. Threads: one each.
// Source   J. Luh, M. Walker, R. Paul 1980 (paper's [33]); R. Featherstone 2014 (paper's [20]), chapters 2 and 5.
#pragma once

#include "algorithms/mechanism/mechanism.h"

namespace delassus {

template <class T> class Motion {
 public:
  /// `mechanism` must outlive this.
  explicit Motion(const Mechanism<T>& mechanism);

  /// At the mechanism's last q and the velocities ν (n, as model.h orders them). @throws std::logic_error when ν does not fit.
  void update(const VectorX<T>& nu);

  /// J_i ν of every body: (ω; v), world axes, v [m/s] of the body's point that is at its tree's reference point.
  void twists(std::vector<Vector6<T>>& out) const;
  /// J̇_i ν of every body, the reference point held where it is: spatial accelerations at ν̇ = 0, without gravity.
  void velocity_products(std::vector<Vector6<T>>& out) const;
  /// J̇ν. Shape m, in the order and axes of the rows of J.
  void bias_rows(VectorX<T>& out) const;
  /// c(q, ν) with the acceleration of gravity g [m/s², world axes]: Coriolis, centrifugal and gravity forces. Shape n [N m or N].
  void bias_forces(const Vector3<T>& g, VectorX<T>& c);
  /// Without gravity.
  void bias_forces(VectorX<T>& c) { bias_forces(Vector3<T>(T(0), T(0), T(0)), c); }
  /// τ = M ν̇ + c(q, ν), the torques that move the tree so without constraint forces. Shapes n.
  /// @throws std::logic_error when ν̇ does not fit.
  void rnea(const VectorX<T>& acceleration, const Vector3<T>& g, VectorX<T>& tau);

 private:
  using Joint = typename Mechanism<T>::Joint;
  using End = typename Mechanism<T>::End;
  using Pair = typename Mechanism<T>::Pair;
  using Terms = typename Mechanism<T>::Terms;
  struct Parts {  // of a motion: angular, and of the origin of the body's frame; of a force: moment and force
    Three<T> angular, linear;
  };
  struct Moving;  // an end of a constraint: motion_rows.cpp

  [[nodiscard]] Parts joint_motion(const Joint& joint, Index i, const T* rates) const;
  [[nodiscard]] Parts own_product(const Joint& joint, Index i, const T* rates) const;
  void accelerations(const T* rates, std::vector<Parts>& out) const;
  void forces(const std::vector<Parts>& accelerations, const Three<T>& g);
  void inward(T* c);
  [[nodiscard]] Vector6<T> about_reference(Index i, const Parts& of_origin) const;
  [[nodiscard]] Three<T> reference_velocity(Index body) const;
  [[nodiscard]] Moving moving(const End& end) const;
  void pair_bias(const Pair& pair, T* out) const;
  void terms_bias(const Terms& terms, T* out) const;

  const Mechanism<T>* mechanism_;
  std::vector<Parts> joint_, own_;      // ω_J, v_J; e_ω, e_v
  std::vector<Parts> velocity_;         // ω, v relative to the reference point's
  std::vector<Parts> product_;          // α, a at ν̇ = 0
  std::vector<Parts> accelerated_;      // at the last ν̇ of rnea
  std::vector<Parts> force_;            // about the reference point
  std::vector<Three<T>> of_reference_;  // at roots: the velocity of the reference point
};

}  // namespace delassus
