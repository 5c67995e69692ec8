// The only tolerance of the project: ratio = error / (eps · bound) must stay below 30, with a named bound.
//   a zero bound demands an exact zero; exact scalars (eps = 0) demand equality; NaN counts as infinity.
#pragma once

#include <string>
#include <string_view>

#include "algorithms/kit/spatial.h"
#include "algorithms/kit/test_scalars.h"

namespace delassus::laws {

inline constexpr double pass_below = 30;

struct Verdict {
  double ratio = 0;           ///< largest |error_i| / (eps · bound_i); infinity where no finite ratio exists
  std::string_view bound;     ///< what the error was measured against
  Index row = -1;             ///< where the largest ratio is; −1: nowhere
  std::string note;           ///< what went wrong when it is not a matter of size ("status lost_pivot", "allocates")

  [[nodiscard]] bool passed() const { return ratio < pass_below; }
};

/// Componentwise: max_i |error_i| / (eps · bound_i). Shapes: error m×k, bound m×1 (used for every column) or m×k.
[[nodiscard]] Verdict judge(const MatrixX<Quad>& error, const MatrixX<Quad>& bound, double eps, std::string_view name);
/// Equality: 0 when every entry of x equals that of y, infinity otherwise.
template <class T> [[nodiscard]] Verdict judge_equal(const MatrixX<T>& x, const MatrixX<T>& y);
/// Equality of bits (0.0 and −0.0 differ; NaN equals a NaN): 0 or infinity.
[[nodiscard]] Verdict judge_bits(const MatrixX<double>& x, const MatrixX<double>& y);
/// Ratio infinity with a reason.
[[nodiscard]] Verdict failure(std::string note, std::string_view bound = {});
/// The worse of two.
[[nodiscard]] Verdict worst(const Verdict& a, const Verdict& b);

}  // namespace delassus::laws
