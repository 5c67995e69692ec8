#include "algorithms/kit/counted.h"
#include "algorithms/kit/quad.h"
#include "algorithms/mechanism/constraints.h"
#include "algorithms/mechanism/mechanism.h"

#include <algorithm>
#include <cmath>

namespace delassus {
namespace {

/// Rotation of a quaternion w x y z of any length but zero: 1 + 2 (w v̂ + v̂²) / (w² + v·v).
template <class T> ThreeByThree<T> quaternion_rotation(const T* q) {
  const T w = q[0], x = q[1], y = q[2], z = q[3];
  const T s = T(2) / (w * w + (x * x + y * y + z * z));
  return {{three<T>(T(1) - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)),
           three<T>(s * (x * y - w * z), T(1) - s * (x * x + z * z), s * (y * z + w * x)),
           three<T>(s * (x * z + w * y), s * (y * z - w * x), T(1) - s * (x * x + y * y))}};
}

/// A + cos q C + sin q S
template <class T>
ThreeByThree<T> turned(const ThreeByThree<T>& A, const ThreeByThree<T>& C, const ThreeByThree<T>& S, const T& angle) {
  using std::cos;
  using std::sin;
  const T c = cos(angle), s = sin(angle);
  ThreeByThree<T> R;
  for (int k = 0; k < 3; ++k) R.column[k] = A.column[k] + C.column[k] * c + S.column[k] * s;
  return R;
}

/// A = P a aᵀ, C = P (1 − a aᵀ), S = P â of a unit axis a.
template <class T>
void axis_matrices(const Matrix3<T>& P, const Vector3<T>& a, ThreeByThree<T>& A, ThreeByThree<T>& C, ThreeByThree<T>& S) {
  const Matrix3<T> along = a * a.transpose(), across = Matrix3<T>::Identity() - along;
  A = three_by_three<T>(P * along);
  C = three_by_three<T>(P * across);
  S = three_by_three<T>(P * cross_matrix(a));
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

/// 𝒦 = 1, of a limit side · e_dofᵀ.
template <class T>
void joint_rows(const Structure& s, const Constraint& c, const Structure::JointConstraint& to, std::vector<T>& joint_K) {
  const bool limit = c.kind == Constraint::Kind::joint_limit;
  const Index n = s.dofs(to.body);
  for (Index i = 0; i < to.rows; ++i)
    for (Index j = 0; j < n; ++j) joint_K[to.first + i * n + j] = T(limit ? (j == c.dof ? c.side : 0) : i == j ? 1 : 0);
}

}  // namespace

template <class T> Mechanism<T>::Mechanism(const Model& model) : Mechanism(model, structure_of(model)) {}

template <class T>
Mechanism<T>::Mechanism(const Model& model, std::shared_ptr<const Structure> structure) : structure_(std::move(structure)) {
  const Structure& s = *structure_;
  const bool fits = s.bodies() == static_cast<Index>(model.bodies.size()) && s.first_dof == model.first_dof &&
                    s.link_constraints.size() + s.joint_constraints.size() == model.constraints.size();
  require(fits, "kinematics: the problem's structure is not structure_of(model)");
  compile_bodies(model);
  joint_K_.assign(static_cast<std::size_t>(s.joint_K_size), T(0));
  std::size_t link = 0, joint = 0;
  pairs_.reserve(static_cast<std::size_t>(std::count_if(model.constraints.begin(), model.constraints.end(),
                                                        [](const Constraint& c) { return has_closure(c.kind); })));
  for (const Constraint& c : model.constraints) {
    if (acts_on_joint(c.kind)) joint_rows(s, c, s.joint_constraints[joint++], joint_K_);
    else compile_constraint(model, c, s.link_constraints[link], link), ++link;
  }
}

template <class T> Mechanism<T> Mechanism<T>::bodies_of(const Model& model) {
  Mechanism all;
  all.compile_bodies(model);
  return all;
}

template <class T> void Mechanism<T>::compile_bodies(const Model& model) {
  const std::size_t n = model.bodies.size();
  q_size_ = model.q_size();
  armature_.assign(static_cast<std::size_t>(model.dofs()), T(0));
  rotation_.resize(n);
  position_.resize(n);
  reference_.resize(n);
  joints_.reserve(n);
  solids_.reserve(n);
  for (std::size_t i = 0; i < n; ++i) compile_body(model, static_cast<Index>(i));
}

template <class T> void Mechanism<T>::compile_body(const Model& model, Index i) {
  const Body& body = model.bodies[i];
  const Matrix3<T> P = rotation_as<T>(body.joint.placement.rotation), one = Matrix3<T>::Identity();
  const Vector3<T> nothing = Vector3<T>::Constant(T(0));
  const bool root = body.parent == ground;
  Joint j{body.joint.type, body.parent, root ? i : joints_[body.parent].tree, model.first_q[i], model.first_dof[i],
          three_by_three<T>(P), {}, {}, {}, {}, {}, {}, three<T>(nothing), three<T>(nothing), three<T>(nothing),
          three<T>(Vector3<T>(body.joint.placement.translation.template cast<T>())),
          three<T>(root && body.mass == 0 ? nothing : Vector3<T>(body.com.template cast<T>()))};
  const bool has_axis = j.type != JointType::spherical && j.type != JointType::floating;
  const Vector3<T> axis = has_axis ? unit_as<T>(body.joint.axis) : nothing;
  if (has_axis) j.axis = three<T>(Vector3<T>(P * axis));
  axis_matrices(P, axis, j.fixed, j.cosine, j.sine);
  if (j.type == JointType::universal) {
    const Vector3<T> axis2 = unit_as<T>(body.joint.axis2);
    axis_matrices(one, axis2, j.fixed2, j.cosine2, j.sine2);
    j.axis2 = three<T>(axis2);
  }
  if (j.type == JointType::planar) {
    Vector3<T> first, second;
    in_plane_axes(axis, first, second);
    j.axis2 = three<T>(Vector3<T>(P * first));
    j.axis3 = three<T>(Vector3<T>(P * second));
  }
  joints_.push_back(j);
  Matrix3<T> inertia = body.inertia.template cast<T>();  // symmetric up to rounding: M and c(q, ν) take the same entries
  inertia(1, 0) = inertia(0, 1), inertia(2, 0) = inertia(0, 2), inertia(2, 1) = inertia(1, 2);
  solids_.push_back({body.mass == 0 && (body.inertia.array() == 0).all(), T(body.mass), three_by_three<T>(inertia)});
  for (std::size_t k = 0; k < body.joint.armature.size(); ++k)
    armature_[model.first_dof[i] + static_cast<Index>(k)] = T(body.joint.armature[k]);
}

// Of the moved frame in the parent's: P R(q) and the way to its origin.
template <class T> Three<T> Mechanism<T>::local(const Joint& j, const T* q, ThreeByThree<T>& R) const {
  switch (j.type) {
    case JointType::revolute: R = turned(j.fixed, j.cosine, j.sine, q[0]); return j.shift;
    case JointType::prismatic: R = j.placement; return j.shift + j.axis * q[0];
    case JointType::universal:
      R = turned(j.fixed, j.cosine, j.sine, q[0]) * turned(j.fixed2, j.cosine2, j.sine2, q[1]);
      return j.shift;
    case JointType::planar:
      R = turned(j.fixed, j.cosine, j.sine, q[0]);
      return j.shift + (j.axis2 * q[1] + j.axis3 * q[2]);
    case JointType::spherical: R = j.placement * quaternion_rotation(q); return j.shift;
    case JointType::floating: R = j.placement * quaternion_rotation(q + 3); return j.shift + j.placement * three<T>(q[0], q[1], q[2]);
    case JointType::cylindrical: R = turned(j.fixed, j.cosine, j.sine, q[0]); return j.shift + j.axis * q[1];
  }
  return j.shift;
}

template <class T> void Mechanism<T>::update(const VectorX<T>& q) {
  require(q.size() == q_size_, "q does not have Model::q_size() entries");
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Joint& j = joints_[i];
    ThreeByThree<T> R;
    const Three<T> from_parent = local(j, q.data() + j.first_q, R);
    if (j.parent == ground) {  // the centre of mass is the reference point
      rotation_[i] = R;
      position_[i] = -(R * j.com);
      reference_[i] = from_parent - position_[i];
    } else {
      rotation_[i] = rotation_[j.parent] * R;
      position_[i] = position_[j.parent] + rotation_[j.parent] * from_parent;
    }
  }
}

