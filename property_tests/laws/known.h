// What the references say about a case: computed once, when first asked for, and shared by every operator and law.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <type_traits>

#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/laws.h"
#include "property_tests/laws/variants.h"
#include "reference/sensitivity.h"

namespace delassus::laws {

/// Apply or solve.
enum class Function : std::uint8_t { apply, solve };

template <class To, class From> [[nodiscard]] MatrixX<To> converted(const MatrixX<From>& x) {
  MatrixX<To> y(x.rows(), x.cols());
  for (Index c = 0; c < x.cols(); ++c)
    for (Index r = 0; r < x.rows(); ++r) y(r, c) = scalar_cast<To>(x(r, c));
  return y;
}

/// The numbers an operator is given: those of the case, or their rounding.
enum class Data : std::uint8_t { given, rounded };

struct Known {
  Data data = Data::given;   ///< rounded: a variant whose numbers are not exactly those it stands for
  bool tried = false;
  std::optional<reference::Sensitivity> sensitivity;
  std::string no_sensitivity;
  std::optional<MatrixX<Quad>> A, A_inverse;
  std::optional<bool> damped, dependent_to_rounding;
  std::optional<reference::Dense<Rational>> exact;
  std::optional<MatrixX<Rational>> exact_A, exact_inverse;
  std::optional<bool> exactly_regular;
  std::map<std::string, Case> variants;
  std::map<std::string, std::optional<MatrixX<Quad>>> answers;  ///< of references, by name and question
};

/// Reason why there is no bound for this function on this case (size, M or A singular); nullptr: there is one.
[[nodiscard]] const char* why_no_bound(Function f, const Case& c);
/// Some hard row depends on others as far as the rounding of its numbers can tell, by hard_rows.h's size in Quad: regular in
/// rational numbers it may be all the same.
[[nodiscard]] bool dependent_to_rounding(const Case& c);
/// κ_∞(A). Needs why_no_bound(solve) == nullptr.
[[nodiscard]] double condition(const Case& c);
/// ‖|M⁻¹||M|‖: how many times larger than in the entries of M an error of M⁻¹ may be. Needs why_no_bound(apply) == nullptr.
[[nodiscard]] Quad condition_of_M(const Case& c);
/// max R_rr (J M⁻¹Jᵀ)_rr: how much larger than its answer the terms of the inversion lemma are. 0 where R⁻¹ is singular.
[[nodiscard]] double stiffness(const Case& c);
/// ‖apply_sensitivity‖ / ‖A‖: how much less accurate a product A f is than one by the explicit matrix. Same need.
[[nodiscard]] double product_condition(const Case& c);
/// A is regular, decided in rational numbers.
[[nodiscard]] bool exactly_regular(const Case& c);
/// Every row has R⁻¹ > 0 (blocks positive definite).
[[nodiscard]] bool damped(const Case& c);
/// A and A⁻¹ by the definition in Quad or Rational. Shapes m×m. @throws std::runtime_error when singular.
template <class T> [[nodiscard]] const MatrixX<Wide<T>>& definition(Function f, const Case& c);
/// M, J and what follows from them in Quad. Needs why_no_bound(apply) == nullptr.
[[nodiscard]] const reference::Dense<Quad>& matrices(const Case& c);
/// Bound on the error of f(x) by an operator of this row, per unit roundoff. Shapes m×k.
[[nodiscard]] MatrixX<Quad> error_bound(Function f, const OperatorRow& op, const Case& c, const MatrixX<double>& x,
                                        Data data = Data::given);
/// The name of that bound.
[[nodiscard]] std::string_view bound_name(Function f, const OperatorRow& op, Data data = Data::given);

/// Another case that follows from this one; made once. `data`: whether its numbers are exact.
[[nodiscard]] const Case& variant(const Case& c, const std::string& name,
                                  const std::function<Variant<double>(const Case&)>& make, Data data = Data::rounded);
/// Answer of a reference for the vectors `x` (the same ones at every call with this name); nullopt: it does not trust
/// itself here.
[[nodiscard]] const std::optional<MatrixX<Quad>>& answer(Function f, std::string_view reference, const Case& c,
                                                        const MatrixX<double>& x);
/// R⁻¹ as m×m matrix.
template <class T> [[nodiscard]] MatrixX<Wide<T>> damping_of(const Structure& s, const Damping<T>& d);

}  // namespace delassus::laws
