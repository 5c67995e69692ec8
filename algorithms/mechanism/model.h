// A described mechanism: robots, boxes and constraints before a configuration is chosen. A plain value, in double.
// kinematics.h turns it into a Problem at a configuration q. Units SI, radians.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "algorithms/problem/problem.h"

namespace delassus {

/// Joint types. q and ν of each, in order (angular before linear in ν, quaternions w x y z):
///   revolute, prismatic   q 1, ν 1    about / along `axis`
///   universal             q 2, ν 2    about `axis` of the parent side, then about `axis2` carried along
///   planar                q 3, ν 3    ν = (rotation about `axis`, translations along two in-plane axes t1, t2 fixed on
///                                     the parent side); q the same order. t1 is the projection of the coordinate axis
///                                     farthest from `axis` (the first of equals), t2 = axis × t1: x, y for the z axis
///   spherical             q 4, ν 3    quaternion; ν = ω in body axes
///   floating              q 7, ν 6    position (3), quaternion (4); ν = (ω, v of the frame's origin), body axes
///   cylindrical           q 2, ν 2    about, then along `axis`
enum class JointType : std::uint8_t { revolute, prismatic, universal, planar, spherical, floating, cylindrical };

struct Joint {
  std::string name;
  JointType type = JointType::revolute;
  Vector3<double> axis{0, 0, 1};   ///< unit, in the joint frame
  Vector3<double> axis2{0, 1, 0};  ///< unit, universal only
  Pose<double> placement;          ///< X of the joint frame in the parent body's frame (in the world for roots)
  /// Per degree of freedom (size n_i, or empty = zeros / unlimited).
  std::vector<double> armature, damping, friction, lower, upper, effort, velocity;
};

/// Collision primitive, in the body frame. size: sphere {r}; cylinder and capsule {r, half length along z}; box half
/// extents; hull half extents of the box around its points.
struct Shape {
  enum class Kind : std::uint8_t { sphere, cylinder, capsule, box, hull } kind = Kind::sphere;
  Vector3<double> size{0, 0, 0};
  Pose<double> placement;
  double friction = -1;  ///< Coulomb coefficient; negative: not given
  std::shared_ptr<const std::vector<Vector3<double>>> points;  ///< hull only: vertices of a convex polyhedron, shape frame [m]
};

struct Body {
  std::string name;        ///< full name, `robot/link`
  Index parent = ground;
  Joint joint;             ///< moves this body in its parent
  double mass = 0;                                         ///< [kg]
  Vector3<double> com{0, 0, 0};                            ///< in the body frame [m]
  Matrix3<double> inertia = Matrix3<double>::Zero();       ///< about com, body axes [kg m²]
  std::vector<Shape> shapes;
};

/// One end of a constraint: a frame fixed on a body, or in the world (body == ground).
struct Frame {
  Index body = ground;
  Pose<double> placement;  ///< X of the constraint frame in the body's frame (in the world for ground)
};

/// A constraint of the scene. Rows are in the axes of frame `a` (x y z of its placement), angular rows first:
///   point 3         linear xyz                        weld 6          angular xyz, linear xyz
///   hinge 5         angular xy, linear xyz (z free)   universal 4     angular about a.z × b.x, linear xyz
///   cylindrical 4   angular xy, linear xy             prismatic 5     angular xyz, linear xy (z free)
///   planar 3        angular xy, linear z (normal)     distance 1      along the line between the two origins
///   contact 3       linear along normal z, then tangents x, y of frame a (the first row is the normal)
///   joint_friction, joint_lock   one row per degree of freedom of the joint of body a.body
///   joint_limit 1   side · ν_dof of the joint of body a.body, one-sided: the row's rate is ≥ 0 where the limit is reached
///   coupling 1      Σ_k coefficient_k ν_k over single degrees of freedom (gear, mimic), as link rows: ν_k is the
///                   dual row of S_k applied to the acceleration of the body less that of its parent
///   general m       Σ_k K_k a_k, user blocks in body axes about each body's frame origin
struct Constraint {
  enum class Kind : std::uint8_t {
    point, weld, hinge, universal, cylindrical, prismatic, planar, distance, contact,
    joint_friction, joint_lock, joint_limit, coupling, general
  };
  struct Term {              ///< of coupling: degree of freedom `dof` of body's joint; of general: `K` (m×6) on body
    Index body = ground;
    Index dof = 0;
    double coefficient = 1;
    MatrixX<double> K;
  };
  std::string name;
  Kind kind = Kind::point;
  Frame a, b;
  double length = 0;             ///< distance [m]
  double friction = -1;          ///< contact: Coulomb coefficient; joint_friction: largest effort [N m or N]
  Index dof = 0;                 ///< joint_limit: degree of freedom of the joint
  int side = 1;                  ///< joint_limit: 1 the lower limit, −1 the upper one
  bool loop = false;             ///< a position-level closure that assembly must bring to zero
  double tolerance = -1;         ///< of the closure [m or rad]; negative: the default of loop_closing.h
  std::vector<Term> terms;
};

struct Model {
  std::vector<Body> bodies;            ///< parents before children
  std::vector<Constraint> constraints;
  std::vector<Index> first_q{0}, first_dof{0};  ///< N+1 each

  [[nodiscard]] Index q_size() const { return first_q.back(); }
  [[nodiscard]] Index dofs() const { return first_dof.back(); }
  /// Index of the body with this full name. @throws ModelError naming the candidates.
  [[nodiscard]] Index find(const std::string& name) const;
  /// Appends a body and returns its index. @throws ModelError as validate_body, and on a parent that is no earlier body.
  Index add(Body body);
};

[[nodiscard]] Index q_size(JointType t);
[[nodiscard]] Index dof_count(JointType t);
[[nodiscard]] std::string_view name(JointType t);
[[nodiscard]] std::string_view name(Constraint::Kind k);
/// joint_friction, joint_lock and joint_limit act on a joint (rows 𝒦), all other kinds on bodies (rows K).
[[nodiscard]] bool acts_on_joint(Constraint::Kind kind);
/// Number of rows of a constraint in this model. @throws ModelError when it is on a joint that does not exist.
[[nodiscard]] Index row_count(const Model& model, const Constraint& c);

/// Checks finite numbers, mass ≥ 0, a symmetric inertia, unit axes, proper rotations, shapes, joint data of one entry per
/// degree of freedom; unit lengths, orthogonality and symmetry hold up to 30 ε · 3 of the largest entry. Any inertia passes
/// here, zero, semidefinite or indefinite: `validate` decides what M makes of it, readers of files whether a solid body can
/// have it (triangle inequality). @throws ModelError naming file, body, value, unit and what is accepted.
void validate_body(const Body& body, const std::string& file);
/// Checks the whole model: bodies, distinct names, constraints, and that M is regular in general position although some
/// bodies are massless, point masses or rods, by pivots in Quad at the neutral or one other fixed configuration; positive
/// definite at four of them where an inertia is indefinite. @throws ModelError naming the body, its joint and the pivot.
void validate(const Model& model, const std::string& file);

/// The neutral configuration: zeros, unit quaternions.
[[nodiscard]] VectorX<double> neutral(const Model& model);

}  // namespace delassus
