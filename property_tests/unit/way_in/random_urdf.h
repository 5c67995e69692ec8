// Robots as plain values for the tests of the readers: drawn at random, written as URDF text, and computed from the value
// itself. Nothing of models/ and no recursion of algorithms/ is used: poses link by link, then M = Σ Jᵀ H J, in Quad.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "algorithms/kit/spatial.h"
#include "algorithms/kit/test_scalars.h"

namespace delassus::test {

/// An <origin>: rotation by fixed-axis roll, pitch, yaw [rad], and a place [m].
struct Origin {
  Vector3<double> xyz{0, 0, 0}, rpy{0, 0, 0};
};

struct Inertial {
  Origin origin;
  double mass = 0, ixx = 0, ixy = 0, ixz = 0, iyy = 0, iyz = 0, izz = 0;
};

/// As in the file: box {x, y, z}, sphere {radius}, cylinder and capsule {radius, length}.
struct Collision {
  std::string kind;
  Vector3<double> size{0, 0, 0};
  Origin origin;
};

struct Link {
  std::string name;
  std::optional<Inertial> inertial;
  std::vector<Collision> collisions;
};

struct UrdfJoint {
  struct Limit {
    double lower, upper, effort, velocity;
  };
  struct Dynamics {
    double damping, friction, armature;
  };
  std::string name, type, parent, child;
  Origin origin;
  Vector3<double> axis{1, 0, 0};
  std::optional<Limit> limit;
  std::optional<Dynamics> dynamics;
  std::string master;  // of a mimic; empty: none
  double multiplier = 1, offset = 0;
};

/// links[0] is the root.
struct Urdf {
  std::vector<Link> links;
  std::vector<UrdfJoint> joints;
};

/// Every joint type, turned inertials off their links' origins, fixed joints with and without inertia, mimics of mimics,
/// every kind of primitive, joints in an order of their own.
[[nodiscard]] Urdf random_urdf(unsigned seed);

/// The file, numbers with 17 digits.
[[nodiscard]] std::string text(const Urdf& robot);

/// Values of the joints by name, as in `Model`: quaternions w x y z, floating joints position first. "base": of a free base.
using Values = std::map<std::string, std::vector<double>>;
[[nodiscard]] Values random_values(const Urdf& robot, unsigned seed);

/// Degrees of freedom of a joint type of URDF.
[[nodiscard]] Index dofs_of(const std::string& type);

/// What a robot comes to at a configuration. Columns: the base's, then those of the joints in the order of `robot.joints`.
struct Computed {
  std::map<std::string, Index> column;               ///< first column of each moving joint; "base" of a moving base
  std::map<std::string, Pose<Quad>> link;            ///< X of every link in the world
  std::map<std::string, Quad> way;                   ///< lengths of all translations on the way to it, times its joints
  std::map<std::string, MatrixX<Quad>> motion;       ///< 6×n: (ω; v of the origin) of every link in its own axes
  std::map<std::string, MatrixX<Quad>> motion_size;  ///< its bound: joints on the way × (1 for turns, their lengths for arms)
  MatrixX<Quad> M, M_size;                           ///< n×n, and the same sums of sizes
};
/// `base`: "fixed", "floating" (values["base"]: q) or "planar"; `pose`: of a fixed base, or of the frame a planar one moves in.
[[nodiscard]] Computed compute(const Urdf& robot, const Values& values, const std::string& base, const Origin& pose = {});

/// Rz(yaw) Ry(pitch) Rx(roll), from its nine entries.
[[nodiscard]] Pose<Quad> pose_of(const Origin& origin);
/// The origin of a pose; pitch away from ±90°.
[[nodiscard]] Origin origin_of(const Pose<Quad>& pose);
[[nodiscard]] Matrix3<Quad> matrix_of(const Inertial& inertial);
/// The inertial as seen from a frame at `pose` in which its link stands; turned is written into the six numbers when asked.
[[nodiscard]] Inertial moved(const Inertial& inertial, const Pose<Quad>& pose, bool into_numbers);

}  // namespace delassus::test
