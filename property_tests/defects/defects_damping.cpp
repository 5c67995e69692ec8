// Defects in which R⁻¹ is misread, repaired in silence, or stale.
#include "property_tests/defects/defects_wrong.h"

namespace delassus::laws {
namespace {

/// Calls f(entry) for R⁻¹ of every row without a block, and f(diagonal entry) of the blocks.
template <class D, class F> void diagonal_entries(D& d, F f) {
  std::vector<bool> in_block(d.d.diagonal.size(), false);
  for (auto& b : d.d.blocks)
    for (Index r = 0; r < b.R_inverse.rows(); ++r) {
      f(b.R_inverse(r, r));
      in_block[static_cast<std::size_t>(b.row + r)] = true;
    }
  for (std::size_t r = 0; r < in_block.size(); ++r)
    if (!in_block[r]) f(d.d.diagonal[r]);
}

/// Calls f(entry) for the entries of the blocks beside their diagonals.
template <class D, class F> void off_diagonal_entries(D& d, F f) {
  for (auto& b : d.d.blocks)
    for (Index r = 0; r < b.R_inverse.rows(); ++r)
      for (Index c = 0; c < b.R_inverse.cols(); ++c)
        if (r != c) f(b.R_inverse(r, c));
}

}  // namespace

std::vector<DefectRow> damping_defects() {
  constexpr Place in = Place::damping;
  return {
      defect<in>("damping_forgotten", "R⁻¹ = 0", [](auto d) {
        std::fill(d.d.diagonal.begin(), d.d.diagonal.end(), 0);
        for (auto& b : d.d.blocks) b.R_inverse.setZero();
      }),
      defect<in>("damping_inverted", "R in place of R⁻¹", [](auto d) {
        using T = scalar_of<decltype(d)>;
        diagonal_entries(d, [](T& x) { if (!(x == T(0))) x = T(1) / x; });
      }),
      defect<in>("damping_of_next_row", "R⁻¹ on the next row", [](auto d) {
        if (d.d.blocks.empty() && !d.d.diagonal.empty()) std::rotate(d.d.diagonal.begin(), d.d.diagonal.end() - 1, d.d.diagonal.end());
      }),
      defect<in>("damping_plus_1e-8", "R⁻¹ + 1e-8 1/kg, in silence", [](auto d) {
        using T = scalar_of<decltype(d)>;
        diagonal_entries(d, [](T& x) { x += T(0x1p-27); });
      }),
      defect<in>("hard_rows_softened", "R⁻¹ = 1e-6 1/kg in place of 0, in silence", [](auto d) {
        using T = scalar_of<decltype(d)>;
        diagonal_entries(d, [](T& x) { if (x == T(0)) x = T(0x1p-20); });
      }),
      defect<in>("small_damping_clamped", "R⁻¹ of at least 1e-3 1/kg, in silence", [](auto d) {
        using T = scalar_of<decltype(d)>;
        diagonal_entries(d, [](T& x) { if (x < T(0x1p-10) && !(x == T(0))) x = T(0x1p-10); });
      }),
      defect<in>("block_as_diagonal", "of a block of R⁻¹ its diagonal", [](auto d) {
        using T = scalar_of<decltype(d)>;
        off_diagonal_entries(d, [](T& x) { x = T(0); });
      }),
      defect<in>("block_sign", "a block of R⁻¹ with −1 times its entries beside the diagonal", [](auto d) {
        using T = scalar_of<decltype(d)>;
        off_diagonal_entries(d, [](T& x) { x = T(-x); });
      }),
      defect<in>("update_damping_ignored", "update_damping changes nothing", [](auto d) { if (d.alone) d.d = d.before; }),
      defect<in>("last_row_stale", "update_damping leaves the last row and the last block as they were", [](auto d) {
        if (!d.alone || d.d.diagonal.empty()) return;
        d.d.diagonal.back() = d.before.diagonal.back();
        if (!d.d.blocks.empty() && d.d.blocks.size() == d.before.blocks.size()) d.d.blocks.back() = d.before.blocks.back();
      }),
      defect<in>("first_row_stale", "update_damping leaves the first row and the first block as they were", [](auto d) {
        if (!d.alone || d.d.diagonal.empty()) return;
        d.d.diagonal.front() = d.before.diagonal.front();
        if (!d.d.blocks.empty() && d.d.blocks.size() == d.before.blocks.size()) d.d.blocks.front() = d.before.blocks.front();
      }),
      defect<in>("update_damping_adds", "update_damping adds to the damping before", [](auto d) {
        for (std::size_t r = 0; d.alone && r < d.d.diagonal.size(); ++r) d.d.diagonal[r] += d.before.diagonal[r];
      }),
  };
}

}  // namespace delassus::laws
