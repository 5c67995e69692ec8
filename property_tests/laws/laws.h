// The table of laws: for every operator, on every case, every law that applies holds.
//
//   for (const Outcome& o : check(find_operator("lcaba"), make_case("chain", 8, 1))) …
#pragma once

#include <memory>
#include <vector>

#include "algorithms/delassus.h"
#include "generators/families.h"
#include "property_tests/laws/verdict.h"

namespace delassus::laws {

struct Known;  // what the references say about a case, computed when first asked for

/// One problem to hold laws against. Copies share what is already known of it; not for several threads at once.
struct Case {
  Problem<double> problem;
  Damping<double> damping;
  std::string label;          ///< "family n=8 seed=1", or the name of a scene
  std::uint64_t seed = 0;     ///< of the vectors the laws draw
  bool exact = false;         ///< small enough for exact arithmetic
  std::shared_ptr<Known> known;

  [[nodiscard]] Index rows() const { return problem.structure->rows; }
};

[[nodiscard]] Case make_case(Problem<double> problem, Damping<double> damping, std::string label, std::uint64_t seed,
                             bool exact = false);
[[nodiscard]] Case make_case(const generators::Spec& spec);
/// @throws ModelError listing the families when there is no such one.
[[nodiscard]] Case make_case(std::string_view family, Index n, std::uint64_t seed);

struct LawRow {
  std::string_view name;
  std::string_view identity;                                       ///< "route A = route B"
  std::string_view bound;                                          ///< what its error is measured against
  const char* (*why_not)(const OperatorRow&, const Case&);         ///< nullptr: the law applies
  Verdict (*check)(const OperatorRow&, const Case&);
};

[[nodiscard]] const std::vector<LawRow>& laws();
/// @throws ModelError listing the accepted names.
[[nodiscard]] const LawRow& find_law(std::string_view name);

struct Outcome {
  std::string_view law, op;
  std::string label;
  const char* skipped = nullptr;   ///< reason; nullptr: it was checked
  Verdict verdict;

  [[nodiscard]] bool passed() const { return !skipped && verdict.passed(); }
  [[nodiscard]] bool failed() const { return !skipped && !verdict.passed(); }
};

/// Every law of the table, in its order. Exceptions of an operator become failures.
[[nodiscard]] std::vector<Outcome> check(const OperatorRow& op, const Case& c);
[[nodiscard]] Outcome check(const LawRow& law, const OperatorRow& op, const Case& c);

/// Allocation counter of the program; nullptr unless it replaces operator new (the test program does, the CLI need not:
/// the law "no allocation" then says why it does not apply).
extern std::int64_t (*allocation_count)();

}  // namespace delassus::laws
