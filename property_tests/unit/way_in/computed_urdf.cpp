// What a robot of random_urdf.h comes to, from the value itself.
#include "algorithms/kit/test_scalars.h"
#include "property_tests/unit/way_in/random_urdf.h"

#include <cmath>

#include "algorithms/kit/spatial.h"

namespace delassus::test {
namespace {

using V3 = Vector3<double>;
using Q3 = Vector3<Quad>;
using QM = Matrix3<Quad>;

QM cross(const Q3& v) { return cross_matrix<Quad>(v); }

QM turn(const Q3& unit, const Quad& angle) {
  const QM K = cross(unit);
  return QM::Identity() + sin(angle) * K + (Quad(1) - cos(angle)) * (K * K);
}

QM of_quaternion(Quad w, Q3 v) {
  const Quad length = sqrt(w * w + v.dot(v));
  w /= length, v /= length;
  const QM c = cross(v);
  return QM::Identity() + Quad(2) * (w * c + c * c);
}

Quad length(const V3& v) { return sqrt(Quad(v.cast<Quad>().dot(v.cast<Quad>()))); }

/// A joint at its values: the moved frame in the joint frame, and the columns (ω; v at the moved frame's origin) in the
/// joint frame's axes.
struct Moved {
  Pose<Quad> pose;
  MatrixX<Quad> columns;
  Quad travel = Quad(0);
};

Moved moved_frame(const std::string& type, const V3& axis, const std::vector<double>& q) {
  Moved m;
  m.pose = {QM::Identity(), Q3::Constant(Quad(0))};
  m.columns = MatrixX<Quad>::Constant(6, dofs_of(type), Quad(0));
  const Q3 a = axis.cast<Quad>() / length(axis);
  if (type == "revolute" || type == "continuous") {
    m.pose.rotation = turn(a, q[0]);
    m.columns.col(0).head(3) = a;
  } else if (type == "prismatic") {
    m.pose.translation = Quad(q[0]) * a;
    m.columns.col(0).tail(3) = a;
    m.travel = abs(Quad(q[0]));
  } else if (type == "planar") {
    Index least = 0;  // the coordinate axis farthest from `axis`
    for (Index k = 1; k < 3; ++k)
      if (abs(a[k]) < abs(a[least])) least = k;
    Q3 e = Q3::Constant(Quad(0));
    e[least] = Quad(1);
    Q3 first = e - a * a[least];
    first /= sqrt(first.dot(first));
    const Q3 second = a.cross(first);
    m.pose = {turn(a, q[0]), Quad(q[1]) * first + Quad(q[2]) * second};
    m.columns.col(0).head(3) = a, m.columns.col(1).tail(3) = first, m.columns.col(2).tail(3) = second;
    m.travel = abs(Quad(q[1])) + abs(Quad(q[2]));
  } else if (type == "floating") {
    m.pose = {of_quaternion(q[3], {Quad(q[4]), Quad(q[5]), Quad(q[6])}), {Quad(q[0]), Quad(q[1]), Quad(q[2])}};
    for (Index k = 0; k < 3; ++k) m.columns.col(k).head(3) = m.pose.rotation.col(k), m.columns.col(3 + k).tail(3) = m.pose.rotation.col(k);
    m.travel = abs(Quad(q[0])) + abs(Quad(q[1])) + abs(Quad(q[2]));
  }
  return m;
}

/// Motion of a link in world axes at its origin, its size, and the length of the way to it; joints: as many products of
/// rotations lie on the way.
struct Way {
  Pose<Quad> pose;
  MatrixX<Quad> motion, size;
  Quad length = Quad(0), joints = Quad(0);
};

/// The motion of a point p further on, in the same axes.
void carry(MatrixX<Quad>& motion, const Q3& p) { motion.bottomRows(3) -= cross(p) * motion.topRows(3); }
void carry_size(MatrixX<Quad>& size, const Quad& way) {
  for (Index j = 0; j < size.cols(); ++j)
    for (Index i = 0; i < 3; ++i) size(3 + i, j) += way * size(i, j);
}

void step(Way& w, const std::string& type, const V3& axis, const Origin& origin, const std::vector<double>& q, Index column) {
  const Pose<Quad> at = pose_of(origin);
  const Moved m = moved_frame(type, axis, q);
  const QM placed = w.pose.rotation * at.rotation;
  const Q3 arm = w.pose.rotation * at.translation + placed * m.pose.translation;
  const Quad way = length(origin.xyz) + m.travel;
  carry(w.motion, arm), carry_size(w.size, way);
  for (Index k = 0; k < m.columns.cols(); ++k) {
    w.motion.col(column + k).head(3) += placed * m.columns.col(k).head(3);
    w.motion.col(column + k).tail(3) += placed * m.columns.col(k).tail(3);
    const bool turns = m.columns.col(k).head(3).cwiseAbs().maxCoeff() > Quad(0);
    w.size.col(column + k).head(3).setConstant(Quad(turns ? 1 : 0)), w.size.col(column + k).tail(3).setConstant(Quad(turns ? 0 : 1));
  }
  w.length += way, w.joints += Quad(1);
  w.pose = {placed * m.pose.rotation, w.pose.translation + arm};
}

void add_inertia(const Way& w, const Inertial& in, Computed& out) {
  const Pose<Quad> at = w.pose * pose_of(in.origin);
  MatrixX<Quad> J = w.motion, size = w.size;
  carry(J, at.translation - w.pose.translation), carry_size(size, length(in.origin.xyz));
  // A computation about another point takes mass × (whole way)² through its sums.
  const Quad m(in.mass), norm = matrix_of(in).cwiseAbs().sum(), reach = w.length + length(in.origin.xyz);
  const QM I = at.rotation * matrix_of(in) * at.rotation.transpose();
  out.M += J.topRows(3).transpose() * (I * J.topRows(3)) + m * J.bottomRows(3).transpose() * J.bottomRows(3);
  const MatrixX<Quad> turns = size.topRows(3), arms = size.bottomRows(3) + reach * turns;
  out.M_size += w.joints * (turns.transpose() * QM::Constant(norm) * turns + m * arms.transpose() * QM::Constant(Quad(1)) * arms);
}

}  // namespace

Pose<Quad> pose_of(const Origin& o) {
  const Quad r(o.rpy[0]), p(o.rpy[1]), y(o.rpy[2]);
  const Quad cr = cos(r), sr = sin(r), cp = cos(p), sp = sin(p), cy = cos(y), sy = sin(y);
  QM R;
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, -sp, cp * sr, cp * cr;
  return {R, o.xyz.cast<Quad>()};
}

Origin origin_of(const Pose<Quad>& pose) {
  auto R = [&](int i, int j) { return static_cast<double>(pose.rotation(i, j)); };
  Origin o;
  o.xyz = pose.translation.unaryExpr([](const Quad& x) { return static_cast<double>(x); });
  o.rpy = {std::atan2(R(2, 1), R(2, 2)), std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))), std::atan2(R(1, 0), R(0, 0))};
  return o;
}

