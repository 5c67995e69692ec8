#include "bench/table1/table1_paper.h"

#include <algorithm>
#include <stdexcept>

namespace delassus::bench {

const std::vector<PaperRow>& paper_rows() {
  static const std::vector<PaperRow> rows = {
      {"go2_standing", "Go2 standing", 4, 12, {1.55, 0.7, 26}, {3.11, 1.9, 33}, {1.64, 1.5, 29}, {3.65, 1.2, 32}, {0.369, 0.389, 1.112}, {0.027, 0.135, 0.402}},
      {"go2_standing_friction", "Go2 standing, joint friction", 4, 24, {1.61, 0.7, 28}, {4.64, 2.7, 47}, {1.63, 1.6, 32}, {5.95, 1.6, 43}, {0.399, 0.421, 1.171}, {0.052, 0.305, 1.3}},
      {"go2_fallen", "Go2 fallen", 9, 27, {1.74, 0.7, 38}, {5.89, 3.0, 62}, {2.42, 2.2, 42}, {7.63, 1.9, 56}, {0.515, 0.591, 1.911}, {0.083, 0.371, 1.671}},
      {"go2_fallen_friction", "Go2 fallen, joint friction", 10, 42, {1.77, 0.7, 45}, {8.10, 4.3, 97}, {2.44, 2.3, 49}, {12.00, 2.6, 81}, {0.567, 0.62, 1.88}, {0.147, 0.601, 3.791}},
      {"cassie", "Cassie", 8, 24, {2.94, 1.0, 53}, {9.27, 2.9, 84}, {4.26, 2.3, 69}, {10.40, 4.6, 88}, {0.77, 0.854, 3.444}, {0.052, 0.30, 1.34}},
      {"cassie_friction", "Cassie, joint friction", 8, 50, {3.07, 1.3, 57}, {16.00, 4.5, 121}, {4.51, 2.4, 72}, {21.72, 7.8, 143}, {0.805, 0.894, 3.604}, {0.20, 0.718, 5.798}},
      {"g1_standing", "G1 standing", 8, 24, {3.66, 1.3, 91}, {9.37, 5.9, 195}, {3.58, 3.1, 110}, {10.60, 11.0, 235}, {0.919, 0.906, 2.426}, {0.051, 0.297, 1.327}},
      {"g1_standing_friction", "G1 standing, joint friction", 8, 53, {3.96, 1.3, 94}, {18.53, 8.0, 254}, {3.83, 3.1, 117}, {25.00, 16.1, 334}, {1.01, 1.00, 2.7}, {0.226, 0.796, 6.486}},
      {"g1_fallen", "G1 fallen", 23, 69, {4.27, 1.0, 47}, {25.98, 2.0, 75}, {6.22, 2.4, 62}, {37.88, 3.0, 80}, {1.43, 1.46, 5.1}, {0.379, 1.08, 11.48}},
      {"g1_fallen_friction", "G1 fallen, joint friction", 25, 101, {4.41, 1.0, 50}, {42.09, 3.3, 107}, {7.33, 2.4, 65}, {70.40, 5.5, 127}, {1.45, 1.62, 6.06}, {0.89, 1.80, 29}},
      {"boxes_tower", "Stack of boxes", 120, 360, {9.47, 1.9, 241}, {1214, 52.6, 1400}, {31.38, 6.7, 269}, {2482, 110.7, 1850}, {5.22, 7.58, 30.58}, {9.51, 14.1, 1257.1}},
      {"box_pyramid", "Box pyramid", 288, 864, {14.88, 3.4, 755}, {5925, 347.5, 9694}, {65.20, 15.9, 826}, {23092, 941.6, 15530}, {10.7, 15.5, 64.7}, {94.9, 87.4, 16822.4}},
      {"pyramid_robots_collapsing", "Pyramid + Robots", 108, 324, {20.34, 6.3, 473}, {1511, 210.9, 4533}, {37.12, 17.9, 730}, {2430, 530.7, 5630}, {6.84, 8.72, 32.02}, {7.36, 12.6, 906.6}},
  };
  return rows;
}

const PaperRow& paper_row(const std::string& scene) {
  const auto& rows = paper_rows();
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const PaperRow& r) { return scene == r.scene; });
  if (found == rows.end()) throw std::out_of_range(scene + " is no row of Table I");
  return *found;
}

}  // namespace delassus::bench
