// The bridge to RapidCheck, and the only file that knows it: the same laws on random specs. A failing case is shrunk to
// fewer bodies and printed as JSON. RC_PARAMS="seed=… max_success=…" chooses others than the pinned ones.
#include <rapidcheck.h>

#include <cstdlib>
#include <sstream>

#include "generators/draft.h"
#include "property_tests/allocations.h"
#include "property_tests/summary.h"

namespace rc {

template <> struct Arbitrary<delassus::generators::Spec> {
  static Gen<delassus::generators::Spec> arbitrary() {
    return gen::map(gen::pair(gen::inRange(0, 9), gen::arbitrary<std::uint64_t>()), [](const std::pair<int, std::uint64_t>& x) {
      return delassus::generators::random_spec(x.first, x.second);
    });
  }
};

}  // namespace rc

namespace {

using namespace delassus;

/// Laws on every operator; the first failure is reported with the spec.
void laws_hold(const generators::Spec& spec, laws::Summary& summary) {
  const laws::Case c = laws::make_case(spec);
  for (const OperatorRow& op : operators())
    for (const laws::Outcome& o : laws::check(op, c)) {
      summary.add(o);
      if (!o.failed()) continue;
      std::ostringstream message;
      laws::print(message, o);
      RC_FAIL(message.str() + generators::to_json(spec));
    }
}

}  // namespace

int main() {
  laws::count_allocations();
  setenv("RC_PARAMS", "seed=20240229 max_success=60", 0);
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
