#include "simulation/observe.h"

#include "algorithms/kit/counted.h"

namespace delassus::simulation {
namespace {

Model without_constraints(Model model) {
  model.constraints.clear();
  return model;
}

}  // namespace

template <class T>
Observer<T>::Observer(const Scene& scene) : scene_(&scene), mechanism_(without_constraints(scene.model)), motion_(mechanism_) {}

template <class T> Observed<T> Observer<T>::operator()(const State<T>& state) {
  const Vector3<T> zero(T(0), T(0), T(0)), g = scene_->gravity.cast<T>();
  Observed<T> out;
  out.linear = out.angular = out.centre = zero;
  mechanism_.update(state.q);
  mechanism_.poses(poses_);
  motion_.update(state.nu);
  motion_.twists(twists_);
  const auto& bodies = scene_->model.bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Matrix3<T>& R = poses_.rotation[i];
    const Vector3<T> c = poses_.position[i] + R * bodies[i].com.cast<T>(), omega = twists_[i].template head<3>();
    const Vector3<T> v = twists_[i].template tail<3>() + omega.cross(c);
    const Vector3<T> spin = R * (bodies[i].inertia.cast<T>() * (R.transpose() * omega));
    const Vector3<T> at = poses_.reference[static_cast<std::size_t>(poses_.tree[i])] + c, p = T(bodies[i].mass) * v;
    out.kinetic += (p.dot(v) + spin.dot(omega)) / T(2);
    if (scene_->has_gravity) out.potential -= T(bodies[i].mass) * g.dot(at);
    out.linear += p;
    out.angular += at.cross(p) + spin;
    out.centre += T(bodies[i].mass) * at;
    out.mass += T(bodies[i].mass);
    const auto& armature = bodies[i].joint.armature;
    for (std::size_t k = 0; k < armature.size(); ++k) {
      const T rate = state.nu[scene_->model.first_dof[i] + static_cast<Index>(k)];
      out.kinetic += T(armature[k]) * rate * rate / T(2);
    }
  }
  if (out.mass > T(0)) out.centre /= out.mass;
  for (const auto& s : scene_->motion.springs) {
    const Index k = SceneMotion::coordinate(scene_->model, s.body, s.dof);
    if (k < 0) continue;
    const T stretch = state.q[k] - T(s.rest);
    out.potential += T(s.stiffness) * stretch * stretch / T(2);
  }
  return out;
}

template class Observer<double>;
template class Observer<Counted>;

}  // namespace delassus::simulation
