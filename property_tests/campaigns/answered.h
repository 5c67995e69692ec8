// One operator's answer to one question, and the promises it must keep.
#pragma once

#include <string>

#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/known.h"
#include "property_tests/campaigns/truth.h"

namespace delassus::laws {

struct Question {
  const Case& c;
  const Truth* truth;     ///< nullptr: A is singular, there is nothing to compare with
  VectorX<double> a;      ///< m
  VectorX<Quad> lambda;   ///< A⁻¹ a; of size m unless A is singular
};

struct Answered {
  Report report;
  Errors errors;          ///< of a finite answer where there is a truth
  bool finite = false;
  std::string broken;     ///< which promise; empty: none
};

/// update and solve in double. Promised is that
///   an answer called ok or not_converged is no further off than its certificate says;
///   one called ok holds no NaN and is within the bound of its error class (none beyond the size of the dense bounds), taken
///   in units in which masses and a are about one, where it neither overflows nor underflows;
///   not_converged is never said beside a bound within 8 eps and a correction within 4, ok never beside one above √eps;
///   any other holds no numbers.
[[nodiscard]] Answered answered(const OperatorRow& row, const Question& question);

}  // namespace delassus::laws
