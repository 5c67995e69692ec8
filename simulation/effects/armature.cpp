#include "simulation/effects/armature.h"

#include "algorithms/kit/counted.h"

namespace delassus::simulation {

template <class T> Armature<T>::Armature(const Model& model) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const std::vector<double>& a = model.bodies[i].joint.armature;
    for (std::size_t k = 0; k < a.size(); ++k)
      if (a[k] != 0) rotors_.push_back({model.first_dof[i] + static_cast<Index>(k), T(a[k])});
  }
}

template <class T> void Armature<T>::add_inertia(Moment<T>& now) {
  for (const Rotor& r : rotors_) now.problem->armature[r.dof] += r.inertia;
}

template class Armature<double>;
template class Armature<Counted>;

}  // namespace delassus::simulation
