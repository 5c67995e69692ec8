// Velocities of bodies and of constraint frames against the motion of their poses, by central differences in Quad:
// the columns S, and the rows J ν at configurations where no constraint is closed.
#include <gtest/gtest.h>

#include "algorithms/kit/test_scalars.h"
#include "property_tests/unit/operators/path_sums.h"

namespace delassus::moving_frames_test {
namespace {

using namespace unit;
using Kind = Constraint::Kind;
using Vec = Vector3<Quad>;

/// Half the step of the differences.
constexpr double h = 0x1p-34;

/// World pose of a frame, the distance of its origin from the world's origin included.
Pose<Quad> world_pose(const Poses<Quad>& at, const Frame& f) {
  const Pose<Quad> own{f.placement.rotation.cast<Quad>(), f.placement.translation.cast<Quad>()};
  if (f.body == ground) return own;
  return Pose<Quad>{at.rotation[f.body], at.position[f.body] + at.reference[at.tree[f.body]]} * own;
}

/// The pose of a frame, its angular velocity and that of its origin.
struct Moving {
  Pose<Quad> pose;
  Vec omega, velocity;
};

/// A mechanism at q, and at q ⊕ ±hν.
class Motion {
 public:
  Motion(const Model& m, const VectorX<Quad>& q, const VectorX<Quad>& v) {
    for (int side = -1; side <= 1; ++side) poses<Quad>(m, integrate<Quad>(m, q, VectorX<Quad>(v * Quad(side * h))), at_[side + 1]);
    double rate = 0, length = 1;
    for (Index k = 0; k < v.size(); ++k) rate += std::fabs(static_cast<double>(v[k]));
    for (const Body& b : m.bodies) length += b.joint.placement.translation.norm() + b.com.norm();
    for (Index k = 0; k < q.size(); ++k) length += std::fabs(static_cast<double>(q[k]));
    rate += 1;
    velocity_bound_ = rate * length;
    difference_bound_ = rate * rate * rate * length;
  }
  [[nodiscard]] Moving operator()(const Frame& f) const {
    const Pose<Quad> before = world_pose(at_[0], f), now = world_pose(at_[1], f), after = world_pose(at_[2], f);
    const Matrix3<Quad> spin = (after.rotation - before.rotation) / Quad(2 * h) * now.rotation.transpose();
    const Vec omega = Vec(spin(2, 1) - spin(1, 2), spin(0, 2) - spin(2, 0), spin(1, 0) - spin(0, 1)) / Quad(2);
    return {now, omega, (after.translation - before.translation) / Quad(2 * h)};
  }
  [[nodiscard]] const Poses<Quad>& now() const { return at_[1]; }
  /// Of a third derivative of a point that all joints move; the differences are off by h² times a sixth of one.
  [[nodiscard]] double difference_bound() const { return difference_bound_; }
  /// Of a velocity; rotations given in double are off by their rounding, and the velocities with them.
  [[nodiscard]] double velocity_bound() const { return velocity_bound_; }

