// Contact problems as text: the plain format of Siconos' friction-contact test data, read and written.
//
//   d, number of contacts, W, q, μ per contact                         u = W λ + q, normal first, d − 1 tangents
//   d, number of contacts, M, H, q, b, μ per contact                   M v = H λ + q, u = Hᵀ v + b: read as G = Hᵀ M⁻¹H, g = HᵀM⁻¹q + b
// and in some files a last 0 or 1 (mark). Matrix: 0 rows columns rows columns, entries column by column; or blocks: 1 rows columns, number of blocks, block rows, block columns,
// last row of each block row, last column of each block column, two lengths, first block of each block row, block column of each
// block, then per block its number and entries column by column. Everything is separated by blanks.
// Written is W = G + R⁻¹, q = g − target where every group is a contact of the same number of tangents with one coefficient, as those
// others read it; after it a section `delassus 1` that readers of the format never reach, from which our own reader takes every bit of
// the problem: of any cones. Where the format has no word for the problem, its own part is that of no contacts.
// A mechanism is written as its matrix G. Cost O(m²), read and written.
#pragma once

#include <iosfwd>
#include <string>

#include "simulation/contact_problem.h"

namespace delassus::simulation {

/// A problem, and what was done to it on the way.
struct ProblemFile {
  ContactProblem<double> problem;
  double asymmetry = 0;  ///< largest |W − Wᵀ| over the largest |W|, before W was replaced by its symmetric part
  bool global = false;   ///< M and H were given
  Index mark = -1;       ///< a 0 or 1 that some files have behind the coefficients, and that says nothing of the problem; −1: none
  bool own = false;      ///< the section `delassus` was there
};

/// @throws ModelError naming file, line, and what is accepted: text that ends too early or goes on, numbers that are none, sizes that
/// do not fit, a matrix further than `most_asymmetry` from symmetric, M that is not positive definite.
[[nodiscard]] ProblemFile read_contact_problem(const std::string& text, const std::string& file, double most_asymmetry = 1e-3);
[[nodiscard]] ProblemFile load_contact_problem(const std::string& path, double most_asymmetry = 1e-3);

/// @throws ModelError where the problem cannot be right (validate).
[[nodiscard]] std::string contact_problem_text(const ContactProblem<double>& p);

/// The same with G in the place of its mechanism, symmetric to the last bit.
[[nodiscard]] ContactProblem<double> as_given_matrix(const ContactProblem<double>& p);

}  // namespace delassus::simulation
