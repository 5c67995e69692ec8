// The bridge to RapidCheck, and the only file that knows it: the same laws on random specs. RapidCheck draws the seed
// of a spec; a failing spec is shrunk by the structural moves of generators/shrink.h and printed as JSON.
// RC_PARAMS="seed=… max_success=…" chooses others than the pinned ones.
#include <rapidcheck.h>

#include <cstdlib>
#include <sstream>

#include "generators/arbitrary.h"
#include "generators/shrink.h"
#include "property_tests/unit/allocations.h"
#include "property_tests/laws/search.h"
#include "property_tests/laws/summary.h"

namespace delassus::generators {

static std::ostream& operator<<(std::ostream& out, const Spec& spec) { return out << to_json(spec); }

}  // namespace delassus::generators

namespace rc {

using delassus::generators::Spec;

/// What a spec is one move away from, made when asked for.
Seq<Spec> simpler(const Spec& spec) {
  return seq::mapMaybe(seq::fromContainer(delassus::generators::moves(spec)), [spec](const delassus::generators::Move& move) {
    auto next = delassus::generators::moved(spec, move);
    return next ? Maybe<Spec>(std::move(*next)) : Maybe<Spec>(Nothing);
  });
}

template <> struct Arbitrary<Spec> {
  static Gen<Spec> arbitrary() {
    return gen::shrink(gen::map(gen::noShrink(gen::resize(kNominalSize, gen::arbitrary<std::uint64_t>())),
                                [](std::uint64_t seed) { return delassus::generators::arbitrary(seed); }),
                       [](const Spec& spec) { return simpler(spec); });
  }
};

}  // namespace rc

namespace {

using namespace delassus;

/// Laws on every operator; the first failure is reported with the spec.
void laws_hold(const generators::Spec& spec, laws::Summary& summary) {
  const laws::Case c = laws::make_case(spec);
  for (const OperatorRow& op : operators())
    for (const laws::LawRow& law : laws::laws()) {
      if (!laws::chosen(law, spec)) continue;
      const laws::Outcome o = laws::check(law, op, c);
      summary.add(o);
      if (!o.failed()) continue;
      std::ostringstream message;
      laws::print(message, o);
      RC_FAIL(message.str());
    }
}

}  // namespace

int main() {
  laws::count_allocations();
  setenv("RC_PARAMS", "seed=20240229 max_success=100", 0);
  laws::Summary summary;
  const bool ok = rc::check("every law on random specs", [&] {
    const auto spec = *rc::gen::arbitrary<generators::Spec>().as("spec");
    laws_hold(spec, summary);
  });
  std::ostringstream table;
  summary.print(table, 0);
  std::puts(table.str().c_str());
  return ok ? EXIT_SUCCESS : EXIT_FAILURE;
}
