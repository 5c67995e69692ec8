#include "algorithms/mechanism/motion.h"

#include "algorithms/kit/counted.h"
#include "algorithms/kit/quad.h"


namespace delassus {
namespace {

template <class T> Three<T> nothing() { return three<T>(T(0), T(0), T(0)); }

}  // namespace

template <class T> Motion<T>::Motion(const Mechanism<T>& mechanism) : mechanism_(&mechanism) {
  const Parts rest{nothing<T>(), nothing<T>()};
  for (auto* all : {&joint_, &own_, &velocity_, &product_, &accelerated_, &force_}) all->assign(mechanism.joints_.size(), rest);
  of_reference_.assign(mechanism.joints_.size(), nothing<T>());
}

// ω_J and v_J of these rates.
template <class T> auto Motion<T>::joint_motion(const Joint& j, Index i, const T* rates) const -> Parts {
  Parts of{nothing<T>(), nothing<T>()};
  mechanism_->axes(j, i, [&](const Three<T>& axis) { of.angular = of.angular + axis * *rates++; },
                   [&](const Three<T>& axis) { of.linear = of.linear + axis * *rates++; });
  return of;
}

// e_ω and e_v: axes that the joint itself moves.
template <class T> auto Motion<T>::own_product(const Joint& j, Index i, const T* rates) const -> Parts {
  Parts own{nothing<T>(), nothing<T>()};
  if (j.type == JointType::floating) own.linear = cross(joint_[i].angular, joint_[i].linear);
  if (j.type == JointType::universal) {
    const Three<T> first = j.parent == ground ? j.axis : mechanism_->rotation_[j.parent] * j.axis;
    own.angular = cross(first * rates[0], (mechanism_->rotation_[i] * j.axis2) * rates[1]);
  }
  return own;
}

template <class T> void Motion<T>::update(const VectorX<T>& nu) {
  const Mechanism<T>& m = *mechanism_;
  require(nu.size() == static_cast<Index>(m.armature_.size()), "motion: the velocities do not have Model::dofs() entries");
  for (std::size_t k = 0; k < m.joints_.size(); ++k) {
    const Joint& j = m.joints_[k];
    const Index i = static_cast<Index>(k);
    const T* const rates = nu.data() + j.first_dof;
    joint_[i] = joint_motion(j, i, rates);
    own_[i] = own_product(j, i, rates);
    if (j.parent == ground) {  // v of the reference point is v_J − ω × p, with p from there to the origin
      const Three<T> turning = cross(joint_[i].angular, m.position_[i]);
      velocity_[i] = {joint_[i].angular, turning};
      of_reference_[i] = joint_[i].linear - turning;
    } else {
      const Parts& parent = velocity_[j.parent];
      velocity_[i] = {parent.angular + joint_[i].angular,
                      parent.linear + cross(parent.angular, m.position_[i] - m.position_[j.parent]) + joint_[i].linear};
    }
  }
  accelerations(nullptr, product_);
}

// α and a of every body at these ν̇; nullptr: zero.
template <class T> void Motion<T>::accelerations(const T* rates, std::vector<Parts>& out) const {
  const Mechanism<T>& m = *mechanism_;
  for (std::size_t k = 0; k < m.joints_.size(); ++k) {
    const Joint& j = m.joints_[k];
    const Index i = static_cast<Index>(k);
    Parts a = own_[i];
    if (j.parent != ground) {
      const Parts& parent = out[j.parent];
      const Three<T> omega = velocity_[j.parent].angular, r = m.position_[i] - m.position_[j.parent];
      a.angular = a.angular + (parent.angular + cross(omega, joint_[i].angular));
      a.linear = a.linear + (parent.linear + cross(parent.angular, r) + cross(omega, cross(omega, r) + joint_[i].linear * T(2)));
    }
    if (rates != nullptr) {
      const Parts of_joint = joint_motion(j, i, rates + j.first_dof);
      a = {a.angular + of_joint.angular, a.linear + of_joint.linear};
    }
    out[i] = a;
  }
}

// N + c × F and F, with c from the reference point
template <class T> void Motion<T>::forces(const std::vector<Parts>& accelerations, const Three<T>& g) {
  const Mechanism<T>& m = *mechanism_;
  for (std::size_t i = 0; i < m.joints_.size(); ++i) {
    const auto& solid = m.solids_[i];
    force_[i] = {nothing<T>(), nothing<T>()};
    if (solid.massless) continue;
    const ThreeByThree<T>& R = m.rotation_[i];
    const auto inertia = [&](const Three<T>& x) { return R * (solid.inertia * transposed_times(R, x)); };
    const Three<T> omega = velocity_[i].angular, com = R * m.joints_[i].com;
    const Parts& a = accelerations[i];
    const Three<T> force = (a.linear + cross(a.angular, com) + cross(omega, cross(omega, com)) - g) * solid.mass;
    const Three<T> moment = inertia(a.angular) + cross(omega, inertia(omega));
    const bool at_reference = m.joints_[i].parent == ground;  // the centre of mass of a root
    force_[i] = {at_reference ? moment : moment + cross(m.position_[i] + com, force), force};
  }
}

// f_π += f_i;  c_k = S_kᵀ f_i
template <class T> void Motion<T>::inward(T* c) {
  const Mechanism<T>& m = *mechanism_;
  for (Index i = static_cast<Index>(m.joints_.size()); i-- > 0;) {
    const Joint& j = m.joints_[i];
    const Parts f = force_[i];
    const Three<T> about_origin = f.angular - cross(m.position_[i], f.linear);
    T* to = c + j.first_dof;
    m.axes(j, i, [&](const Three<T>& axis) { *to++ = dot(axis, about_origin); },
           [&](const Three<T>& axis) { *to++ = dot(axis, f.linear); });
    if (j.parent != ground) force_[j.parent] = {force_[j.parent].angular + f.angular, force_[j.parent].linear + f.linear};
  }
}

template <class T> void Motion<T>::bias_forces(const Vector3<T>& g, VectorX<T>& c) {
  c.resize(static_cast<Index>(mechanism_->armature_.size()));
  forces(product_, three<T>(g));
  inward(c.data());
}

template <class T> void Motion<T>::rnea(const VectorX<T>& acceleration, const Vector3<T>& g, VectorX<T>& tau) {
  const auto& armature = mechanism_->armature_;
  const Index n = static_cast<Index>(armature.size());
  require(acceleration.size() == n, "motion: the accelerations do not have Model::dofs() entries");
  accelerations(acceleration.data(), accelerated_);
  forces(accelerated_, three<T>(g));
  tau.resize(n);
  inward(tau.data());
  for (Index k = 0; k < n; ++k) tau[k] += armature[static_cast<std::size_t>(k)] * acceleration[k];
}

template <class T> Three<T> Motion<T>::reference_velocity(Index body) const {
  return body == ground ? nothing<T>() : of_reference_[mechanism_->joints_[body].tree];
}

template <class T> void Motion<T>::twists(std::vector<Vector6<T>>& out) const {
  out.resize(velocity_.size(), Vector6<T>::Constant(T(0)));
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Parts& v = velocity_[i];
    const Three<T> at_reference = v.linear - cross(v.angular, mechanism_->position_[i]);
    store(out[i].data(), v.angular, at_reference + reference_velocity(static_cast<Index>(i)));
  }
}