 private:
  Poses<Quad> at_[3];
  double velocity_bound_ = 0, difference_bound_ = 0;
};

VectorX<Quad> velocities(Index n, Random& random) {
  VectorX<Quad> v(n);
  for (Index k = 0; k < n; ++k) v[k] = Quad(random.number());
  return v;
}

double largest(const MatrixX<Quad>& x) { return x.cast<double>().cwiseAbs().maxCoeff(); }

/// A seeded defect of the problem that kinematics makes; nullptr: none.
using Defect = void (*)(Problem<Quad>&);

Problem<Quad> spoilt(Problem<Quad> p, Defect defect) {
  if (defect) defect(p);
  return p;
}

/// J_i ν = (ω; velocity of the point of body i that is at the reference point of its tree): the largest ratio.
double bodies_ratio(const Model& m, const VectorX<Quad>& q, const VectorX<Quad>& v, Defect defect = nullptr) {
  const Motion motion(m, q, v);
  const Problem<Quad> p = spoilt(kinematics<Quad>(m, q), defect);
  double worst = 0;
  for (Index i = 0; i < static_cast<Index>(m.bodies.size()); ++i) {
    const Moving body = motion({i, {}});
    const Vec position = motion.now().position[i];
    Vector6<Quad> expected;
    expected << body.omega, body.velocity - body.omega.cross(position);
    const MatrixX<Quad> error = body_jacobian(p, i) * v - expected;
    worst = std::max(worst, ratio(largest(error), motion.difference_bound(), h * h));
  }
  return worst;
}

TEST(moving, bodies_as_their_columns_say) {
  for (unsigned seed = 20; seed < 23; ++seed) {
    Random random(seed);
    const Model m = two_robots(seed);
    const VectorX<Quad> q = random_configuration(m, random).cast<Quad>();
    EXPECT_LT(bodies_ratio(m, q, velocities(m.dofs(), random)), 30) << seed;
    for (Index k = 0; k < m.dofs(); ++k)  // one column at a time
      EXPECT_LT(bodies_ratio(m, q, VectorX<Quad>::Unit(m.dofs(), k)), 30) << "column " << k << ", seed " << seed;
  }
}

/// Relative velocity a minus b, as the kinds define their rows (algorithms/mechanism/model.h).
VectorX<Quad> relative_velocity(Kind kind, const Moving& a, const Moving& b) {
  const Matrix3<Quad>& R = a.pose.rotation;
  const Vec apart = b.pose.translation - a.pose.translation;
  const Vec turning = R.transpose() * (a.omega - b.omega), moving = R.transpose() * (a.velocity - b.velocity);
  const Vec at_b = moving + R.transpose() * a.omega.cross(apart);  // of the point of a that is at the origin of b
  VectorX<Quad> rows;
  switch (kind) {
    case Kind::point: rows = moving; break;
    case Kind::weld: rows.resize(6), rows << turning, moving; break;
    case Kind::hinge: rows.resize(5), rows << turning.head<2>(), moving; break;
    case Kind::universal:
      rows.resize(4), rows << R.col(2).cross(Vec(b.pose.rotation.col(0))).dot(Vec(a.omega - b.omega)), moving;
      break;
    case Kind::cylindrical: rows.resize(4), rows << turning.head<2>(), at_b.head<2>(); break;
    case Kind::prismatic: rows.resize(5), rows << turning, at_b.head<2>(); break;
    case Kind::planar: rows.resize(3), rows << turning.head<2>(), at_b[2]; break;
    case Kind::distance: rows.resize(1), rows << -apart.dot(Vec(a.velocity - b.velocity)) / sqrt(Quad(apart.dot(apart))); break;
    default: rows.resize(3), rows << moving[2], moving[0], moving[1]; break;  // contact
  }
  return rows;
}

double rows_ratio(Model m, Constraint c, const VectorX<Quad>& q, const VectorX<Quad>& v, Defect defect = nullptr) {
  m.constraints = {c};
  const Motion motion(m, q, v);
  const VectorX<Quad> expected = relative_velocity(c.kind, motion(c.a), motion(c.b));
  const VectorX<Quad> rows = constraint_jacobian(spoilt(kinematics<Quad>(m, q), defect)) * v;
  if (rows.size() != expected.size()) throw std::logic_error("another number of rows");
  // kinematics takes the nearest rotation to a placement given in double, this test the given numbers.
  const double eps = 0x1p-53, bound = motion.velocity_bound() + h * h / eps * motion.difference_bound();
  return ratio(largest(rows - expected), bound, eps);
}

TEST(moving, frames_as_the_rows_say_where_nothing_is_closed) {
  for (unsigned seed = 30; seed < 32; ++seed) {
    Random random(seed);
    const Model m = two_robots(seed);
    const VectorX<Quad> q = random_configuration(m, random).cast<Quad>(), v = velocities(m.dofs(), random);
    for (const Kind kind : {Kind::point, Kind::weld, Kind::hinge, Kind::universal, Kind::cylindrical, Kind::prismatic,
                            Kind::planar, Kind::distance, Kind::contact})
      for (Index i = 0; i < 16; ++i)
        for (const Index j : {ground, (i + 3) % 16}) {
          Constraint c;
          c.kind = kind;
          c.length = 1;
          c.a = {i, random.pose()};
          c.b = {j, random.pose()};
          EXPECT_LT(rows_ratio(m, c, q, v), 30) << name(kind) << " between " << i << " and " << j;
          std::swap(c.a, c.b);
          EXPECT_LT(rows_ratio(m, c, q, v), 30) << name(kind) << " between " << j << " and " << i;
        }
  }
}

TEST(moving, seeded_defects_are_noticed) {
  Random random(20);
  const Model m = two_robots(20);
  const VectorX<Quad> q = random_configuration(m, random).cast<Quad>(), v = velocities(m.dofs(), random);
  const Defect turned = [](Problem<Quad>& p) { p.S.back() = -p.S.back(); };
  const Defect beside = [](Problem<Quad>& p) { p.S.back()[3] += p.S.back()[1] * Quad(0x1p-20); };  // about a point 1 µm beside
  const Defect other_side = [](Problem<Quad>& p) { p.K.back() = -p.K.back(); };
  const Defect lever = [](Problem<Quad>& p) { p.K.front()[0] += Quad(0x1p-30); };  // 1 nm
  EXPECT_LT(bodies_ratio(m, q, v), 30);
  for (const Defect defect : {turned, beside}) EXPECT_GT(bodies_ratio(m, q, v, defect), 30);
  Constraint c;
  c.kind = Kind::hinge;
  c.a = {4, random.pose()};
  c.b = {15, random.pose()};
  EXPECT_LT(rows_ratio(m, c, q, v), 30);
  for (const Defect defect : {turned, other_side, lever}) EXPECT_GT(rows_ratio(m, c, q, v, defect), 30);
}

}  // namespace
}  // namespace delassus::moving_frames_test
