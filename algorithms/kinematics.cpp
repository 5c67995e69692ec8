#include "algorithms/kinematics.h"

#include <cmath>

#include "algorithms/constraints.h"
#include "algorithms/scalars.h"

namespace delassus {
namespace {

/// Rotation about a unit axis: cos 1 + (1 − cos) a aᵀ + sin â.
template <class T> Matrix3<T> axis_rotation(const Vector3<T>& a, const T& angle) {
  using std::cos;
  using std::sin;
  const T c = cos(angle), s = sin(angle);
  return c * Matrix3<T>::Identity() + (T(1) - c) * (a * a.transpose()) + s * cross_matrix(a);
}

/// Rotation of a quaternion w x y z of any length but zero.
template <class T> Matrix3<T> quaternion_rotation(const T& w, const Vector3<T>& v) {
  const T scale = T(2) / (w * w + v.dot(v));
  const Matrix3<T> c = cross_matrix(v);
  return Matrix3<T>::Identity() + scale * (w * c + c * c);
}

/// c_k(x) = Σ_j (−x)^j / (2j + k)!, k = 1, 2, 3: sin θ/θ, (1 − cos θ)/θ², (θ − sin θ)/θ³ at x = θ². The series is
/// summed until a term no longer changes the sum where it is short; elsewhere the closed form has no cancellation.
template <class T> T series_or_closed(int k, const T& x) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  if (x < T(1)) {
    T sum(0), term(k == 3 ? T(1) / T(6) : k == 2 ? T(1) / T(2) : T(1));
    for (int j = 1;; ++j) {
      const T next = sum + term;
      if (!(next < sum) && !(next > sum)) return next;
      sum = next;
      term = term * (-x) / T((2 * j + k) * (2 * j + k - 1));
    }
  }
  const T theta = sqrt(x);
  if (k == 1) return sin(theta) / theta;
  return k == 2 ? (T(1) - cos(theta)) / x : (theta - sin(theta)) / (x * theta);
}

/// Two unit vectors that complete the axis to a right-handed frame; x y for the z axis.
template <class T> void in_plane_axes(const Vector3<T>& axis, Vector3<T>& first, Vector3<T>& second) {
  using std::abs;
  using std::sqrt;
  Index k = 0;
  for (Index i = 1; i < 3; ++i)
    if (T(abs(axis[i])) < T(abs(axis[k]))) k = i;
  first = -axis[k] * axis;
  first[k] += T(1);
  first /= T(sqrt(T(first.dot(first))));
  second = axis.cross(first);
}

/// Pose of the moved frame in the joint frame at q (the joint's own entries).
template <class T> Pose<T> joint_pose(const Joint& joint, const T* q) {
  Pose<T> x;
  switch (joint.type) {
    case JointType::revolute: x.rotation = axis_rotation(unit_as<T>(joint.axis), q[0]); break;
    case JointType::prismatic: x.translation = q[0] * unit_as<T>(joint.axis); break;
    case JointType::universal:
      x.rotation = axis_rotation(unit_as<T>(joint.axis), q[0]) * axis_rotation(unit_as<T>(joint.axis2), q[1]);
      break;
    case JointType::planar: {
      const Vector3<T> axis = unit_as<T>(joint.axis);
      Vector3<T> first, second;
      in_plane_axes(axis, first, second);
      x.rotation = axis_rotation(axis, q[0]);
      x.translation = q[1] * first + q[2] * second;
      break;
    }
    case JointType::spherical: x.rotation = quaternion_rotation<T>(q[0], {q[1], q[2], q[3]}); break;
    case JointType::floating:
      x.translation = Vector3<T>(q[0], q[1], q[2]);
      x.rotation = quaternion_rotation<T>(q[3], {q[4], q[5], q[6]});
      break;
    case JointType::cylindrical:
      x.rotation = axis_rotation(unit_as<T>(joint.axis), q[0]);
      x.translation = q[1] * unit_as<T>(joint.axis);
      break;
  }
  return x;
}

/// Columns of S about the reference point: R and p are the moved frame's axes in the world and its origin. Every
/// joint axis passes through that origin; axes fixed on the parent side are carried back from the moved frame.
template <class T> void motion_columns(const Joint& joint, const T* q, const Matrix3<T>& R, const Vector3<T>& p, Vector6<T>* S) {
  switch (joint.type) {
    case JointType::revolute: S[0] = rotation_axis<T>(R * unit_as<T>(joint.axis), p); break;
    case JointType::prismatic: S[0] = translation_axis<T>(R * unit_as<T>(joint.axis)); break;
    case JointType::universal: {
      const Vector3<T> axis2 = unit_as<T>(joint.axis2);
      S[0] = rotation_axis<T>(R * (axis_rotation(axis2, T(-q[1])) * unit_as<T>(joint.axis)), p);
      S[1] = rotation_axis<T>(R * axis2, p);
      break;
    }
    case JointType::planar: {
      const Vector3<T> axis = unit_as<T>(joint.axis);
      Vector3<T> first, second;
      in_plane_axes(axis, first, second);
      const Matrix3<T> parent_side = R * axis_rotation(axis, T(-q[0]));
      S[0] = rotation_axis<T>(R * axis, p);
      S[1] = translation_axis<T>(parent_side * first);
      S[2] = translation_axis<T>(parent_side * second);
      break;
    }
    case JointType::spherical:
      for (Index k = 0; k < 3; ++k) S[k] = rotation_axis<T>(R.col(k), p);
      break;
    case JointType::floating:
      for (Index k = 0; k < 3; ++k) {
        S[k] = rotation_axis<T>(R.col(k), p);
        S[3 + k] = translation_axis<T>(R.col(k));
      }
      break;
    case JointType::cylindrical:
      S[0] = rotation_axis<T>(R * unit_as<T>(joint.axis), p);
      S[1] = translation_axis<T>(R * unit_as<T>(joint.axis));
      break;
  }
}

/// Inertia of a body about its tree's reference point. Its upper triangle is copied, so that H is symmetric to the bit.
template <class T> Matrix6<T> inertia_of(const Body& body, bool root, const Matrix3<T>& R, const Vector3<T>& p) {
  if (body.mass == 0 && (body.inertia.array() == 0).all()) return Matrix6<T>::Constant(T(0));
  // The reference point is the centre of mass of the root body: exactly zero from itself.
  Vector3<T> c = Vector3<T>::Constant(T(0));
  if (!root) c = p + R * body.com.template cast<T>();
  const Matrix3<T> I = body.inertia.template cast<T>();
  Matrix6<T> H = spatial_inertia<T>(T(body.mass), c, R * I * R.transpose());
  for (Index j = 0; j < 3; ++j)
    for (Index i = j + 1; i < 3; ++i) H(i, j) = H(j, i);
  return H;
}

void check_q(const Model& model, Index size) {
  require(size == model.q_size(), "q does not have Model::q_size() entries");
}

/// The structure must be the model's: same bodies, joints and rows.
void check_structure(const Model& model, const Structure& s) {
  const bool fits = s.bodies() == static_cast<Index>(model.bodies.size()) && s.first_dof == model.first_dof &&
                    s.link_constraints.size() + s.joint_constraints.size() == model.constraints.size();
  require(fits, "kinematics: the problem's structure is not structure_of(model)");
}

/// 𝒦 = 1, of a limit side · e_dofᵀ.
template <class T>
void joint_rows(const Structure& s, const Constraint& c, const Structure::JointConstraint& to, std::vector<T>& joint_K) {
  const bool limit = c.kind == Constraint::Kind::joint_limit;
  const Index n = s.dofs(to.body);
  for (Index i = 0; i < to.rows; ++i)
    for (Index j = 0; j < n; ++j) joint_K[to.first + i * n + j] = T(limit ? (j == c.dof ? c.side : 0) : i == j ? 1 : 0);
}

/// (w, v) ← (w, v) exp(ω): the quaternion turned by ω in body axes.
template <class T> void turn(T* quaternion, const Vector3<T>& omega) {
  using std::cos;
  using std::sqrt;
  const T x = omega.dot(omega) / T(4);  // half angle, squared
  const T c = cos(T(sqrt(x)));
  const Vector3<T> s = series_or_closed(1, x) / T(2) * omega;
  const T w = quaternion[0];
  const Vector3<T> v(quaternion[1], quaternion[2], quaternion[3]);
  const Vector3<T> turned = w * s + c * v + v.cross(s);
  quaternion[0] = w * c - v.dot(s);
  for (Index k = 0; k < 3; ++k) quaternion[1 + k] = turned[k];
}

/// Displacement of the origin, in the axes at the start, of a frame that moves for unit time with the constant body
/// velocity (ω, v): (1 + c₂ ω̂ + c₃ ω̂²) v.
template <class T> Vector3<T> displacement(const Vector3<T>& omega, const Vector3<T>& v) {
  const T x = omega.dot(omega);
  const Vector3<T> wv = omega.cross(v);
  return v + series_or_closed(2, x) * wv + series_or_closed(3, x) * omega.cross(wv);
}

}  // namespace

