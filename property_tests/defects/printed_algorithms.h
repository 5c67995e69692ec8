// The paper's Algorithms 2 and 4 and its two merged sweeps, transcribed line by line, with each line either as printed or
// corrected. Not an implementation to use: dense maps, natural order. It exists to show, in exact
// arithmetic, which printed lines are wrong (docs/paper_notes.md).
//
// Conventions of the correction: f is a bias force (u = τ − Sᵀf, as printed in line 13), H_ij = Σ K_iᵀ R K_j (line 9 as
// printed), the ground is dropped from every set of links.
#pragma once

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "algorithms/problem/problem.h"

namespace delassus::paper {

/// A line taken as printed; all others corrected.
enum class Printed : int {
  none,
  alg2_no_armature,      ///< Alg. 2, line 4: D_i without A_i
  merged_apply_sign,     ///< section IV-D: f_i started at +Kᵀλ
  line_9_transposed,     ///< line 9 read as Σ K_jᵀ R K_i
  line_11_assigned,      ///< line 11: D_i ← 𝒦ᵢᵀR𝒦ᵢ, an assignment: of several constraints on a joint only the last counts
  line_14_no_armature,   ///< line 14: D_i without A_i
  line_22_right_factor,  ///< H_πj += H_ij Pᵀ
  line_22_one_sided,     ///< H_jπ not updated with H_πj
  line_23_transposed,    ///< f_j += H_ij S D⁻¹ u
  line_24_transposed,    ///< H_jj −= H_ij S D⁻¹ Sᵀ H_ij
  line_26_transposed,    ///< H_kj −= H_ik S D⁻¹ Sᵀ H_ij
  line_29_transposed,    ///< H_ππ += (H_iπ Pᵀ)ᵀ
  line_31_sign,          ///< f_π += f_i − U D⁻¹ u
  line_35_subspace,      ///< u_i −= (H_ij S_j)ᵀ a_j (not defined when n_i ≠ n_j)
  line_35_transposed,    ///< u_i −= (H_ij S_i)ᵀ a_j
  merged_solve_sign,     ///< section V-D: f_i started at +Kᵀ R a
  count
};

struct Line {
  Printed id;
  const char* name;      ///< of the defect it makes
  const char* where;
  const char* printed;
  const char* correct;
};
inline constexpr Line lines[] = {
    {Printed::alg2_no_armature, "paper_algorithm_2_line_4", "Alg. 2, line 4", "D = SᵀU", "D = A + SᵀU"},
    {Printed::merged_apply_sign, "paper_section_4d_sign", "section IV-D", "f started at +Kᵀλ", "f started at −Kᵀλ"},
    {Printed::line_9_transposed, "paper_line_9", "Alg. 4, line 9, read as in 22, 23, 29", "H_ij += K_jᵀ R K_i", "H_ij += K_iᵀ R K_j"},
    {Printed::line_11_assigned, "paper_line_11", "Alg. 4, line 11", "D ← 𝒦ᵀR𝒦", "D += 𝒦ᵀR𝒦, for each of them"},
    {Printed::line_14_no_armature, "paper_line_14", "Alg. 4, line 14", "D starts at 𝒦ᵀR𝒦", "D starts at A + 𝒦ᵀR𝒦"},
    {Printed::line_22_right_factor, "paper_line_22_factor", "Alg. 4, line 22", "H_πj += H_ij Pᵀ", "H_πj += P H_ij"},
    {Printed::line_22_one_sided, "paper_line_22_one_sided", "Alg. 4, line 22", "H_jπ left as it was", "H_jπ ← H_πjᵀ"},
    {Printed::line_23_transposed, "paper_line_23", "Alg. 4, line 23", "f_j += H_ij S D⁻¹u", "f_j += H_ji S D⁻¹u"},
    {Printed::line_24_transposed, "paper_line_24", "Alg. 4, line 24", "H_jj −= H_ij S D⁻¹Sᵀ H_ij", "H_jj −= H_ji S D⁻¹Sᵀ H_ij"},
    {Printed::line_26_transposed, "paper_line_26", "Alg. 4, line 26", "H_kj −= H_ik S D⁻¹Sᵀ H_ij", "H_kj −= H_ki S D⁻¹Sᵀ H_ij"},
    {Printed::line_29_transposed, "paper_line_29", "Alg. 4, line 29", "H_ππ += (H_iπ Pᵀ)ᵀ", "H_ππ += (P H_iπ)ᵀ"},
    {Printed::line_31_sign, "paper_line_31", "Alg. 4, line 31", "f_π += f_i − U D⁻¹u", "f_π += f_i + U D⁻¹u"},
    {Printed::line_35_subspace, "paper_line_35_subspace", "Alg. 4, line 35", "u_i −= (H_ij S_j)ᵀ a_j", "u_i −= (H_ji S_i)ᵀ a_j"},
    {Printed::line_35_transposed, "paper_line_35_transposed", "Alg. 4, line 35", "u_i −= (H_ij S_i)ᵀ a_j", "u_i −= (H_ji S_i)ᵀ a_j"},
    {Printed::merged_solve_sign, "paper_section_5d_sign", "section V-D", "f started at +KᵀRa", "f started at −KᵀRa"},
};

/// Lines taken as printed.
using Lines = unsigned;
[[nodiscard]] constexpr Lines only(Printed line) { return line == Printed::none ? 0u : 1u << static_cast<unsigned>(line); }
/// Algorithm 4 as it stands: line 9 read as printed, and of the two readings of line 35 the literal one.
inline constexpr Lines algorithm_4 = only(Printed::line_11_assigned) | only(Printed::line_14_no_armature) |
    only(Printed::line_22_right_factor) | only(Printed::line_22_one_sided) | only(Printed::line_23_transposed) |
    only(Printed::line_24_transposed) | only(Printed::line_26_transposed) | only(Printed::line_29_transposed) |
    only(Printed::line_31_sign) | only(Printed::line_35_subspace) | only(Printed::merged_solve_sign);
/// Algorithms 1 to 3 are concerned by the first two lines only, Algorithm 4 by the others.
[[nodiscard]] constexpr bool of_apply(Printed line) { return line == Printed::alg2_no_armature || line == Printed::merged_apply_sign; }

/// Transcription for one problem. T must be exact for the comparison to mean anything.
template <class T> class Transcription {
 public:
  /// R: m × m, block diagonal; not used by apply.
  Transcription(const Problem<T>& problem, MatrixX<T> R, Lines printed)
      : p_(problem), s_(*problem.structure), R_(std::move(R)), printed_(printed) {}

  // Both return an empty vector when a pivot vanishes or a printed line is not defined.
  /// J M⁻¹ Jᵀ λ by Algorithms 1–3 merged (section IV-D).
  VectorX<T> apply(const VectorX<T>& lambda);
  /// Λ_R a by Algorithm 4 merged (section V-D).
  VectorX<T> solve(const VectorX<T>& a);

 private:
  using Pair = std::pair<Index, Index>;
  using Matrix = MatrixX<T>;

  [[nodiscard]] bool is(Printed line) const { return (printed_ & only(line)) != 0; }
  [[nodiscard]] Matrix S(Index i) const;
  [[nodiscard]] Matrix joint_K(const Structure::JointConstraint& j) const;
  [[nodiscard]] Matrix K(const Structure::LinkConstraint& e, const Structure::Attachment& link) const;
  [[nodiscard]] Matrix R(Index row, Index rows) const { return R_.block(row, row, rows, rows); }
  Matrix& H(Index i, Index j) { return H_.try_emplace({i, j}, Matrix::Zero(6, 6)).first->second; }

  void start(const VectorX<T>& lambda, bool wrong_sign);  // Alg. 1 merged: f, τ
  void couple();                                          // Alg. 4, lines 2–9
  void joint_weights();                                   // Alg. 4, lines 10–11
  bool eliminate(Index i);                                // Alg. 4, lines 13–32; false: a pivot vanished
  void fill(Index i);                                     // lines 16–20
  bool backward();
  VectorX<T> forward();                                   // lines 33–37 and Alg. 3, lines 4–8

  const Problem<T>& p_;
  const Structure& s_;
  MatrixX<T> R_;
  Lines printed_;
  std::map<Pair, Matrix> H_;
  std::vector<std::set<Index>> N_;
  std::vector<Matrix> f_, u_, U_, D_, a_;
};

}  // namespace delassus::paper
