// Kinematics and motion in jets: the library's own definitions, instantiated once more.
#define DELASSUS_DEFINITIONS_ONLY
#include "property_tests/unit/mechanism/jet.h"

#include "algorithms/mechanism/mechanism.cpp"
#include "algorithms/mechanism/mechanism_rows.cpp"
#include "algorithms/mechanism/motion.cpp"
#include "algorithms/mechanism/motion_rows.cpp"

namespace delassus {

#define DELASSUS_INSTANTIATE(T)                                                                                         \
  template <> Problem<Jet<T>>::Problem(std::shared_ptr<const Structure> s) : structure(std::move(s)) {                  \
    const auto size = [](Index n) { return static_cast<std::size_t>(n); };                                             \
    S.assign(size(structure->dofs()), Vector6<Jet<T>>::Constant(Jet<T>(0)));                                           \
    armature.assign(S.size(), Jet<T>(0));                                                                              \
    H.assign(size(structure->bodies()), Matrix6<Jet<T>>::Constant(Jet<T>(0)));                                         \
    K.assign(size(structure->K_rows), Vector6<Jet<T>>::Constant(Jet<T>(0)));                                           \
    joint_K.assign(size(structure->joint_K_size), Jet<T>(0));                                                          \
  }                                                                                                                    \
  template <> void Problem<Jet<T>>::check_sizes() const {}                                                             \
  template class Mechanism<Jet<T>>;                                                                                    \
  template class Motion<Jet<T>>;
DELASSUS_INSTANTIATE(Rational)
DELASSUS_INSTANTIATE(Quad)

}  // namespace delassus
