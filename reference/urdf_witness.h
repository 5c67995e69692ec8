// A witness of what a URDF file says: a second reading, and M and J by textbook formulas. Shares no line with models/ and
// no recursion with the library; the model of algorithms/mechanism/model.h only tells the order of ν and what q means.
//
//   X_i   = X_root Π_k X_k(q)                        4 × 4 transforms from the root link to link i
//   J_i   column by column: (axis, axis × (c_i − o)) of a turning freedom at o, (0, axis) of a sliding one
//   M     = Σ_i m_i Jv_iᵀ Jv_i + Jw_iᵀ R_i I_i R_iᵀ Jw_i + diag(armature)
//   J     = rows of mimics (ν_joint − multiplier · ν_master), then six rows for every welded link: angular, linear,
//           in the axes of the link, at its origin
//   A0    = J M⁻¹ Jᵀ
//
// All in Quad from the decimal numbers of the file. Every link of the file is kept (none is merged).
// Strict about XML: a NUL byte, a second root element, an attribute given twice are no URDF here.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "algorithms/kit/scalars.h"
#include "algorithms/mechanism/model.h"
#include "reference/witness_matrices.h"

namespace delassus::reference {

struct UrdfWitness {
  using Triple = std::array<double, 3>;
  enum class Kind : std::uint8_t { fixed, revolute, prismatic, planar, floating };
  struct Link {
    std::string name;
    double mass = 0;                     ///< [kg]
    Triple com{}, rpy{};                 ///< of the inertial frame in the link's frame [m], [rad]
    std::array<double, 6> inertia{};     ///< ixx ixy ixz iyy iyz izz [kg m²]
    Index joint = -1;                    ///< that moves it; −1: the root
  };
  struct Joint {
    std::string name;
    Kind kind = Kind::fixed;
    Index parent = 0, child = 0;         ///< links
    Triple xyz{}, rpy{}, axis{1, 0, 0};
    double armature = 0;                 ///< [kg m² or kg]
    std::string master;                  ///< of a mimic; "" otherwise
    double multiplier = 1;
  };
  std::vector<Link> links;     ///< in the order of the file
  std::vector<Joint> joints;   ///< in the order of the file
  Index root = 0;
  std::vector<Index> order;    ///< links, parents before children
  /// What the reading passed over though somebody may have meant it: elements that URDF does not have where they stand,
  /// elements given twice of which the first was taken.
  std::vector<std::string> doubtful;

  [[nodiscard]] double total_mass() const;
  /// Moving joints.
  [[nodiscard]] Index moving() const;
  /// Links that end a chain, and are moved by some joint (any fixed base assumed).
  [[nodiscard]] std::vector<Index> leaves() const;
};

/// @throws std::runtime_error saying what is no URDF.
[[nodiscard]] UrdfWitness parse_urdf_witness(const std::string& text);
[[nodiscard]] UrdfWitness read_urdf_witness(const std::string& file);

/// The number of rotations counts joints from the tree's root on.
using UrdfMatrices = WitnessMatrices;

/// M at q alone, when `welded` is empty and the file has no mimics. `robot` is the name before the slash in the model's
/// names; a body whose joint is not in the file is the base, and moves its link as model.h says.
/// @throws std::runtime_error naming a joint that the file and the model do not share, or whose type differs.
[[nodiscard]] UrdfMatrices urdf_matrices(const UrdfWitness& witness, const Model& model, const std::string& robot,
                                         const VectorX<double>& q, const std::vector<Index>& welded);

/// Whether M is positive definite in general position (at the neutral and one other configuration), for a free or a
/// fixed base, without any model.
[[nodiscard]] bool urdf_regular(const UrdfWitness& witness, bool free_base);

}  // namespace delassus::reference
