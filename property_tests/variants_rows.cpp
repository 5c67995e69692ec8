#include "property_tests/variants_rows.h"

#include <utility>

#include "algorithms/scalars.h"
#include "generators/random.h"

namespace delassus::laws {
namespace {

template <class T> void scale(typename Parts<T>::Constraint& c, const T& factor) {
  for (T& r : c.diagonal) r *= factor;
  for (auto& b : c.blocks) b.R_inverse *= factor;
}

template <class T> typename Parts<T>::Constraint& chosen(Parts<T>& parts, std::uint64_t seed) {
  return parts.constraints[seed % parts.constraints.size()];
}

}  // namespace

Index constraint_count(const Structure& s) {
  return static_cast<Index>(s.link_constraints.size() + s.joint_constraints.size());
}

template <class T> Second<T> one_left_out(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed) {
  Parts<T> parts = apart(p, d);
  parts.constraints.erase(parts.constraints.begin() + (&chosen(parts, seed) - parts.constraints.data()));
  return together(parts);
}

template <class T> Second<T> reordered(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed) {
  Parts<T> parts = apart(p, d);
  generators::Random random(seed + 17);
  auto& all = parts.constraints;
  for (std::size_t k = all.size(); k > 1; --k)
    std::swap(all[k - 1], all[static_cast<std::size_t>(random.integer(0, static_cast<int>(k) - 1))]);
  return together(parts);
}

template <class T> Second<T> with_idle_links(const Problem<T>& p, const Damping<T>& d) {
  Parts<T> parts = apart(p, d);
  for (auto& c : parts.constraints) {
    const std::size_t links = c.links.size();
    for (Index i = 0; links > 0 && c.links.size() == links && i < parts.count(); ++i)
      parts.add_link(c, i, MatrixX<T>::Constant(c.rows(), 6, T(0)));
  }
  return together(parts);
}

template <class T> Second<T> doubled(const Problem<T>& p, const Damping<T>& d, std::uint64_t seed) {
  Parts<T> parts = apart(p, d);
  auto copy = chosen(parts, seed);
  scale<T>(chosen(parts, seed), T(3));
  scale<T>(copy, T(1.5));
  parts.constraints.push_back(std::move(copy));
  return together(parts);
}

template <class T> Units<T> other_units() {
  if constexpr (ScalarTraits<T>::exact) return {T(3), T(0.625), T(7)};
  else return {T(0x1p-10), T(0x1p-20), T(0x1p7)};
}

template <class T> Second<T> in_units(const Problem<T>& p, const Damping<T>& d, const Units<T>& u) {
  Parts<T> parts = apart(p, d);
  const T per_length = T(1) / u.length, damping = u.row * u.row / u.mass;
  for (auto& b : parts.bodies) {
    b.S.bottomRows(3) *= u.length;
    b.H *= u.mass;
    b.H.template bottomRows<3>() *= per_length;
    b.H.template rightCols<3>() *= per_length;
    for (T& a : b.armature) a *= u.mass;
  }
  for (auto& c : parts.constraints) {
    for (auto& l : c.links) {
      l.K *= u.row;
      l.K.rightCols(3) *= per_length;
    }
    c.joint_K *= u.row;
    scale<T>(c, damping);
  }
  return together(parts);
}

#define DELASSUS_VARIANTS(T)                                                             \
  template Second<T> one_left_out(const Problem<T>&, const Damping<T>&, std::uint64_t);  \
  template Second<T> reordered(const Problem<T>&, const Damping<T>&, std::uint64_t);     \
  template Second<T> with_idle_links(const Problem<T>&, const Damping<T>&);              \
  template Second<T> doubled(const Problem<T>&, const Damping<T>&, std::uint64_t);       \
  template Units<T> other_units<T>();                                                    \
  template Second<T> in_units(const Problem<T>&, const Damping<T>&, const Units<T>&);
DELASSUS_VARIANTS(double)
DELASSUS_VARIANTS(Rational)

}  // namespace delassus::laws
