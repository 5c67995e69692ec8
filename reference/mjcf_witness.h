// A witness of what was read from an MJCF file: MuJoCo's own M and equality rows of that file, in our q and ν.
//
// How      The file is compiled by MuJoCo and taken through the position stage at the same configuration.
//            M  = Tᵀ mj_fullM T       rows = the rows of efc_J that belong to an equality, in the axes of frame a
//          The three angular rows of a weld are a quaternion's error there; they are taken from mj_jac instead.
// T        takes our ν to MuJoCo's qvel: identity but for free joints, which have the linear velocity first, in world axes.
// Joints   are matched by their order: the k-th of MuJoCo moves the k-th body that is given.
// Inertia  given as `fullinertia` is put in exactly: MuJoCo 2.2.2 finds principal axes to 1e-6 only.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "algorithms/mechanism/kinematics.h"

namespace delassus::reference {

class MjcfWitness {
 public:
  /// `text`: compiled in the place of the file unless empty. `pose`: of MuJoCo's world in ours. `full_inertia`: by body
  /// name, axes of the body. @throws ModelError with MuJoCo's message.
  MjcfWitness(const std::string& file, const std::string& text, const Pose<double>& pose,
              const std::map<std::string, Matrix3<double>>& full_inertia);
  ~MjcfWitness();

  [[nodiscard]] Index joints() const;
  [[nodiscard]] Index equalities() const;
  /// Takes the robot to q of the model (size q_size); `bodies`: of the model, one per joint. Curved couplings are taken
  /// where their master is at qpos0. @throws std::runtime_error when MuJoCo warns.
  void set(const Model& model, const std::vector<Index>& bodies, const VectorX<double>& q);
  [[nodiscard]] MatrixX<double> M() const;  ///< dofs × dofs of the model; zero outside the bodies
  /// Rows of an active equality by its number in the file, in our ν; empty when MuJoCo has none for it.
  [[nodiscard]] MatrixX<double> rows(Index equality) const;
  /// Rows of two sites whose origins (3 rows) or frames (6) coincide, in our ν and the axes of the first: by mj_jac.
  [[nodiscard]] MatrixX<double> site_rows(const std::string& a, const std::string& b, bool weld) const;
  /// Name of an equality in the file; "" for none.
  [[nodiscard]] std::string name(Index equality) const;
  /// Length from MuJoCo's origin to the point about which it computes the tree that a joint is in: the centre of mass of all
  /// that hangs from one body of the world, bodies that stand included [m]. After set.
  [[nodiscard]] double about(Index joint) const;
  /// Joints whose value enters an equality by a polynomial of higher degree.
  [[nodiscard]] std::vector<Index> curved() const;
  [[nodiscard]] double ref(Index joint) const;  ///< qpos0 of a hinge or slide

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace delassus::reference