Matrix3<Quad> matrix_of(const Inertial& in) {
  QM I;
  I << Quad(in.ixx), Quad(in.ixy), Quad(in.ixz), Quad(in.ixy), Quad(in.iyy), Quad(in.iyz), Quad(in.ixz), Quad(in.iyz), Quad(in.izz);
  return I;
}

Inertial moved(const Inertial& inertial, const Pose<Quad>& pose, bool into_numbers) {
  const Pose<Quad> at = pose * pose_of(inertial.origin);
  Inertial out = inertial;
  out.origin = origin_of(at);
  if (!into_numbers) return out;
  const QM I = at.rotation * matrix_of(inertial) * at.rotation.transpose();
  auto d = [&](int i, int j) { return static_cast<double>(I(i, j)); };
  out.origin.rpy.setZero();
  out.ixx = d(0, 0), out.ixy = d(0, 1), out.ixz = d(0, 2), out.iyy = d(1, 1), out.iyz = d(1, 2), out.izz = d(2, 2);
  return out;
}

Computed compute(const Urdf& robot, const Values& values, const std::string& base, const Origin& pose) {
  Computed out;
  Index n = dofs_of(base);
  out.column["base"] = 0;
  for (const UrdfJoint& j : robot.joints) out.column[j.name] = n, n += dofs_of(j.type);
  out.M = out.M_size = MatrixX<Quad>::Constant(n, n, Quad(0));
  std::map<std::string, Way> ways;
  Way root{{QM::Identity(), Q3::Constant(Quad(0))}, MatrixX<Quad>::Constant(6, n, Quad(0)), MatrixX<Quad>::Constant(6, n, Quad(0)), Quad(0), Quad(0)};
  const std::vector<double> own = base == "fixed" ? std::vector<double>{} : values.at("base");
  step(root, base, {0, 0, 1}, base == "floating" ? Origin{} : pose, own, 0);
  ways[robot.links[0].name] = root;
  std::vector<std::string> open{robot.links[0].name};
  while (!open.empty()) {
    const std::string parent = open.back();
    open.pop_back();
    for (const UrdfJoint& j : robot.joints) {
      if (j.parent != parent) continue;
      Way w = ways.at(parent);
      const auto q = values.find(j.name);
      step(w, j.type, j.axis, j.origin, q == values.end() ? std::vector<double>{} : q->second, out.column.at(j.name));
      ways[j.child] = w;
      open.push_back(j.child);
      for (Index i = 0; i < dofs_of(j.type) && j.dynamics; ++i) {
        const Index c = out.column.at(j.name) + i;
        out.M(c, c) += Quad(j.dynamics->armature), out.M_size(c, c) += Quad(j.dynamics->armature);
      }
    }
  }
  for (const Link& link : robot.links) {
    Way& w = ways.at(link.name);
    if (link.inertial) add_inertia(w, *link.inertial, out);
    const QM Rt = w.pose.rotation.transpose();
    MatrixX<Quad> own_axes(6, n), size = w.size;
    own_axes << Rt * w.motion.topRows(3), Rt * w.motion.bottomRows(3);
    for (Index j = 0; j < n; ++j)  // axes may be turned any way, arms start at the world's origin
      for (const Index half : {0, 3}) size.col(j).segment(half, 3).setConstant(size.col(j).segment(half, 3).maxCoeff() + (half == 3 ? w.length * size(0, j) : Quad(0)));
    out.link[link.name] = w.pose, out.way[link.name] = w.joints * w.length, out.motion[link.name] = own_axes, out.motion_size[link.name] = w.joints * size;
  }
  return out;
}

}  // namespace delassus::test
