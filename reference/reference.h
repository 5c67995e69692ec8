// Independent, slow, obviously right ways to the same answers. Nothing here includes an operator's header.
#pragma once

#include <string_view>
#include <vector>

#include "algorithms/kit/test_scalars.h"
#include "algorithms/problem/problem.h"

namespace delassus::reference {

/// One row of the table of references.
struct ReferenceRow {
  std::string_view name, summary, trusted_where;
  double roundoff;          ///< unit roundoff its results carry (Quad's for the definition, double's for CHOLMOD)
  /// Whether the answer can be trusted for this problem (size, massless bodies, zero damping, …).
  bool (*trusts)(const Problem<double>&, const Damping<double>&);
  /// a = A f and f = A⁻¹ a, shapes m×k. @throws std::runtime_error when the system is singular in its arithmetic.
  MatrixX<Quad> (*apply)(const Problem<double>&, const Damping<double>&, const MatrixX<double>& f);
  MatrixX<Quad> (*solve)(const Problem<double>&, const Damping<double>&, const MatrixX<double>& a);
};

[[nodiscard]] const std::vector<ReferenceRow>& references();

}  // namespace delassus::reference
