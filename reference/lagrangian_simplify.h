// Shorter forms of the symbolic reference's expressions.
#pragma once

#include <utility>
#include <vector>

#include "reference/lagrangian.h"

namespace delassus::reference::lagrangian {

/// Brings polynomials in the symbols of a mechanism, and in sin and cos of whole multiples of its angles, to a short
/// form; with sin² + cos² = 1 and the unit length of quaternions used.
class Simplifier {
 public:
  explicit Simplifier(const Mechanism& mechanism);

  /// The shortest in terms of: a polynomial in sin and cos of single angles with sin² or with cos² replaced, or a sum
  /// of sines and cosines of combined angles. Zero comes out as zero. @throws std::logic_error when not a polynomial.
  [[nodiscard]] GiNaC::ex polynomial(const GiNaC::ex& e) const;
  [[nodiscard]] GiNaC::matrix polynomial(const GiNaC::matrix& x) const;
  /// Numerator and denominator without common factors, each brought to a short form; the coefficients of the
  /// denominator are whole, without common factor. The sign common to both is not fixed.
  [[nodiscard]] std::pair<GiNaC::ex, GiNaC::ex> fraction(const GiNaC::ex& e) const;

 private:
  struct Angle {
    GiNaC::symbol q, c, s, z;   // the angle; stand-ins for cos q, sin q and exp(i q)
  };
  [[nodiscard]] GiNaC::ex in_single_angles(const GiNaC::ex& e) const;
  [[nodiscard]] GiNaC::ex split(const GiNaC::ex& argument, bool sine) const;
  [[nodiscard]] GiNaC::ex reduced(const GiNaC::ex& e, bool keep_cosines) const;
  [[nodiscard]] GiNaC::ex combined(const GiNaC::ex& e) const;
  [[nodiscard]] GiNaC::ex combined(const GiNaC::ex& e, std::size_t first, const GiNaC::ex& argument, int sign) const;
  [[nodiscard]] GiNaC::ex with_functions(const GiNaC::ex& e) const;

  std::vector<Angle> angles_;
  std::vector<GiNaC::ex> unit_;         // per quaternion: w, then 1 − x² − y² − z²
  GiNaC::symbol j_{"j"};                // j² = −1
};

}  // namespace delassus::reference::lagrangian
