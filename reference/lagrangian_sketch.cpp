#include "reference/lagrangian_sketch.h"

namespace delassus::reference::lagrangian {

using GiNaC::ex;
using GiNaC::matrix;
using GiNaC::symbol;

matrix point(const ex& x, const ex& y, const ex& z) { return matrix{{x}, {y}, {z}}; }

matrix identity() { return matrix{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; }

matrix about_z(const ex& angle) {
  const ex c = cos(angle), s = sin(angle);
  return matrix{{c, -s, 0}, {s, c, 0}, {0, 0, 1}};
}

matrix of_quaternion(const ex& w, const ex& x, const ex& y, const ex& z) {
  const matrix v_hat{{0, -z, y}, {z, 0, -x}, {-y, x, 0}};
  return identity().add(v_hat.mul_scalar(2 * w)).add(v_hat.mul(v_hat).mul_scalar(2));
}

matrix placed(const matrix& from, const matrix& R, const matrix& at) { return from.add(R.mul(at)); }

Sketch::Sketch(std::string name, std::string about) {
  m_.name = std::move(name);
  m_.about = std::move(about);
}

ex Sketch::parameter(const std::string& name, const std::string& meaning, const std::string& unit, double low, double high) {
  m_.parameters.push_back({symbol(name), meaning, unit, low, high});
  return m_.parameters.back().symbol;
}

ex Sketch::velocity(const std::string& name) {
  m_.nu.emplace_back(name);
  m_.armature.emplace_back(0);
  return m_.nu.back();
}

void Sketch::add_coordinate(const symbol& s, const ex& rate, const std::string& meaning, const std::string& unit) {
  m_.q.push_back({s, rate, meaning, unit});
}

ex Sketch::coordinate(const std::string& name, const std::string& meaning, const std::string& unit,
                      const std::string& armature) {
  const symbol s(name);
  add_coordinate(s, velocity("d" + name), meaning, unit);
  m_.armature.back() =
      parameter(armature, "armature of " + name, unit == "m" ? "kg" : "kg m²", 0.0625, 0.25);
  return s;
}

matrix Sketch::quaternion(const std::string& p) {
  const symbol w(p + "w"), x(p + "x"), y(p + "y"), z(p + "z");
  const ex a = velocity("w" + p + "x"), b = velocity("w" + p + "y"), c = velocity("w" + p + "z");
  m_.quaternions.push_back(static_cast<unsigned>(m_.q.size()));
  const std::string meaning = "unit quaternion, world from body axes";
  add_coordinate(w, (-x * a - y * b - z * c) / 2, meaning, "");
  add_coordinate(x, (w * a + y * c - z * b) / 2, meaning, "");
  add_coordinate(y, (w * b + z * a - x * c) / 2, meaning, "");
  add_coordinate(z, (w * c + x * b - y * a) / 2, meaning, "");
  return of_quaternion(w, x, y, z);
}

matrix Sketch::moving_point(const std::string& p, const matrix& R) {
  const ex a = velocity("v" + p + "x"), b = velocity("v" + p + "y"), c = velocity("v" + p + "z");
  const matrix along = R.mul(point(a, b, c));
  const std::vector<symbol> x{symbol(p + "x"), symbol(p + "y"), symbol(p + "z")};
  for (unsigned k = 0; k < 3; ++k) add_coordinate(x[k], along(k, 0), "position of the body frame", "m");
  return point(x[0], x[1], x[2]);
}

void Sketch::body(const ex& mass, const matrix& com, const matrix& rotation, const matrix& inertia) {
  m_.bodies.push_back({mass, com, rotation, inertia});
}

void Sketch::planar_body(const ex& mass, const matrix& com, const ex& angle, const ex& inertia_z) {
  body(mass, com, about_z(angle), matrix{{inertia_z * 3 / 4, 0, 0}, {0, inertia_z / 2, 0}, {0, 0, inertia_z}});
}

void Sketch::rows(const std::string& meaning, const matrix& phi, const matrix& axes) {
  m_.rows.push_back({meaning, phi, axes});
}

void Sketch::row(const std::string& meaning, const ex& phi) { rows(meaning, matrix{{phi}}, matrix{{1}}); }

void Sketch::show(const std::string& text, std::vector<unsigned> rows, GiNaC::exmap values, std::vector<Parameter> added) {
  m_.shown = {text, std::move(rows), std::move(values), std::move(added)};
}

}  // namespace delassus::reference::lagrangian
