// Nanoseconds of the kernels per counted quantity (choose.h). Printed by `delassus bench --calibrate`, which measures every row on
// scenes, swimmers and families, and takes least squares of the relative errors, a scene as eight others, no term negative; not to be edited by hand.
// Intel(R) Xeon(R) Processor; g++ 12.2; kernels AVX-512; 238 problems.
#include "algorithms/operators/kernel_costs.h"

namespace delassus {

const std::vector<KernelCost>& kernel_costs() {
  using enum Quantities::Name;
  static const std::vector<KernelCost> table{
      {"aba_sweep", Phase::update, {{one, 5.09}, {bodies, 5.69}, {dofs, 21.1}, {link_rows, 1.83}}},
      {"aba_sweep", Phase::damping, {{one, 15.2}, {rows, 1.04}}},
      {"aba_sweep", Phase::product, {{one, 69.5}, {active_bodies, 11.9}, {active_dofs, 2.07}, {rows, 0.262}, {link_rows, 1}, {joint_rows, 1.92}}},
      {"aba_sweep", Phase::product_of_eight, {{one, 31.1}, {active_bodies, 15.4}, {active_dofs, 6.6}, {rows, 3.57}, {link_rows, 6.53}, {joint_rows, 5.18}}},
      {"lcaba", Phase::update, {{one, 34.3}, {bodies, 24.4}, {dofs, 9.35}, {link_rows, 7.01}, {joint_rows, 6.22}, {couplings, 7.82}}},
      {"lcaba", Phase::damping, {{one, 132}, {bodies, 14.5}, {link_rows, 5.7}, {joint_rows, 11}, {couplings, 7.95}}},
      {"lcaba", Phase::solve, {{one, 70}, {active_bodies, 15.9}, {active_dofs, 0.386}, {link_rows, 1.9}, {joint_rows, 2.51}, {couplings, 0.733}}},
      {"lcaba", Phase::solve_of_eight, {{one, 42.7}, {active_bodies, 18.4}, {active_dofs, 5.27}, {link_rows, 10.3}, {joint_rows, 9.52}, {couplings, 1.17}}},
      {"explicit_columns", Phase::update, {{one, 83.5}, {bodies, 49.9}, {dofs, 1.79}, {joint_rows, 36.5}, {row_bodies, 6.72}, {row_dofs, 14}, {row_links, 7.04}, {rows_squared, 0.175}, {tiles, 25.9}, {tile_pairs, 41.7}}},
      {"explicit_columns", Phase::damping, {{one, 13.1}, {rows, 20.7}, {tiles, 46.2}, {tile_pairs, 26.4}}},
      {"explicit_columns", Phase::product, {{one, 33.9}, {tiles, 5.19}}},
      {"explicit_columns", Phase::solve, {{one, 27.3}, {rows, 5.73}, {tiles, 6.58}}},
      {"explicit_columns", Phase::product_of_eight, {{one, 103}, {rows, 1.55}, {tiles, 41.4}}},
      {"explicit_columns", Phase::solve_of_eight, {{one, 19.9}, {rows, 39.3}, {tiles, 56.7}}},
      {"ltl_osim", Phase::update, {{depth, 9.26}, {joint_rows, 125}, {row_depth, 3.9}, {tiles, 107}, {tile_pairs, 65.9}}},
      {"ltl_osim", Phase::damping, {{one, 22.4}, {rows, 19.3}, {tiles, 45.2}, {tile_pairs, 27}}},
      {"ltl_osim", Phase::product, {{one, 34}, {tiles, 5.15}}},
      {"ltl_osim", Phase::solve, {{one, 26.5}, {rows, 5.91}, {tiles, 6.25}}},
      {"ltl_osim", Phase::product_of_eight, {{one, 102}, {rows, 1.71}, {tiles, 40.9}}},
      {"ltl_osim", Phase::solve_of_eight, {{one, 14.1}, {rows, 40.7}, {tiles, 54.6}}},
      {"caba_osim", Phase::update, {{one, 178}, {bodies, 23}, {dofs, 24.5}, {joint_rows, 28}, {couplings, 22.2}, {row_depth, 2.61}, {row_pairs, 0.075}, {rows_squared, 3.72}}},
      {"caba_osim", Phase::damping, {{one, 264}, {bodies, 26.4}, {joint_rows, 20}, {couplings, 20.6}, {row_depth, 3.71}, {row_pairs, 0.0542}, {rows_squared, 3.44}}},
      {"caba_osim", Phase::solve, {{one, 40.5}, {row_packets, 0.354}, {row_singles, 0.0814}}},
      {"caba_osim", Phase::solve_of_eight, {{one, 133}, {rows, 2.93}, {row_packets, 2.69}, {row_singles, 0.75}}},
      {"caba_osimr", Phase::update, {{bodies, 110}, {dofs, 19.7}, {joint_rows, 51.7}, {row_depth, 6.25}, {row_pairs, 0.0846}, {rows_squared, 3.8}}},
      {"caba_osimr", Phase::damping, {{one, 121}, {bodies, 96.7}, {joint_rows, 42.3}, {row_depth, 7.14}, {row_pairs, 0.0596}, {rows_squared, 3.68}}},
      {"caba_osimr", Phase::solve, {{one, 40.4}, {row_packets, 0.352}, {row_singles, 0.0813}}},
      {"caba_osimr", Phase::solve_of_eight, {{one, 132}, {rows, 3.04}, {row_packets, 2.69}, {row_singles, 0.744}}},
      {"ladder", Phase::update, {{bodies, 40.8}, {dofs, 17}, {link_rows, 11.2}, {joint_rows, 13.9}, {couplings, 7.76}}},
      {"ladder", Phase::damping, {{one, 193}, {bodies, 17.6}, {link_rows, 7.75}, {joint_rows, 15.4}, {couplings, 7.79}}},
      {"ladder", Phase::solve, {{one, 429}, {active_bodies, 70.5}, {active_dofs, 35.3}, {rows, 6.59}, {link_rows, 13.4}, {joint_rows, 2.88}, {couplings, 1.01}}},
      {"ladder", Phase::solve_of_eight, {{one, 500}, {active_bodies, 175}, {active_dofs, 132}, {rows, 59.5}, {link_rows, 69.3}, {couplings, 1.67}}},
      {"kkt_elimination", Phase::update, {{bodies, 5.16}, {dofs, 88.9}, {rows, 36.4}, {joint_rows, 128}, {row_bodies, 76.7}, {row_dofs, 10.6}, {rows_squared, 2.56}, {rows_cubed, 0.0652}}},
      {"kkt_elimination", Phase::damping, {{one, 1.08}, {rows, 31}, {rows_squared, 1.25}, {rows_cubed, 0.0443}}},
      {"kkt_elimination", Phase::product, {{one, 44.1}, {rows, 1.33}, {row_packets, 1.04}, {row_singles, 0.469}}},
      {"kkt_elimination", Phase::solve, {{one, 552}, {active_bodies, 78.8}, {active_dofs, 44.2}, {rows, 11.5}, {joint_rows, 14}, {rows_squared, 1.86}}},
      {"kkt_elimination", Phase::product_of_eight, {{one, 127}, {rows, 17.6}, {row_packets, 7.79}, {row_singles, 3.43}}},
      {"kkt_elimination", Phase::solve_of_eight, {{one, 3.99e+03}, {active_bodies, 622}, {active_dofs, 356}, {rows, 119}, {joint_rows, 123}, {rows_squared, 14.2}}},
  };
  return table;
}

}  // namespace delassus
