// A linkage as a Model of the library, by a random tree and turned; and its inertia at the drivers without either.
#pragma once

#include "algorithms/kit/test_scalars.h"
#include "algorithms/mechanism/model.h"
#include "property_tests/campaigns/linkage_shapes.h"

namespace delassus::laws {

struct LinkMass {
  double mass;
  Vector3<double> com;       ///< world axes, unturned
  Matrix3<double> inertia;
};
[[nodiscard]] std::vector<LinkMass> random_masses(const Linkage& l, generators::Random& r);

/// Inertia at the drivers, d × d, by the null space of all joints between free links in Quad; `size` is what a relative
/// change of eps in every number of joints and masses moves it by. Empty when the drivers do not determine the motion.
struct Reduced {
  MatrixX<Quad> inertia, size;
};
[[nodiscard]] Reduced reduced_inertia(const Linkage& l, const std::vector<LinkMass>& masses);

/// Bodies along a random spanning tree with the drivers in it, body axes at random; the joints left are closed by hinges or
/// sliding constraints, the drivers locked, all in random order, all turned by a random rotation, moved, lengths times
/// `length`, masses times `mass`. At q = 0.
struct Turned {
  Model model;
  std::vector<Index> driver_rows;
};
[[nodiscard]] Turned turned_model(const Linkage& l, const std::vector<LinkMass>& masses, double length, double mass, generators::Random& r);

}  // namespace delassus::laws
