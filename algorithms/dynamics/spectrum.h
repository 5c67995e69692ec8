// Eigenvalues of the Delassus operator Λ⁻¹ = J M⁻¹Jᵀ between bounds, by counting: no matrix, no vector, no iteration that may stall.
//
// What     How many eigenvalues of Λ⁻¹ exceed μ > 0; and the k-th largest one, in an interval as narrow as asked for.
// Formula  [ M  Jᵀ ; J  μ1 ] has the Schur complements μ1 − Λ⁻¹ of M and M − JᵀJ/μ of μ1, and as many negative eigenvalues as
//          either block with its complement. M and μ1 are positive, so
//            #{ λ(Λ⁻¹) > μ } = number of negative pivots of M − JᵀJ/μ,
//          which is the factor of M_R (factors/factor.h) with R = −1/μ. Bisection on μ; λ_max stands between the largest diagonal
//          entry and the trace, λ_min below the least diagonal entry (delassus_blocks.h).
// Cost     update as DelassusBlocks, and phase A of the factor; each count one factor with new weights, O(n + m) with localised
//          loops. A width of 1e-3 takes about 10 counts for λ_max, and for λ_min as many again as it has binary digits below.
// Error    exact where the arithmetic is. In floating point what is counted are the eigenvalues of a matrix that differs from Λ⁻¹
//          within the data's sensitivity: an interval says nothing below unit roundoff · trace, where it ends at 0.
// Source   E. V. Haynsworth 1968 (inertia of a Schur complement); bisection by inertia: W. Givens 1954, B. N. Parlett, The Symmetric
//          Eigenvalue Problem, section 3.3. Its use on M_R: this file.
#pragma once

#include <memory>

#include "algorithms/errors/status.h"
#include "algorithms/problem/problem.h"

namespace delassus {

/// Serves every ordered scalar. Threads: one each. Nothing allocates after the constructor.
template <class T> class Spectrum {
 public:
  /// lower ≤ λ ≤ upper [1/kg for rows in metres]; lower = 0: not told from zero.
  struct Interval {
    double lower = 0, upper = 0;
  };

  /// @throws ModelError for a bad structure.
  explicit Spectrum(std::shared_ptr<const Structure> structure);
  Spectrum(Spectrum&&) noexcept;
  ~Spectrum();

  /// Numbers at a configuration. Report: lost_pivot with the joint's first degree of freedom where M is singular.
  [[nodiscard]] Report update(const Problem<T>& problem);

  /// How many eigenvalues of Λ⁻¹ are larger than μ > 0. Report: lost_pivot where a pivot of M − JᵀJ/μ is zero or not finite, as
  /// where μ is an eigenvalue: take another μ. @throws std::logic_error for μ ≤ 0, or before the first update.
  [[nodiscard]] Report count_above(double mu, Index& count);

  /// The k-th largest eigenvalue, 0 ≤ k < rows, with upper ≤ (1 + width) lower, or lower = 0. Report: as that of update.
  /// @throws std::logic_error where there is no such k, for a width that is not above 0, or before the first update.
  [[nodiscard]] Report eigenvalue(Index k, double width, Interval& interval);
  [[nodiscard]] Report largest(double width, Interval& interval) { return eigenvalue(0, width, interval); }
  [[nodiscard]] Report smallest(double width, Interval& interval);

 private:
  struct Numbers;
  std::unique_ptr<Numbers> own_;
};

}  // namespace delassus
