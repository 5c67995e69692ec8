// The mechanisms of the symbolic reference with random numbers, shared by its tests.
#pragma once

#include <memory>
#include <random>
#include <vector>

#include "property_tests/unit/mechanism/lagrangian_models.h"
#include "reference/lagrangian.h"

namespace delassus::unit {

namespace lagrangian = reference::lagrangian;
using Vector = VectorX<double>;

/// A mechanism with its derivatives, taken once.
struct Known {
  const lagrangian::Mechanism& mechanism;
  lagrangian::Derived derived;
};
inline const Known& known(std::size_t k) {
  static std::vector<std::unique_ptr<Known>> all(lagrangian::mechanisms().size());
  const lagrangian::Mechanism& m = lagrangian::mechanisms()[k];
  if (!all[k]) all[k] = std::make_unique<Known>(Known{m, lagrangian::derive(m)});
  return *all[k];
}

/// Numbers of few bits: halves, quarters and so on of them stay exact.
class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double between(double low, double high) { return low + (high - low) * static_cast<double>(engine_() % 257) / 256; }
  Vector vector(Index n, double low, double high) {
    Vector x(n);
    for (Index i = 0; i < n; ++i) x[i] = between(low, high);
    return x;
  }

 private:
  std::mt19937 engine_;
};

struct Sample {
  std::vector<double> parameters, R_inverse;
  Vector q, x;   // q as the reference orders it
};

inline Sample sample(const Known& k, unsigned seed) {
  Dice dice(seed);
  Sample s;
  for (const lagrangian::Parameter& p : k.mechanism.parameters) s.parameters.push_back(dice.between(p.low, p.high));
  s.q = dice.vector(static_cast<Index>(k.mechanism.q.size()), -3, 3);
  const Index rows = k.derived.J.rows();
  s.x = dice.vector(rows, -2, 2);
  const Vector damping = dice.vector(rows, 0.015625, 1);
  s.R_inverse.assign(damping.begin(), damping.end());
  return s;
}

inline Model model_of(const Known& k, const Sample& s) {
  Values v;
  for (std::size_t i = 0; i < s.parameters.size(); ++i) v[k.mechanism.parameters[i].symbol.get_name()] = s.parameters[i];
  return named_model(k.mechanism.name, v);
}

/// A free body has its position before its quaternion in the library, after it in the reference.
inline Vector library_q(const Known& k, const Vector& q) {
  if (k.mechanism.name != "free_body") return q;
  Vector out(7);
  out << q.tail(3), q.head(4);
  return out;
}

template <class T> VectorX<T> converted(const Vector& x) {
  VectorX<T> y(x.size());
  for (Index i = 0; i < x.size(); ++i) y[i] = T(x[i]);
  return y;
}

}  // namespace delassus::unit
