// Nanoseconds of the kernels per counted quantity (choose.h). Printed by `delassus bench --calibrate`, which measures every row on
// scenes, swimmers and families, and takes least squares of the relative errors, a scene as eight others, no term negative; not to be edited by hand.
// AMD EPYC; g++ 12.2; kernels AVX-512; 238 problems.
#include "algorithms/operators/kernel_costs.h"

namespace delassus {

const std::vector<KernelCost>& kernel_costs() {
  using enum Quantities::Name;
  static const std::vector<KernelCost> table{
      {"aba_sweep", Phase::update, {{one, 42.7}, {bodies, 6.1}, {dofs, 16.4}, {link_rows, 1.31}}},
      {"aba_sweep", Phase::damping, {{one, 27.7}, {rows, 0.741}}},
      {"aba_sweep", Phase::product, {{one, 86.4}, {active_bodies, 11.3}, {active_dofs, 1.81}, {link_rows, 0.945}, {joint_rows, 2.78}}},
      {"aba_sweep", Phase::product_of_eight, {{one, 84.9}, {active_bodies, 14.2}, {active_dofs, 4.89}, {rows, 2.15}, {link_rows, 4.87}, {joint_rows, 5.3}}},
      {"lcaba", Phase::update, {{one, 104}, {bodies, 21}, {dofs, 5.88}, {link_rows, 4.87}, {joint_rows, 5.23}, {couplings, 5.74}}},
      {"lcaba", Phase::damping, {{one, 152}, {bodies, 12.8}, {link_rows, 4.07}, {joint_rows, 8.8}, {couplings, 6.24}}},
      {"lcaba", Phase::solve, {{one, 84.8}, {active_bodies, 14}, {active_dofs, 1.09}, {link_rows, 1.46}, {joint_rows, 2.82}, {couplings, 0.722}}},
      {"lcaba", Phase::solve_of_eight, {{one, 94.7}, {active_bodies, 19.5}, {active_dofs, 1.54}, {link_rows, 7.57}, {joint_rows, 8.31}, {couplings, 1.16}}},
      {"explicit_columns", Phase::update, {{one, 136}, {bodies, 25.2}, {dofs, 10.4}, {joint_rows, 30.6}, {row_bodies, 12.7}, {row_dofs, 5.73}, {row_links, 3.64}, {rows_squared, 1.78}, {rows_cubed, 0.0167}}},
      {"explicit_columns", Phase::damping, {{one, 22.6}, {rows, 8.62}, {rows_squared, 1.3}, {rows_cubed, 0.0136}}},
      {"explicit_columns", Phase::product, {{one, 46.2}, {rows, 2.99}, {row_packets, 0.739}, {row_singles, 0.32}}},
      {"explicit_columns", Phase::solve, {{one, 48.9}, {rows, 6.76}, {rows_squared, 0.339}}},
      {"explicit_columns", Phase::product_of_eight, {{one, 74.4}, {rows, 25.2}, {row_packets, 5.75}, {row_singles, 2.79}}},
      {"explicit_columns", Phase::solve_of_eight, {{one, 1.35}, {rows, 66.8}, {rows_squared, 2.56}}},
      {"ltl_osim", Phase::update, {{depth, 7.17}, {rows, 4}, {joint_rows, 138}, {row_depth, 3.96}, {row_pairs, 0.0519}, {rows_squared, 1.44}, {rows_cubed, 0.0149}}},
      {"ltl_osim", Phase::damping, {{one, 20.8}, {rows, 8.77}, {rows_squared, 1.34}, {rows_cubed, 0.0109}}},
      {"ltl_osim", Phase::product, {{one, 46}, {rows, 3}, {row_packets, 0.748}, {row_singles, 0.308}}},
      {"ltl_osim", Phase::solve, {{one, 48.3}, {rows, 6.8}, {rows_squared, 0.337}}},
      {"ltl_osim", Phase::product_of_eight, {{one, 74.3}, {rows, 25}, {row_packets, 5.76}, {row_singles, 2.81}}},
      {"ltl_osim", Phase::solve_of_eight, {{rows, 67.2}, {rows_squared, 2.52}}},
      {"caba_osim", Phase::update, {{one, 253}, {bodies, 17.2}, {dofs, 24.4}, {joint_rows, 33}, {couplings, 20.1}, {row_depth, 1.31}, {row_pairs, 0.0592}, {rows_squared, 2.7}}},
      {"caba_osim", Phase::damping, {{one, 292}, {bodies, 24.8}, {joint_rows, 33.7}, {couplings, 19.1}, {row_depth, 2.71}, {row_pairs, 0.0455}, {rows_squared, 2.55}}},
      {"caba_osim", Phase::solve, {{one, 44.7}, {rows, 3.12}, {row_packets, 0.726}, {row_singles, 0.349}}},
      {"caba_osim", Phase::solve_of_eight, {{one, 79.2}, {rows, 24.8}, {row_packets, 5.87}, {row_singles, 2.71}}},
      {"caba_osimr", Phase::update, {{one, 205}, {bodies, 84.8}, {dofs, 21.9}, {joint_rows, 32.1}, {couplings, 2.04}, {row_depth, 4.08}, {row_pairs, 0.0655}, {rows_squared, 2.75}}},
      {"caba_osimr", Phase::damping, {{one, 252}, {bodies, 82.8}, {joint_rows, 35.2}, {couplings, 2.14}, {row_depth, 5.65}, {row_pairs, 0.0483}, {rows_squared, 2.62}}},
      {"caba_osimr", Phase::solve, {{one, 45.9}, {rows, 3.03}, {row_packets, 0.736}, {row_singles, 0.319}}},
      {"caba_osimr", Phase::solve_of_eight, {{one, 79.9}, {rows, 24.5}, {row_packets, 5.81}, {row_singles, 2.8}}},
      {"ladder", Phase::update, {{one, 155}, {bodies, 29}, {dofs, 8.91}, {link_rows, 7.51}, {joint_rows, 10.1}, {couplings, 5.43}}},
      {"ladder", Phase::damping, {{one, 195}, {bodies, 15}, {link_rows, 5.95}, {joint_rows, 12.7}, {couplings, 6.04}}},
      {"ladder", Phase::solve, {{one, 616}, {active_bodies, 62.4}, {active_dofs, 25}, {link_rows, 12.7}, {joint_rows, 13.5}, {couplings, 1.05}}},
      {"ladder", Phase::solve_of_eight, {{one, 1.26e+03}, {active_bodies, 129}, {active_dofs, 79.3}, {rows, 35.2}, {link_rows, 50.5}, {couplings, 1.67}}},
      {"kkt_elimination", Phase::update, {{one, 54}, {bodies, 7.02}, {dofs, 67.6}, {rows, 20}, {joint_rows, 134}, {row_bodies, 60.5}, {row_dofs, 12.8}, {row_links, 1.66}, {rows_squared, 4.2}, {rows_cubed, 0.0189}}},
      {"kkt_elimination", Phase::damping, {{one, 22.8}, {rows, 23.8}, {rows_squared, 1.84}, {rows_cubed, 0.0173}}},
      {"kkt_elimination", Phase::product, {{one, 45.4}, {rows, 3.35}, {row_packets, 0.731}, {row_singles, 0.268}}},
      {"kkt_elimination", Phase::solve, {{one, 732}, {active_bodies, 65.4}, {active_dofs, 32.7}, {rows, 9.03}, {link_rows, 1.91}, {joint_rows, 20.6}, {rows_squared, 0.871}}},
      {"kkt_elimination", Phase::product_of_eight, {{one, 73.4}, {rows, 27}, {row_packets, 5.74}, {row_singles, 2.5}}},
      {"kkt_elimination", Phase::solve_of_eight, {{one, 4.86e+03}, {active_bodies, 510}, {active_dofs, 274}, {rows, 105}, {link_rows, 30.6}, {joint_rows, 163}, {rows_squared, 6.27}}},
  };
  return table;
}

}  // namespace delassus
