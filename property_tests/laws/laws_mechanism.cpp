// Laws about other descriptions of the same mechanism: moved, re-rooted, split, welded, with rotors, cut.
#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/laws_groups.h"
#include "property_tests/laws/second.h"
#include "property_tests/laws/variants_mechanism.h"

namespace delassus::laws {
namespace {

const Case& moved(const Case& c) {
  return second_case(c, "world moved", [&](const auto& p, const auto& d) { return world_moved<double>(p, d, c.seed); });
}
const Case& other_root(const Case& c) {
  return second_case(c, "re-rooted", [&](const auto& p, const auto& d) { return rerooted<double>(p, d, c.seed); });
}
const Case& geared(const Case& c) {
  return second_case(c, "with a rotor", [&](const auto& p, const auto& d) { return with_rotor<double>(p, d, c.seed); });
}
const Case& cut(const Case& c) {
  return second_case(c, "with a joint cut", [&](const auto& p, const auto& d) { return joint_cut<double>(p, d, c.seed); });
}

/// Its factor loses a pivot on these numbers, and it says so.
bool refuses(Function f, const OperatorRow& op, const Case& c) {
  try {
    static_cast<void>(Route<double>(op, c.problem, c.damping).narrow(f, vectors<double>(c.rows(), 2, c.seed)));
  } catch (const Broken& broken) {
    return broken.status == Status::lost_pivot;
  }
  return false;
}

/// The moved numbers are not dyadic: an operator with a factor in float may lose there what few bits gave exactly.
template <class T, Function F> const char* why_not_moved(const OperatorRow& op, const Case& c) {
  if (const char* reason = why_not_second<T>(F, op, c, moved(c))) return reason;
  return !op.terminates_exactly && refuses(F, op, moved(c)) ? "its factor in float refuses the moved numbers, and says so" : nullptr;
}
template <class T, Function F> Verdict same_moved(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  return same_answer<T>(F, op, c, world_moved(p, d, c.seed), moved(c));
}

template <class T, Function F> const char* why_not_rerooted(const OperatorRow& op, const Case& c) {
  if (free_bases(c.problem).empty()) return "has no free base without armature and joint rows that carries others";
  return why_not_second<T>(F, op, c, other_root(c));
}
template <class T, Function F> Verdict same_rerooted(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  return same_answer<T>(F, op, c, rerooted(p, d, c.seed), other_root(c));
}

template <class T, Function F> const char* why_not_split(const OperatorRow& op, const Case& c) {
  if (op.maximal) return "refuses bodies without mass, which this makes";
  if (!can_split(*c.problem.structure)) return "has no joint of several freedoms without joint rows";
  return why_not<T>(F, op, c);
}
template <class T, Function F> Verdict same_split(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  return same_answer<T>(F, op, c, joints_split(p, d), c, true);
}

template <class T, Function F> Verdict same_in_two(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  return same_answer<T>(F, op, c, bodies_in_two(p, d), c, true);
}

/// The rows that a second description added.
template <class T> std::vector<Index> added(const Second<T>& second) {
  std::vector<Index> out;
  for (std::size_t r = 0; r < second.from.size(); ++r)
    if (second.from[r] < 0) out.push_back(static_cast<Index>(r));
  return out;
}

/// A' with the rows added eliminated, on vectors of the case.
template <class T>
Eliminated<T> without_added(const OperatorRow& op, const Case& c, const Second<T>& second, const Case& other) {
  const MatrixX<T> x = spread<T>(vectors<T>(c.rows(), 2, c.seed), second.from);
  return Eliminated<T>(apply, op, other, second.numbers.problem, second.numbers.damping, x, added(second));
}

/// Hard rows added: solve has them in its system with a = 0, apply needs their Schur complement.
template <class T, Function F>
Verdict same_with_hard_rows(const OperatorRow& op, const Case& c, const Second<T>& second, const Case& other) {
  if (F == solve) return same_answer<T>(F, op, c, second, other);
  const auto [p, d] = numbers<T>(c);
  const MatrixX<T> x = vectors<T>(c.rows(), 2, c.seed);
  const Eliminated<T> schur = without_added(op, c, second, other);
  const Dense<T> there = gathered<Wide<T>>(schur.value(), second.from, c.rows());
  return agree<T>(Route<T>(op, p, d)(F, x), there, bound_name(F, op), [&]() -> MatrixX<Quad> {
    if constexpr (ScalarTraits<T>::exact) return {};
    else return error_bound(F, op, c, x) + gathered<Quad>(schur.bound(), second.from, c.rows());
  });
}

template <class T, Function F>
const char* why_not_hard_rows(const OperatorRow& op, const Case& c, const Second<double>& second, const Case& other) {
  if (const char* reason = why_not_second<T>(F, op, c, other)) return reason;
  if (F == solve || ScalarTraits<T>::exact || without_added<double>(op, c, second, other).certain()) return nullptr;
  return "promises no digit: 30 eps · bound reaches the rows added";
}

template <class T, Function F> const char* why_not_rotor(const OperatorRow& op, const Case& c) {
  if (geared_joints(c.problem).empty()) return "has no joint of one freedom with armature";
  return why_not_hard_rows<T, F>(op, c, with_rotor(c.problem, c.damping, c.seed), geared(c));
}
template <class T, Function F> Verdict rotor(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  return same_with_hard_rows<T, F>(op, c, with_rotor(p, d, c.seed), geared(c));
}

template <class T, Function F> const char* why_not_cut(const OperatorRow& op, const Case& c) {
  if (joints_to_cut(c.problem).empty()) return "has no joint without armature and joint rows";
  return why_not_hard_rows<T, F>(op, c, joint_cut(c.problem, c.damping, c.seed), cut(c));
}
template <class T, Function F> Verdict joint_is_rows(const OperatorRow& op, const Case& c) {
  const auto [p, d] = numbers<T>(c);
  return same_with_hard_rows<T, F>(op, c, joint_cut(p, d, c.seed), cut(c));
}

}  // namespace

std::vector<LawRow> mechanism_laws() {
  return {
      DELASSUS_TWINS("apply moved", "S → X S, H → X⁻ᵀ H X⁻¹, K → K X⁻¹ per tree", of_apply, apply, why_not_moved, same_moved),
      DELASSUS_TWINS("solve moved", "S → X S, H → X⁻ᵀ H X⁻¹, K → K X⁻¹ per tree", of_solve, solve, why_not_moved, same_moved),
      DELASSUS_TWINS("apply re-rooted", "the free base is another body, S → −S between", of_apply, apply, why_not_rerooted, same_rerooted),
      DELASSUS_TWINS("solve re-rooted", "the free base is another body, S → −S between", of_solve, solve, why_not_rerooted, same_rerooted),
      DELASSUS_TWINS("apply with joints split", "n freedoms = n joints of one with massless links", of_apply, apply, why_not_split, same_split),
      DELASSUS_TWINS("solve with joints split", "n freedoms = n joints of one with massless links", of_solve, solve, why_not_split, same_split),
      DELASSUS_TWINS("apply with bodies in two", "a body = two halves welded", of_apply, apply, why_not_function, same_in_two),
      DELASSUS_TWINS("solve with bodies in two", "a body = two halves welded", of_solve, solve, why_not_function, same_in_two),
      DELASSUS_TWINS("apply: armature = rotor", "armature = a rotor and a hard gear row", of_apply, apply, why_not_rotor, rotor),
      DELASSUS_TWINS("solve: armature = rotor", "armature = a rotor and a hard gear row", of_solve, solve, why_not_rotor, rotor),
      DELASSUS_TWINS("apply: joint = hard rows", "a joint = a free body and hard rows N, N S = 0", of_apply, apply, why_not_cut, joint_is_rows),
      DELASSUS_TWINS("solve: joint = hard rows", "a joint = a free body and hard rows N, N S = 0", of_solve, solve, why_not_cut, joint_is_rows),
  };
}

}  // namespace delassus::laws
