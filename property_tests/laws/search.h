// Randomised search: laws held against specs of fresh seeds, classes of problems counted, failures shrunk.
//
//   Search s;  s.seed = 1;  s.count = 1000;  const Found f = search(s);
//
// Problem k of a search has seed `seed + k`. Shard i of n (1 ≤ i ≤ n) takes k = i − 1, i − 1 + n, …: with a fixed
// `count` the shards together check exactly the problems, laws and operators of one search alone.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "generators/spec.h"
#include "property_tests/laws/laws.h"

namespace delassus::laws {

/// A law broken, with the spec it was found on and the smallest one shrinking came to.
struct Failure {
  std::uint64_t seed = 0;
  std::string law, op, note;
  double ratio = 0;               ///< on the shrunk spec
  std::size_t found_bodies = 0;   ///< bodies before shrinking
  generators::Spec spec;          ///< shrunk
  int tried = 0;                  ///< specs tried while shrinking
};

struct Found {
  std::uint64_t seed = 0;
  int shard = 1, shards = 1;
  std::int64_t problems = 0, checks = 0, skipped = 0;
  double seconds = 0;
  std::vector<std::int64_t> classes;   ///< problems per row of generators::classes()
  std::vector<Failure> failures;       ///< by seed; one per law and operator
};

struct Search {
  std::uint64_t seed = 1;
  int shard = 1, shards = 1;
  double seconds = 60;            ///< not looked at when count > 0
  std::int64_t count = 0;         ///< problems of all shards together; 0: until the time is over
  std::size_t most_failures = 1;  ///< stops after this many pairs of law and operator
  std::vector<OperatorRow> ops = operators();
  std::string_view left_out;      ///< a law not held against them; empty: none
  std::function<void(const Found&)> progress;   ///< called about every `every` seconds
  double every = 5;
  std::function<bool()> stop;   ///< looked at before every problem
};

/// Runs until the time, the count or the failures are reached. Cost: hundreds of problems per second.
[[nodiscard]] Found search(const Search& s);

/// Whether the search holds this law against the problem of this seed: the two definitions always, the others one
/// problem in 8 each, equalities in rational numbers one in 32 of those with up to three bodies.
[[nodiscard]] bool chosen(const LawRow& law, const generators::Spec& spec);

/// Shards put together. @throws ModelError when they are not the distinct shards of one search.
[[nodiscard]] Found merged(const std::vector<Found>& shards);

/// Shrinks until no move keeps this law broken by this operator.
[[nodiscard]] Failure shrunk(const LawRow& law, const OperatorRow& op, const generators::Spec& spec);

}  // namespace delassus::laws