std::shared_ptr<const Structure> structure_of(const Model& model) {
  auto s = std::make_shared<Structure>();
  s->parent.reserve(model.bodies.size());
  s->first_dof.reserve(model.bodies.size() + 1);
  for (const Body& body : model.bodies) s->add_body(body.parent, dof_count(body.joint.type));
  for (const Constraint& c : model.constraints) {
    validate_constraint(model, c, "");
    if (acts_on_joint(c.kind)) s->add_joint_constraint(row_count(model, c), c.a.body);
    else s->add_link_constraint(row_count(model, c), attached_bodies(model, c));
  }
  return s;
}

template <class T> void poses(const Model& model, const VectorX<T>& q, Poses<T>& out) {
  check_q(model, q.size());
  const std::size_t n = model.bodies.size();
  out.rotation.resize(n);
  out.position.resize(n);
  out.tree.resize(n);
  out.reference.resize(n, Vector3<T>::Constant(T(0)));
  for (std::size_t i = 0; i < n; ++i) {
    const Body& body = model.bodies[i];
    const Pose<T> joint = joint_pose(body.joint, q.data() + model.first_q[i]);
    const Matrix3<T> placed = rotation_as<T>(body.joint.placement.rotation);
    const Vector3<T> from_parent = body.joint.placement.translation.template cast<T>() + placed * joint.translation;
    if (body.parent == ground) {
      out.rotation[i] = placed * joint.rotation;
      // Reference point: centre of mass, or the frame's origin when massless.
      const Vector3<T> com = body.mass == 0 ? Vector3<double>(0, 0, 0).cast<T>().eval() : body.com.template cast<T>().eval();
      out.position[i] = -(out.rotation[i] * com);
      out.reference[i] = from_parent - out.position[i];
      out.tree[i] = static_cast<Index>(i);
    } else {
      const Index parent = body.parent;
      out.rotation[i] = out.rotation[parent] * (placed * joint.rotation);
      out.position[i] = out.position[parent] + out.rotation[parent] * from_parent;
      out.tree[i] = out.tree[parent];
    }
  }
}

