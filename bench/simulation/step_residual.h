// How far a step of any program is from the scene's own law of motion: from what it tells of the step (bench/peers/simulator.h), with M, J
// and the definitions of reference/, by lines that no simulator shares.
//
//   u          = J ν⁺ + R⁻¹λ − target
//   natural    γ ‖λ − the nearest point of K to λ − ũ/γ‖, the largest of all rows              [m/s]   reference/contact_residual.h
//   approach   velocity into each other, or along a row that should hold                     [m/s]
//   cone       how far impulses are outside their cones: pulling, more friction than μ λ_n     [N s]
//   momentum   largest entry of M̂ (ν⁺ − ν) − pushed − Jᵀλ                                      [N s, N m s]
//   depth      largest penetration at the start of the step                                    [m]
// Target   of a contact or limit whose gap φ is open: −φ/h. Of one that is closed every velocity with which it separates, up to
//          gap_speed, is accepted: how fast a program takes a penetration back is its own choice, and no error.
// So a contact is at fault where it approaches, pulls, pushes from afar, slides within its cone, or slides otherwise than friction asks.
// Cost     O(n³ + n² m + m²).
#pragma once

#include "bench/peers/simulator.h"

namespace delassus::bench {

struct StepResidual {
  double natural = 0, approach = 0, cone = 0, momentum = 0, depth = 0;
};

/// `model`: bodies of the scene; its constraints do not count.
[[nodiscard]] StepResidual residual_of(const Model& model, const Stepped& step, double h);

}  // namespace delassus::bench
