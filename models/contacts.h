// Contact points found from the collision primitives of a model at a configuration.
//
// Found are points whose gap is at most `margin` (penetration included), at most 4 per pair of surfaces, none twice:
//   ground   sphere: lowest point · box: vertices · capsule: lowest point of each end · cylinder: up to 4 rim points
//            hull (of a mesh): vertices, of more than 4 those that reach farthest on the plane
//   pairs    sphere, capsule and box with each other: box–box by clipping the two nearest faces (1 point for crossed
//            edges), capsule–box at ends, edges and the deepest place, capsule–capsule at the closest points; cylinders and
//            hulls with these and each other: convex_contacts.h
// What stands in the world meets what moves as another body would, and nothing else.
// Hulls of which qhull finds no surface meet the ground alone: notes count their pairs.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "algorithms/mechanism/kinematics.h"

namespace delassus {

/// A shape that stands in the world: of a link that is fixed to it, or of a fixed box.
struct Standing {
  std::string name;  ///< `robot/link`, or the box
  Shape shape;       ///< placed in the world
  Index object = 0;  ///< as ContactSearch::object of a body; below 0: no body's
};

struct ContactPoint {
  Index body = ground, other = ground;  ///< other: ground for the plane and for what stands
  Vector3<double> point{0, 0, 0};       ///< on the plane, or midway between two shapes; from the reference point of `body`'s tree
  Vector3<double> normal{0, 0, 1};      ///< unit, world axes, from `other` to `body`
  double gap = 0;                       ///< [m], negative: penetration
  double friction = -1;                 ///< the smaller coefficient of the two shapes; negative: not given
  Index standing = -1;                  ///< what stands, of ContactSearch::standing; −1: a body, or the plane
  Index feature = 0;                    ///< which of all that `body` and `other` have in common; no two have the same
};

struct HullSurfaces;
/// Faces and edges of all hulls of the model and of what stands.
[[nodiscard]] std::shared_ptr<const HullSurfaces> hull_surfaces(const Model& model, const std::vector<Standing>& standing = {});

struct ContactSearch {
  double margin = 1e-3;         ///< [m]
  bool ground = false;
  double ground_height = 0;     ///< [m]
  std::vector<Index> object;    ///< per body: robot or box it belongs to; bodies of one object do not collide
  std::vector<Standing> standing;              ///< in the world
  std::vector<std::pair<Index, Index>> apart;  ///< bodies, and objects below 0 of what stands, that do not collide either: the smaller first, ascending
  std::vector<double> ahead;    ///< per body [m]: as much is added to the margin, of a pair the larger; empty: nothing
  std::shared_ptr<const HullSurfaces> hulls;  ///< those of the model, found once; null: found at each search
  const std::vector<std::uint8_t>* resting = nullptr;  ///< per body: what rests is not looked for but against what does not; null: all
};

/// Points in the order (first body, second body, shapes, position on the face). `notes` gets a sentence for each
/// kind of pair that was skipped. Cost O(N log N + pairs): near_pairs.h.
[[nodiscard]] std::vector<ContactPoint> find_contacts(const Model& model, const Poses<double>& poses,
                                                      const ContactSearch& search, std::vector<std::string>& notes);

/// Pairs of bodies of one object that share a joint or a constraint, directly or through bodies without shapes: what `apart` is made of
/// where every body is an object of its own. What stands is one body, −1 − its object; who floats on it is no neighbour.
[[nodiscard]] std::vector<std::pair<Index, Index>> neighbours(const Model& model, const std::vector<Index>& object, const std::vector<Standing>& standing = {});

/// Whether a body hangs on a root that floats.
[[nodiscard]] bool floats(const Model& model, Index body);

/// Two axes that complete z to a right-handed orthonormal frame [x y z]; z = (0, 0, 1) gives the identity.
[[nodiscard]] Matrix3<double> frame_about(const Vector3<double>& z);

/// X of a body's frame in the world (identity for the ground).
[[nodiscard]] Pose<double> world_pose(const Poses<double>& poses, Index body);

/// X of `body`'s frame in `in`'s frame, world positions cancelled before they round.
[[nodiscard]] Pose<double> relative_pose(const Poses<double>& poses, Index in, Index body);

}  // namespace delassus
