// The table of operators: a row is tested, benchmarked, listed and documented.
#pragma once

#include <memory>
#include <string_view>
#include <tuple>
#include <vector>

#include "algorithms/kit/scalars.h"
#include "algorithms/operators/operator.h"

namespace delassus {

/// How the rounding error of a function grows; the laws pick their bound from it (docs/verification.md).
enum class ErrorClass : std::uint8_t {
  componentwise,  ///< forward error within the data's own componentwise sensitivity
  normwise,       ///< forward error within κ(A) · eps
  refined,        ///< componentwise, or eps of the largest entry and eps in the energy norm, whichever is larger
  amplified,      ///< solve: forward error R·λmax(Λ⁻¹) larger, the direct inversion-lemma formula; apply: mobilities of single bodies,
                  ///< which cancel in A
};
[[nodiscard]] std::string_view name(ErrorClass e);

template <class T> using Maker = std::unique_ptr<Operator<T>> (*)();

/// How what an operator holds grows with bodies n and rows m. Tests of thousands of bodies take fewer for what is dense.
enum class Holds : std::uint8_t {
  sparse,        ///< O(n + m) where loops are local
  rows_squared,  ///< a dense matrix of m rows, and O(m³) operations
  all_squared,   ///< also one of n degrees of freedom, and O(n³)
};

/// One row of the table of operators.
struct OperatorRow {
  std::string_view name, summary, formula, source, cost;
  bool applies, solves;
  bool zero_damping;          ///< solve is defined when rows of R⁻¹ are zero (and A is regular)
  bool terminates_exactly;    ///< exact in exact arithmetic
  bool decides_rank = false;  ///< solves a singular A too when a is in its range, and names the dependent rows
  ErrorClass apply_error, solve_error;
  bool maximal = false;       ///< iterates on all six motions of every body: refuses a body whose H is singular (lost_pivot), and may
                              ///< give up where κ of that system is beyond 1/√eps, whatever κ(A) is
  bool grows = false;         ///< allocates when it first needs a part of itself; never again
  double factor_eps = 0x1p-53;  ///< unit roundoff of the arithmetic its factor runs in: where 1/κ(A) is not far above it,
                                ///< the operator may give up, and says so
  Holds holds = Holds::sparse;
  std::tuple<Maker<double>, Maker<float>, Maker<Quad>, Maker<Counted>, Maker<Rational>,
             Maker<PrimeField>>
      makers;  ///< nullptr where a scalar is not served

  /// @throws std::logic_error where the scalar is not served.
  template <class T> [[nodiscard]] std::unique_ptr<Operator<T>> make() const {
    require(std::get<Maker<T>>(makers) != nullptr, "OperatorRow::make: this operator does not serve this scalar (delassus list operators)");
    return std::get<Maker<T>>(makers)();
  }
};

[[nodiscard]] const std::vector<OperatorRow>& operators();
/// @throws ModelError listing the accepted names.
[[nodiscard]] const OperatorRow& find_operator(std::string_view name);

}  // namespace delassus