template <class T> void kinematics(const Model& model, const VectorX<T>& q, Poses<T>& at, Problem<T>& out) {
  out.check_sizes();
  const Structure& s = *out.structure;
  check_structure(model, s);
  poses(model, q, at);
  for (Index i = 0; i < s.bodies(); ++i) {
    const Body& body = model.bodies[i];
    motion_columns(body.joint, q.data() + model.first_q[i], at.rotation[i], at.position[i], out.S.data() + s.first_dof[i]);
    for (Index k = 0; k < s.dofs(i); ++k)
      out.armature[s.first_dof[i] + k] = body.joint.armature.empty() ? T(0) : T(body.joint.armature[k]);
    out.H[i] = inertia_of(body, body.parent == ground, at.rotation[i], at.position[i]);
  }
  std::size_t link = 0, joint = 0;
  for (const Constraint& c : model.constraints) {
    if (acts_on_joint(c.kind)) joint_rows(s, c, s.joint_constraints[joint++], out.joint_K);
    else fill_link_rows(model, c, at, out.S, s.link_constraints[link++], out.K);
  }
}

template <class T> Problem<T> kinematics(const Model& model, const VectorX<T>& q) {
  Problem<T> out(structure_of(model));
  Poses<T> at;
  kinematics(model, q, at, out);
  return out;
}

template <class T> VectorX<T> integrate(const Model& model, const VectorX<T>& q, const VectorX<T>& v) {
  check_q(model, q.size());
  require(v.size() == model.dofs(), "integrate: v does not have Model::dofs() entries");
  VectorX<T> out = q;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    T* to = out.data() + model.first_q[i];
    const T* rate = v.data() + model.first_dof[i];
    const JointType type = model.bodies[i].joint.type;
    if (type == JointType::spherical) turn(to, Vector3<T>(rate[0], rate[1], rate[2]));
    else if (type == JointType::floating) {
      const Vector3<T> omega(rate[0], rate[1], rate[2]), velocity(rate[3], rate[4], rate[5]);
      const Vector3<T> move = quaternion_rotation<T>(to[3], {to[4], to[5], to[6]}) * displacement(omega, velocity);
      for (Index k = 0; k < 3; ++k) to[k] += move[k];
      turn(to + 3, omega);
    } else
      for (Index k = 0; k < q_size(type); ++k) to[k] += rate[k];
  }
  return out;
}

#define DELASSUS_INSTANTIATE(T)                                                              \
  template void poses<T>(const Model&, const VectorX<T>&, Poses<T>&);                        \
  template void kinematics<T>(const Model&, const VectorX<T>&, Poses<T>&, Problem<T>&);      \
  template Problem<T> kinematics<T>(const Model&, const VectorX<T>&);                        \
  template VectorX<T> integrate<T>(const Model&, const VectorX<T>&, const VectorX<T>&);
DELASSUS_INSTANTIATE(double)
DELASSUS_INSTANTIATE(float)
DELASSUS_INSTANTIATE(Quad)
DELASSUS_INSTANTIATE(Counted)
#undef DELASSUS_INSTANTIATE

}  // namespace delassus
