// A witness from outside: the same mechanism computed by MuJoCo 2.x, a simulator that shares no line with this library.
//
// How      A Model is written as MJCF text (bodies, joints, inertias, armature, a `connect` equality per point
//          closure), loaded from memory, set to the same q, and taken through the position stage of mj_forward.
//            M  = Tᵀ mj_fullM T            J  = J' T           A0 = J' (mj_solveM J'ᵀ)
//          J' has the `connect` rows of efc_J for `point` constraints and combinations of mj_jac rows, at frames placed
//          by MuJoCo's own xpos and xmat, for all others. Only the axes in which a row is read come from model.h.
// T        takes our ν to MuJoCo's qvel: a free joint there has its linear velocity first, in world axes; a floating
//          joint below another body is three slides and a ball, the slides along the axes of the joint frame; a planar
//          joint is two slides and a hinge. Blocks of T are permutations and rotations. Spherical joints agree.
// Not said in MJCF  Armature that differs between the axes of one ball or free joint, and the second anchor of a closure
//          that is open at q = 0, are set in the compiled model.
// Switched off  balanceinertia, boundmass, boundinertia, settotalmass, inertiafromgeom, fusestatic, autolimits; gravity,
//          contacts, limits, friction. Inertias are given as principal moments and axes, found here: MuJoCo 2.2.2 reads
//          `fullinertia` too, but its own diagonalisation leaves a relative error of up to 1e-6.
// Not served  Massless bodies (MuJoCo refuses them) and armature that differs between the translations of a floating
//          joint (it would turn with the body there).
// Error    MuJoCo works in double from world positions: its own error counts once beside that of what it is compared
//          with, and both are measured with witness_bounds.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "algorithms/mechanism/kinematics.h"

struct mjModel_;
struct mjData_;

namespace delassus::reference {

/// One of MuJoCo's joints; a joint of ours is one to four of them.
struct MujocoJoint {
  enum class Kind : std::uint8_t { hinge, slide, ball, free } kind = Kind::hinge;
  Vector3<double> axis{0, 0, 1};  ///< hinge and slide, joint frame
  Index q = 0, dof = 0;           ///< its first entries in the q and ν of our joint
};
/// The joints of a body in the order MuJoCo applies them.
[[nodiscard]] std::vector<MujocoJoint> mujoco_joints(const Body& body);

/// The name of body i in MuJoCo: b<i>.
[[nodiscard]] std::string mujoco_name(Index body);
/// The name of joint k of a body's mujoco_joints: b<i>.<k>.
[[nodiscard]] std::string mujoco_name(Index body, std::size_t joint);

/// What a text says beyond bodies, joints and points, for who lets the model move (bench/peers/mujoco_scene.h).
struct MujocoMore {
  std::vector<std::string> in_body;              ///< per body: elements of it, geoms say; empty: none
  std::string in_world, assets, equalities, behind;  ///< elements of these sections; behind: further sections
  std::size_t rows = 0, contacts = 0;            ///< room besides that of the points
};
/// The mechanism as MJCF text. @throws ModelError naming the body that MuJoCo cannot represent.
[[nodiscard]] std::string mujoco_xml(const Model& model, const MujocoMore& more = {});

/// MuJoCo's M, J and A0 of a model, in our ν and rows.
class MujocoWitness {
 public:
  /// @throws ModelError for a body that is not served, or with MuJoCo's message when it refuses the text.
  /// Replaces MuJoCo's process-wide handler of warnings; a warning becomes an exception of `set`.
  explicit MujocoWitness(const Model& model, const MujocoMore& more = {});
  ~MujocoWitness();

  /// Takes the mechanism to q (size q_size). @throws std::runtime_error when MuJoCo warns, of a lost pivot say;
  /// std::logic_error when q does not fit.
  void set(const VectorX<double>& q);
  [[nodiscard]] MatrixX<double> M() const;   ///< n × n
  [[nodiscard]] MatrixX<double> J() const;   ///< m × n
  [[nodiscard]] MatrixX<double> A0() const;  ///< m × m: J M⁻¹ Jᵀ by MuJoCo's factorisation. Cost O(n m depth + n m²)

  /// MuJoCo's own, for who asks it for more (bench/peers); body i is mujoco_name(i).
  [[nodiscard]] mjModel_& compiled();
  [[nodiscard]] mjData_& data();
  /// Our q of its qpos; its frames need not be computed.
  [[nodiscard]] VectorX<double> q() const;
  /// T at q, by the frames that it computed last. n × n.
  [[nodiscard]] MatrixX<double> T(const VectorX<double>& q) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Bounds of the verdict for two computations of M, J and A0 that start from the described model instead of from the
/// numbers of one Problem. Rotations carry errors relative to 1 and positions errors relative to the path from the
/// world's origin, whatever the size of the entry that results. So every number of the problem is replaced by the size
/// of what it was computed from:
///   axis → 1,  position of body i → ℓ_i = Σ of the lengths of all translations from the world's origin to it, and the mean
///   of the same lengths to its tree's centre of mass (MuJoCo computes about that), and the length to its root body's (so
///   does kinematics: where the one is far from the tree and the other in it, kinematics loses digits that MuJoCo keeps),
///   I_c → its Frobenius norm; every direction of K → its length; distance rows additionally by (ℓ_a + ℓ_b)/|d| + 1;
///   rows 𝒦 → 1 within their joint,
/// and J = J_abs, M = M_abs of that problem are the path sums of sensitivity.h. With X = M⁻¹Jᵀ of the given problem in
/// Quad, δA = δJ X + Xᵀ δJᵀ − Xᵀ δM X gives, to first order,
///   A = J_abs|X| + |X|ᵀ J_absᵀ + |X|ᵀ M_abs |X|.
struct WitnessBounds {
  MatrixX<double> M, J, A;
};
/// `problem` is kinematics(model, q). `farther`, by body, is added to ℓ: the length to what MuJoCo computes about where our
/// tree is a part of MuJoCo's (MjcfWitness::about). @throws std::runtime_error when M is singular. Cost n³ + n² m in Quad.
[[nodiscard]] WitnessBounds witness_bounds(const Model& model, const VectorX<double>& q, const Problem<double>& problem,
                                           const VectorX<double>& farther = {});

}  // namespace delassus::reference
