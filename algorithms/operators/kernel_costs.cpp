// Nanoseconds of the kernels per counted quantity (choose.h). Printed by `delassus bench --calibrate`, which measures every row on
// scenes, swimmers and families, and takes least squares of the relative errors, a scene as eight others, no term negative; not to be edited by hand.
// AMD EPYC; g++ 12.2; kernels AVX-512; 238 problems.
#include "algorithms/operators/kernel_costs.h"

namespace delassus {

const std::vector<KernelCost>& kernel_costs() {
  using enum Quantities::Name;
  static const std::vector<KernelCost> table{
      {"aba_sweep", Phase::update, {{one, 53.1}, {bodies, 6.85}, {dofs, 17.5}, {link_rows, 1.16}}},
      {"aba_sweep", Phase::damping, {{one, 23.7}, {rows, 0.799}}},
      {"aba_sweep", Phase::product, {{one, 86.1}, {active_bodies, 11.3}, {active_dofs, 1.64}, {rows, 0.5}, {link_rows, 0.74}, {joint_rows, 3.54}}},
      {"aba_sweep", Phase::product_of_eight, {{one, 86.5}, {active_bodies, 13.7}, {active_dofs, 4.93}, {rows, 4.54}, {link_rows, 3.83}, {joint_rows, 6.43}}},
      {"lcaba", Phase::update, {{one, 104}, {bodies, 22.5}, {dofs, 5.22}, {link_rows, 5.68}, {joint_rows, 12.7}, {couplings, 5.73}}},
      {"lcaba", Phase::damping, {{one, 163}, {bodies, 12.1}, {link_rows, 4.6}, {joint_rows, 16.2}, {couplings, 6.24}}},
      {"lcaba", Phase::solve, {{one, 87.4}, {active_bodies, 14.5}, {active_dofs, 0.485}, {link_rows, 1.71}, {joint_rows, 5}, {couplings, 0.736}}},
      {"lcaba", Phase::solve_of_eight, {{one, 106}, {active_bodies, 19.5}, {active_dofs, 1.05}, {link_rows, 8.19}, {joint_rows, 13.4}, {couplings, 1.08}}},
      {"explicit_columns", Phase::update, {{one, 137}, {bodies, 25.3}, {dofs, 13.6}, {joint_rows, 56.7}, {row_bodies, 10.6}, {row_dofs, 6.56}, {row_links, 5.06}, {tiles, 90.1}, {tile_pairs, 18.2}}},
      {"explicit_columns", Phase::damping, {{one, 18.2}, {rows, 18.5}, {tiles, 39.7}, {tile_pairs, 16.1}}},
      {"explicit_columns", Phase::product, {{one, 34.7}, {rows, 0.363}, {tiles, 5.36}}},
      {"explicit_columns", Phase::solve, {{one, 36.1}, {rows, 5.74}, {tiles, 5.51}}},
      {"explicit_columns", Phase::product_of_eight, {{one, 76.6}, {rows, 2.77}, {tiles, 42.6}}},
      {"explicit_columns", Phase::solve_of_eight, {{one, 9.47}, {rows, 41.6}, {tiles, 51.7}}},
      {"ltl_osim", Phase::update, {{one, 1.33}, {depth, 8.33}, {joint_rows, 136}, {row_depth, 2.88}, {row_pairs, 0.00564}, {tiles, 141}, {tile_pairs, 21.1}}},
      {"ltl_osim", Phase::damping, {{one, 16.9}, {rows, 18.8}, {tiles, 39.3}, {tile_pairs, 16}}},
      {"ltl_osim", Phase::product, {{one, 35.4}, {rows, 0.362}, {tiles, 5.25}}},
      {"ltl_osim", Phase::solve, {{one, 37}, {rows, 5.69}, {tiles, 5.67}}},
      {"ltl_osim", Phase::product_of_eight, {{one, 78}, {rows, 2.96}, {tiles, 42.2}}},
      {"ltl_osim", Phase::solve_of_eight, {{one, 10.9}, {rows, 42.2}, {tiles, 51}}},
      {"caba_osim", Phase::update, {{one, 317}, {bodies, 5.88}, {dofs, 27.9}, {joint_rows, 57}, {couplings, 19}, {row_depth, 3.22}, {row_pairs, 0.047}, {rows_squared, 2.1}}},
      {"caba_osim", Phase::damping, {{one, 390}, {bodies, 16.7}, {joint_rows, 58.1}, {couplings, 18.4}, {row_depth, 4.4}, {row_pairs, 0.0373}, {rows_squared, 2}}},
      {"caba_osim", Phase::solve, {{one, 39}, {rows, 0.62}, {row_packets, 0.338}, {row_singles, 0.0762}}},
      {"caba_osim", Phase::solve_of_eight, {{one, 93.5}, {rows, 5.86}, {row_packets, 2.65}, {row_singles, 0.769}}},
      {"caba_osimr", Phase::update, {{one, 333}, {bodies, 70.2}, {dofs, 23.6}, {joint_rows, 76.1}, {row_depth, 7.01}, {row_pairs, 0.0296}, {rows_squared, 2.1}}},
      {"caba_osimr", Phase::damping, {{one, 394}, {bodies, 71}, {joint_rows, 77.4}, {row_depth, 8.23}, {row_pairs, 0.0215}, {rows_squared, 2.01}}},
      {"caba_osimr", Phase::solve, {{one, 39.2}, {rows, 0.755}, {row_packets, 0.338}, {row_singles, 0.044}}},
      {"caba_osimr", Phase::solve_of_eight, {{one, 96}, {rows, 6.57}, {row_packets, 2.62}, {row_singles, 0.556}}},
      {"ladder", Phase::update, {{one, 173}, {bodies, 30.5}, {dofs, 8.69}, {link_rows, 8.13}, {joint_rows, 18.7}, {couplings, 5.37}}},
      {"ladder", Phase::damping, {{one, 218}, {bodies, 14.1}, {link_rows, 6.52}, {joint_rows, 20.7}, {couplings, 6.09}}},
      {"ladder", Phase::solve, {{one, 726}, {active_bodies, 63.2}, {active_dofs, 21.9}, {rows, 5.79}, {link_rows, 10.9}, {joint_rows, 22.1}, {couplings, 0.959}}},
      {"ladder", Phase::solve_of_eight, {{one, 1.8e+03}, {active_bodies, 141}, {active_dofs, 66.4}, {rows, 61.3}, {link_rows, 42.1}, {joint_rows, 8.11}, {couplings, 1.43}}},
      {"kkt_elimination", Phase::update, {{dofs, 61.1}, {rows, 65.9}, {joint_rows, 200}, {row_bodies, 70.5}, {row_dofs, 10.5}, {rows_squared, 3.93}, {rows_cubed, 0.0213}}},
      {"kkt_elimination", Phase::damping, {{rows, 28}, {rows_squared, 2.11}, {rows_cubed, 0.0168}}},
      {"kkt_elimination", Phase::product, {{one, 38.3}, {rows, 3.48}, {row_packets, 0.719}, {row_singles, 0.377}}},
      {"kkt_elimination", Phase::solve, {{one, 741}, {active_bodies, 67.2}, {active_dofs, 30.6}, {rows, 23.7}, {joint_rows, 36}, {rows_squared, 0.81}}},
      {"kkt_elimination", Phase::product_of_eight, {{one, 52.8}, {rows, 31.4}, {row_packets, 5.85}, {row_singles, 2.8}}},
      {"kkt_elimination", Phase::solve_of_eight, {{one, 5.6e+03}, {active_bodies, 536}, {active_dofs, 245}, {rows, 192}, {joint_rows, 286}, {rows_squared, 6.41}}},
  };
  return table;
}

}  // namespace delassus
