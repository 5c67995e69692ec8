// Words the mechanisms of the symbolic reference are described with: parameters, coordinates, points, rotations.
#pragma once

#include <string>
#include <vector>

#include "reference/lagrangian.h"

namespace delassus::reference::lagrangian {

/// 3×1.
[[nodiscard]] GiNaC::matrix point(const GiNaC::ex& x, const GiNaC::ex& y, const GiNaC::ex& z);
/// 3×3.
[[nodiscard]] GiNaC::matrix identity();
/// Rotation by `angle` about z.
[[nodiscard]] GiNaC::matrix about_z(const GiNaC::ex& angle);
/// Rotation of a unit quaternion, polynomial: 1 + 2 w v̂ + 2 v̂².
[[nodiscard]] GiNaC::matrix of_quaternion(const GiNaC::ex& w, const GiNaC::ex& x, const GiNaC::ex& y, const GiNaC::ex& z);
/// from + R at.
[[nodiscard]] GiNaC::matrix placed(const GiNaC::matrix& from, const GiNaC::matrix& R, const GiNaC::matrix& at);

/// A mechanism under construction.
class Sketch {
 public:
  Sketch(std::string name, std::string about);

  /// A constant, drawn from [low, high] in tests.
  GiNaC::ex parameter(const std::string& symbol, const std::string& meaning, const std::string& unit, double low, double high);
  GiNaC::ex mass(const std::string& symbol, const std::string& of) { return parameter(symbol, "mass of " + of, "kg", 0.5, 2); }
  GiNaC::ex length(const std::string& symbol, const std::string& meaning) { return parameter(symbol, meaning, "m", 0.25, 1); }
  GiNaC::ex inertia(const std::string& symbol, const std::string& meaning) {
    return parameter(symbol, meaning, "kg m²", 0.125, 0.1875);
  }
  /// A coordinate that is its own velocity, with an armature.
  GiNaC::ex coordinate(const std::string& symbol, const std::string& meaning, const std::string& unit,
                       const std::string& armature);
  /// ω in body axes and the unit quaternion w x y z (named p + "w", …) it turns: q̇ = ½ q ∘ (0, ω). Returns R.
  GiNaC::matrix quaternion(const std::string& p);
  /// v of a point in the axes of R, and the three coordinates (named p + "x", …) it moves. Returns the point.
  GiNaC::matrix moving_point(const std::string& p, const GiNaC::matrix& R);

  void body(const GiNaC::ex& mass, const GiNaC::matrix& com, const GiNaC::matrix& rotation, const GiNaC::matrix& inertia);
  /// A body that moves in the plane z = 0. Its moments about x and y, ¾ and ½ of the one about z, never enter M.
  void planar_body(const GiNaC::ex& mass, const GiNaC::matrix& com, const GiNaC::ex& angle, const GiNaC::ex& inertia_z);
  /// Rows φ taken in axes (k×k).
  void rows(const std::string& meaning, const GiNaC::matrix& phi, const GiNaC::matrix& axes);
  /// One row.
  void row(const std::string& meaning, const GiNaC::ex& phi);

  /// What the document shows: rows by number, and the values put in.
  void show(const std::string& text, std::vector<unsigned> rows, GiNaC::exmap values = {},
            std::vector<Parameter> added = {});
  [[nodiscard]] Mechanism take() { return std::move(m_); }
  [[nodiscard]] const GiNaC::ex& armature(std::size_t k) const { return m_.armature[k]; }

 private:
  GiNaC::ex velocity(const std::string& symbol);
  void add_coordinate(const GiNaC::symbol& s, const GiNaC::ex& rate, const std::string& meaning, const std::string& unit);
  Mechanism m_;
};

}  // namespace delassus::reference::lagrangian
