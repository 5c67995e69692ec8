#include "simulation/effects/velocity_products.h"

#include "algorithms/kit/counted.h"

namespace delassus::simulation {
namespace {

bool turns(JointType t) { return t != JointType::prismatic; }

bool isotropic(const Body& b) {
  return (b.com.array() == 0).all() && b.inertia == Matrix3<double>(b.inertia(0, 0) * Matrix3<double>::Identity());
}

/// Of a body that is a tree by itself.
bool vanishes_alone(const Body& b) {
  switch (b.joint.type) {
    case JointType::revolute:
    case JointType::prismatic:
    case JointType::cylindrical: return true;
    case JointType::floating:
    case JointType::spherical: return isotropic(b);
    case JointType::planar: return (b.com.array() == 0).all();
    case JointType::universal: return false;
  }
  return false;
}

}  // namespace

Call has_velocity_products(const Scene& scene) {
  const auto& bodies = scene.model.bodies;
  std::vector<std::size_t> tree(bodies.size());
  std::vector<Index> size(bodies.size(), 0);
  std::vector<bool> turning(bodies.size(), false);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    tree[i] = bodies[i].parent == ground ? i : tree[static_cast<std::size_t>(bodies[i].parent)];
    ++size[tree[i]];
    turning[tree[i]] = turning[tree[i]] || turns(bodies[i].joint.type);
  }
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (tree[i] == i && turning[i] && !(size[i] == 1 && vanishes_alone(bodies[i])))
      return {true, "tree of " + bodies[i].name + ": joints turn"};
  return {false, "they vanish: no tree has turning joints but single bodies about a fixed axis, or free ones with the same inertia about every axis"};
}

template <class T> VelocityProducts<T>::VelocityProducts(const Model& model, const Mechanism<T>& mechanism)
    : motion_(mechanism), bodies_(static_cast<Index>(model.bodies.size())) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (model.bodies[i].joint.type == JointType::floating) (model.bodies[i].parent == ground ? roots_ : inner_).push_back(model.first_dof[i]);
  nu_ = VectorX<T>::Constant(model.dofs(), T(0));
  product_ = nu_;
  c_ = nu_;
}

template <class T> void VelocityProducts<T>::add_force(Moment<T>& now) {
  nu_ = now.state->nu;
  for (const Index k : roots_) nu_.template segment<3>(k + 3).setConstant(T(0));
  motion_.update(nu_);
  if (inner_.empty()) {
    motion_.bias_forces(c_);
  } else {
    for (const Index k : inner_) {
      const Vector3<T> omega = nu_.template segment<3>(k), v = nu_.template segment<3>(k + 3);
      product_.template segment<3>(k + 3) = -omega.cross(v);
    }
    motion_.rnea(product_, Vector3<T>(T(0), T(0), T(0)), c_);
  }
  *now.force -= c_;
}

template <class T> Index VelocityProducts<T>::bytes() const {
  const auto per_body = static_cast<Index>(19 * sizeof(Vector3<T>) + sizeof(Vector3<T>));  // six motions or forces, a velocity
  return static_cast<Index>(sizeof(*this)) + bodies_ * per_body + 3 * nu_.size() * static_cast<Index>(sizeof(T));
}

template class VelocityProducts<double>;
template class VelocityProducts<Counted>;

}  // namespace delassus::simulation