// Of the body's point at the reference point, whose acceleration is a − α × p + ω × (ω × p), less ω × its velocity.
template <class T> void Motion<T>::velocity_products(std::vector<Vector6<T>>& out) const {
  out.resize(velocity_.size(), Vector6<T>::Constant(T(0)));
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Parts &v = velocity_[i], &a = product_[i];
    const Three<T> of_origin = v.linear + reference_velocity(static_cast<Index>(i));
    store(out[i].data(), a.angular, a.linear - cross(a.angular, mechanism_->position_[i]) - cross(v.angular, of_origin));
  }
}

#ifndef DELASSUS_DEFINITIONS_ONLY  // property_tests/unit/mechanism/jet.cpp has scalars of its own
#define DELASSUS_INSTANTIATE(T)                                                                              \
  template Motion<T>::Motion(const Mechanism<T>&);                                                          \
  template void Motion<T>::update(const VectorX<T>&);                                                       \
  template void Motion<T>::bias_forces(const Vector3<T>&, VectorX<T>&);                                     \
  template void Motion<T>::rnea(const VectorX<T>&, const Vector3<T>&, VectorX<T>&);                         \
  template Three<T> Motion<T>::reference_velocity(Index) const;                                             \
  template void Motion<T>::twists(std::vector<Vector6<T>>&) const;                                          \
  template void Motion<T>::velocity_products(std::vector<Vector6<T>>&) const;
DELASSUS_INSTANTIATE(double)
DELASSUS_INSTANTIATE(float)
DELASSUS_INSTANTIATE(Quad)
DELASSUS_INSTANTIATE(Counted)
#undef DELASSUS_INSTANTIATE
#endif

}  // namespace delassus
