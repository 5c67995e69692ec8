// The table of effects: a row is listed, planned, stepped, priced, tested and documented. What a scene does not call for is not in a
// plan (plan.h), so a row costs scenes without it nothing.
#pragma once

#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "models/scene.h"

namespace delassus {
struct Counted;
}  // namespace delassus

namespace delassus::simulation {

template <class T> class Plan;
template <class T> using Adder = void (*)(Plan<T>& plan, const Scene& scene);

/// Whether a scene calls for an effect, by which line, or why not.
struct Call {
  bool called = false;
  std::string why;
};

/// What it does to the energy of the scene.
enum class Energy : std::uint8_t { conserves, dissipates, injects, neither };
[[nodiscard]] std::string_view name(Energy e);

struct EffectRow {
  std::string_view name, summary;
  std::string_view called_by;  ///< the key, value, geometry or state that calls for it
  Energy energy;
  Call (*call)(const Scene& scene);
  std::string_view needs;              ///< the effect without which it has nothing to act on; empty: none
  bool (*holds)(const Constraint& c);  ///< the constraints that it brings as equations; nullptr: none
  std::tuple<Adder<double>, Adder<Counted>> adders;  ///< its terms; nullptr: none beside its equations
};

[[nodiscard]] const std::vector<EffectRow>& effects();
/// @throws ModelError listing the accepted names.
[[nodiscard]] const EffectRow& find_effect(std::string_view name, const std::vector<EffectRow>& table = effects());

}  // namespace delassus::simulation