template <class T> void Mechanism<T>::poses(Poses<T>& out) const {
  const std::size_t n = joints_.size();
  out.rotation.resize(n);
  out.position.resize(n);
  out.tree.resize(n);
  out.reference.resize(n, Vector3<T>::Constant(T(0)));
  for (std::size_t i = 0; i < n; ++i) {
    out.rotation[i] = matrix(rotation_[i]);
    out.position[i] = vector(position_[i]);
    out.tree[i] = joints_[i].tree;
    if (joints_[i].parent == ground) out.reference[i] = vector(reference_[i]);
  }
}

// Columns of S about the reference point: every axis passes through the origin of the moved frame.
template <class T> void Mechanism<T>::motion(const Joint& j, Index i, Vector6<T>* S) const {
  const Three<T> p = position_[i], none = three<T>(T(0), T(0), T(0));
  axes(j, i, [&](const Three<T>& axis) { store((S++)->data(), axis, cross(p, axis)); },
       [&](const Three<T>& axis) { store((S++)->data(), none, axis); });
}

// [R I Rᵀ + m (c·c 1 − c cᵀ), m ĉ; −m ĉ, m 1], symmetric to the bit
template <class T> void Mechanism<T>::inertia(Index i, Matrix6<T>& H) const {
  const Solid& body = solids_[i];
  if (body.massless) {
    H.setConstant(T(0));
    return;
  }
  const ThreeByThree<T>& R = rotation_[i];
  const ThreeByThree<T> I = times_transposed(R * body.inertia, R);
  const T m = body.mass, none(0);
  T* const h = H.data();
  const auto column = [&](int k, const Three<T>& upper, const Three<T>& lower) { store(h + 6 * k, upper, lower); };
  if (joints_[i].parent == ground) {  // the reference point is the centre of mass
    const Three<T> zero = three<T>(none, none, none);
    for (int k = 0; k < 3; ++k) {
      column(k, I.column[k], zero);
      column(3 + k, zero, three<T>(k == 0 ? m : none, k == 1 ? m : none, k == 2 ? m : none));
    }
  } else {
    const Three<T> c = position_[i] + R * joints_[i].com, mc = c * m;
    const T x = c[0], y = c[1], z = c[2], mx = mc[0], my = mc[1], mz = mc[2];
    column(0, I.column[0] + three<T>(my * y + mz * z, -(mx * y), -(mx * z)), three<T>(none, -mz, my));
    column(1, I.column[1] + three<T>(-(mx * y), mx * x + mz * z, -(my * z)), three<T>(mz, none, -mx));
    column(2, I.column[2] + three<T>(-(mx * z), -(my * z), mx * x + my * y), three<T>(-my, mx, none));
    column(3, three<T>(none, mz, -my), three<T>(m, none, none));
    column(4, three<T>(-mz, none, mx), three<T>(none, m, none));
    column(5, three<T>(my, -mx, none), three<T>(none, none, m));
  }
  h[1] = h[6], h[2] = h[12], h[8] = h[13];
}

template <class T> void Mechanism<T>::fill(Problem<T>& out) const {
  out.check_sizes();
  require(out.structure == structure_ || (out.structure->first_dof == structure_->first_dof && out.structure->rows == structure_->rows &&
                                          out.structure->K_rows == structure_->K_rows),
          "kinematics: the problem's structure is not structure_of(model)");
  std::copy(armature_.begin(), armature_.end(), out.armature.begin());
  std::copy(joint_K_.begin(), joint_K_.end(), out.joint_K.begin());
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    motion(joints_[i], static_cast<Index>(i), out.S.data() + joints_[i].first_dof);
    inertia(static_cast<Index>(i), out.H[i]);
  }
  for (const Pair& pair : pairs_) pair_rows(pair, out.K);
  for (const Terms& terms : terms_) term_rows(terms, out.S, out.K);
}

#ifndef DELASSUS_DEFINITIONS_ONLY  // property_tests/unit/mechanism/jet.cpp has scalars of its own
template class Mechanism<double>;
template class Mechanism<float>;
template class Mechanism<Quad>;
template class Mechanism<Counted>;
#endif

}  // namespace delassus
