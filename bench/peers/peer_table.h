// Peers and ours in one run: the same robots, rows, damping and vector; compared before timed, timed in turn (interleaved.h).
//
// Compared, all of it before anything is timed: M, by its relative error; A x and A⁻¹x by every step that gives one and at both dampings.
// An answer must be thirty times nearer to the reference than the answer to R⁻¹ half as large again is: so the problem is the same to
// two parts in a hundred of its damping, and what rounding may take is no fixed number, since some formulas lose digits with every
// decade of R λmax(J M⁻¹Jᵀ). Ours are held to the same. References: those of Table I (definition in Quad, accuracy_truth.h).
// What each step begins and ends with: bench/peers/peer.h.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>

#include "bench/peers/beside.h"
#include "bench/interleaved.h"
#include "bench/peers/peer.h"

namespace delassus::bench {

inline constexpr double M_limit = 0x1p-26;  ///< half of double's digits: no factor and no damping in it
inline constexpr const char* certified_default = "ladder";  ///< timed besides the operators that the peers name

/// One peer, or one of our operators, on one scene.
struct PeerEntry {
  std::string name, program, what, product, solve;  ///< as in PeerRow; program empty: ours
  bool from_q = false;
  std::string cannot;      ///< why it cannot express the scene; empty: it can
  std::string disagrees;   ///< what differs and by how much; then there are no times. Empty: nothing does
  bool loses_digits = false;  ///< then: it solves our problem, but its answer moves as far as it is off when q moves by its last bit
  double M_error = NAN, product_error = NAN, force_error = NAN;  ///< |δM_ij|/√(M_ii M_jj), max|δa|/max|a|, max|δλ|/max|λ|: the largest of all steps
  std::array<Spread, step_count> time;                           ///< [µs]; not measured: it has no such step

  [[nodiscard]] const Spread& of(Step s) const { return time[static_cast<std::size_t>(s)]; }
  [[nodiscard]] bool ours() const { return program.empty(); }
};

struct PeerScene {
  std::string scene;
  std::int64_t dofs = 0, rows = 0;
  bool loops = false;
  double smallest_damping = 0, largest_damping = 0;  ///< of R⁻¹ [1/kg]
  double product_limit = NAN, force_limit = NAN;     ///< of the relative errors
  std::vector<PeerEntry> entries;

  [[nodiscard]] const PeerEntry* find(const std::string& name) const;
  /// Time of a peer over that of an operator of ours for the same: both with kinematics where the peer begins at q. NaN: one has none.
  [[nodiscard]] double ratio(const PeerEntry& peer, Step step, const std::string& ours) const;
};

struct PeerTable : Beside {
  std::vector<PeerScene> scenes;

  [[nodiscard]] int disagreements() const;  ///< those that only lose digits left out
};

/// @throws ModelError where `rows` is empty: what can be installed.
void check_found(const std::vector<PeerRow>& rows);
[[nodiscard]] std::vector<std::string> peer_scenes();

/// `scene.damping` must not be zero on any row.
[[nodiscard]] PeerScene measure_peers(const Scene& scene, const std::vector<PeerRow>& rows, double budget);
/// `progress` is called with a line of text per scene, `stop` is asked before every one.
[[nodiscard]] PeerTable measure_peers(const std::vector<std::string>& scenes, const std::vector<PeerRow>& rows, double budget,
                                      const std::function<void(const std::string&)>& progress, const std::function<bool()>& stop);

void to_json(nlohmann::json& j, const PeerTable& t);
/// @throws nlohmann::json::exception for anything else than to_json wrote.
void from_json(const nlohmann::json& j, PeerTable& t);
/// Tables in Markdown: ratios and where a peer is faster, times, errors, what was left out.
[[nodiscard]] std::string peer_text(const PeerTable& t);

}  // namespace delassus::bench
