// The catalogue of hard cases: why each family is hard, and the sizes of its table.
#include "generators/families_hard.h"

namespace delassus::generators {

const std::vector<HardCase>& hard_cases() {
  static const std::vector<HardCase> table{
      {"stiffest", "The inversion lemma subtracts two numbers of size R to get forces of size 1: log10(R λmax) digits cancel.", {4, 16}},
      {"softest", "J M⁻¹Jᵀ is below the rounding of R⁻¹: forces are R a, and motions must not be lost with it.", {4, 16}},
      {"uniform_damping", "Every second decade between the two; the table has 1e-6.", {4, 16}},
      {"mixed_damping", "R⁻¹ spans 20 decades: no single scale of forces or of residuals exists.", {10, 18}},
      {"contacts", "Four contacts on a face: 12 rows for 6 freedoms, forces beyond 6 are fixed by damping alone.", {2, 8}},
      {"stiff_contacts", "The same with κ(A) = R λmax: forces that move nothing are divided by 1e-12.", {2, 8}},
      {"mixed_contacts", "Redundant rows of very unequal stiffness share one load.", {2, 6}},
      {"redundant", "Coincident points and closures given twice: J has not full row rank.", {2, 8}},
      {"stiff_redundant", "The same, nearly undamped.", {2, 8}},
      {"hard_redundant", "The same, undamped: A is singular and forces are not unique.", {2, 5}},
      {"hard", "R⁻¹ = 0: forms that need R do not exist.", {4, 16}},
      {"partly_hard", "R⁻¹ = 0 beside R⁻¹ > 0.", {4, 9}},
      {"four_bar", "A planar closure in space: one row in three is dependent up to rounding.", {4, 16}},
      {"parallel_hinges", "Of ten rows of a door on two hinges at most two are independent.", {4, 12}},
      {"near_singular", "The tip of a stretched arm hardly moves along the arm.", {3, 8}},
      {"stretched", "The row along the arm is 1e-9 of the others: between dependent and independent.", {3, 8}},
      {"folded", "Joints coincide and the closure row all but vanishes.", {3, 8}},
      {"mass_ratio", "Light links carry heavy ones: articulated inertias are sums in which the small part matters.", {4, 10}},
      {"heavy_tip", "The same at a ratio of 1e12.", {4, 12}},
      {"heavy_base", "A ratio of 1e12 the other way round.", {4, 12}},
      {"massless", "M is regular only by armature and children.", {4, 12}},
      {"near_massless", "Pivots of M are rotors of 1e-10 kg m² under inertias of 1.", {4, 12}},
      {"long_chain", "Rounding of 10⁴ joints adds up, and positions grow to kilometres.", {100, 1000, 10000}},
      {"ring", "A loop through all bodies.", {4, 16}},
      {"stiff_ring", "A stiff loop through all bodies, and a chord.", {4, 16}},
      {"nested_loops", "Loops in loops: fill grows with depth.", {8, 40}},
      {"rungs", "Every loop shares bodies with the next.", {9, 41}},
      {"lattice", "As many loops as bodies.", {4, 16}},
      {"stiff_lattice", "As many stiff loops as bodies.", {4, 16}},
      {"truss", "Rows of one coefficient each, stiff, along random directions.", {4, 14}},
      {"several_trees", "Trees meet only in constraints.", {4, 16}},
      {"far_point", "A lever of 1 km: one row of a point weighs 1e6 times another.", {3, 10}},
      {"farthest_point", "A lever of 10⁶ km: A spans 18 decades.", {3, 10}},
      {"large_world", "Levers from 1 m to 10⁶ km in one system.", {4, 12}},
      {"world_frame", "All data are differences of large numbers; the library's own loaders never make it.", {3, 10}},
      {"micrometre", "Moments are 1e-12 of forces: rows differ by their units.", {4, 16}},
      {"kilometre", "The same the other way round.", {4, 16}},
      {"mixed_units", "Every magnitude of SI in one chain.", {6, 15}},
      {"tiny_numbers", "Float ends at 1e-38, squares at 1e-154, A at masses of 1e-308 kg; below 2e-308 numbers lose their digits.", {30, 150, 300, 310, 320}},
      {"huge_numbers", "Float ends at 1e38, squares at 1e154, masses at 1e308 kg.", {30, 150, 300, 307}},
  };
  return table;
}

}  // namespace delassus::generators
