// A witness of what an SDF file says: a second reading, and M and J by textbook formulas. Shares no line with models/ and
// no library but tinyxml2; the model of algorithms/mechanism/model.h only tells the order of ν and what q means.
//
//   X_i(0)   world poses of links and joints from <pose>, its relative_to, frames, nested models: one recursion over names
//   D_i(q)   = Π_k X_k m_k(q) X_k⁻¹ over the joints on the path: displacement of link i from the file's pose, in the world
//   X_i(q)   = D_i(q) X_i(0), and the columns of J_i from the axes at D_i X_k
//   J        rows of the model's own constraints (loops, screws, gearboxes) in its order, then six per welded link
//
// Tree     A link hangs on the first joint of the file that has it as child; a joint that would close a circle, or has a
//          static link as child, is a loop. A link without a joint, on a fixed joint to the world or of a static model is a root.
// Served   one model, or the models of worlds, without <include>; poses and axes in every notation up to version 1.9.
//          What is beyond is refused by name.
#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "algorithms/kit/test_scalars.h"
#include "reference/witness_matrices.h"

namespace delassus::reference {

/// The file may be right; this reading does not go that far.
struct NotServed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct SdfWitness {
  /// A pose in the world, and what its error grows with: ℓ, the lengths of all translations it was made of, and s, how many poses.
  struct Posed {
    witness::Transform X;
    Quad reach = Quad(0), steps = Quad(1);
  };
  enum class Kind : std::uint8_t { fixed, revolute, prismatic, ball, universal, screw, gearbox };
  struct Link {
    std::string name;        ///< `link`, in nested models `model::link`; of several models too
    Posed at;
    bool stands = false;     ///< of a static model
    witness::Solid solid;
    Index joint = -1;        ///< that moves it, by number; −1: a root
  };
  struct Joint {
    std::string name;
    Kind kind = Kind::fixed;
    Index parent = -1, child = -1;        ///< links; −1: the world
    Posed at;
    std::vector<witness::Real3> axes;     ///< unit, world axes at the file's pose
    double pitch = 1, ratio = 1;          ///< thread_pitch [rad/m], gearbox_ratio
    Index reference = -1;                 ///< gearbox: link that both angles are measured from
    bool in_tree = false;
  };
  std::vector<Link> links;     ///< in the order of the file
  std::vector<Joint> joints;   ///< in the order of the file
  std::vector<Index> order;    ///< links, parents before children
  /// Elements given twice of which the first was taken.
  std::vector<std::string> doubtful;

  /// A link that the file does not let move.
  [[nodiscard]] bool root_stands(Index link) const;
  [[nodiscard]] Index moving() const;                 ///< moving joints of the tree
  [[nodiscard]] std::vector<Index> leaves() const;    ///< links that end a chain and are moved by a joint
};

/// @throws std::runtime_error saying what is no SDF; NotServed.
[[nodiscard]] SdfWitness parse_sdf_witness(const std::string& text);
[[nodiscard]] SdfWitness read_sdf_witness(const std::string& file);

/// What a model of the file must say at q. `robot` is the name before the slash in the model's names; the last constraints
/// of the model are welds of the links `welded` to the world. `base_given`: the base of the first root is the model's
/// choice; otherwise it is the file's. Axes beside the one of a loop's joint are taken from the constraint.
/// @throws std::runtime_error naming a joint or loop that the file and the model do not share, or whose type differs.
[[nodiscard]] WitnessMatrices sdf_matrices(const SdfWitness& witness, const Model& model, const std::string& robot, const VectorX<double>& q,
                                           const std::vector<Index>& welded, double armature, bool base_given);

}  // namespace delassus::reference
