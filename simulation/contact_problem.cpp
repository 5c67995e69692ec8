#include "simulation/contact_problem.h"

#include <cmath>

#include "algorithms/errors/message.h"
#include "algorithms/kit/quad.h"

namespace delassus::simulation {
namespace {

std::string text(const double& x) { return number_text(x); }
template <class T> std::string text(const T& x) { return number_text(static_cast<double>(x)); }

[[noreturn]] void refuse(const std::string& element, const std::string& problem, const std::string& accepted) {
  throw ModelError("contact problem", element, problem, accepted);
}

template <class T> void check_sizes(const ContactProblem<T>& p) {
  const auto m = static_cast<std::size_t>(p.rows());
  const auto fits = [&](std::size_t size, const char* what) {
    if (size != m) refuse(what, "holds " + std::to_string(size) + " numbers", std::to_string(m) + ", one a row");
  };
  fits(static_cast<std::size_t>(p.target.size()), "target");
  fits(p.R_inverse.size(), "R_inverse");
  fits(p.friction.size(), "friction");
  fits(p.low.size(), "low");
  fits(p.high.size(), "high");
  if (p.warm_start.size() != 0) fits(static_cast<std::size_t>(p.warm_start.size()), "warm_start");
  if (p.mechanism) {
    p.mechanism->check_sizes();
    fits(static_cast<std::size_t>(p.mechanism->structure->rows), "the rows of the mechanism");
    if (p.G.size() != 0) refuse("G", "is given, and a mechanism too", "one of them");
  } else if (p.G.rows() != p.rows() || p.G.cols() != p.rows()) {
    refuse("G", "has the shape " + std::to_string(p.G.rows()) + " × " + std::to_string(p.G.cols()), std::to_string(m) + " × " + std::to_string(m));
  }
}

template <class T> void check_row(const ContactProblem<T>& p, const ConeRows& c, Index r, bool off) {
  const auto k = static_cast<std::size_t>(r);
  const std::string row = "row " + std::to_string(r);
  if (!is_finite(p.free_velocity[r]) || !is_finite(p.target[r])) refuse(row, "a velocity is not finite", "finite numbers [m/s]");
  if (ScalarTraits<T>::is_infinite(p.R_inverse[k]) != off) refuse(row, "is off, or on, other than its group", "R⁻¹ = ∞ in all rows of a group or in none");
  if (!off && !(is_finite(p.R_inverse[k]) && p.R_inverse[k] >= T(0))) refuse(row, "R⁻¹ = " + text(p.R_inverse[k]), "0 or more [1/kg]");
  const bool tangent = c.cone == Cone::coulomb && r != c.row;
  if (!(is_finite(p.friction[k]) && p.friction[k] >= T(0))) refuse(row, "μ = " + text(p.friction[k]), "0 or more");
  if (!tangent && p.friction[k] > T(0)) refuse(row, "μ = " + text(p.friction[k]) + " in a row that is no tangent", "0 there");
  if (c.cone == Cone::box && !(p.low[k] <= p.high[k])) refuse(row, "low = " + text(p.low[k]) + ", high = " + text(p.high[k]), "low ≤ high [N s]");
}

template <class T> void check_matrix(const MatrixX<T>& G) {
  for (Index c = 0; c < G.cols(); ++c)
    for (Index r = 0; r < G.rows(); ++r) {
      if (!is_finite(G(r, c))) refuse("G(" + std::to_string(r) + ", " + std::to_string(c) + ")", "is not finite", "finite numbers [1/kg]");
      if (r > c && G(r, c) != G(c, r))
        refuse("G(" + std::to_string(r) + ", " + std::to_string(c) + ")", "is " + text(G(r, c)) + ", across the diagonal " + text(G(c, r)),
               "a symmetric matrix; its symmetric part (G + Gᵀ)/2 is another problem, which the caller may take and say so");
    }
}

}  // namespace

std::string_view name(Cone c) {
  switch (c) {
    case Cone::free: return "free";
    case Cone::half_line: return "half_line";
    case Cone::box: return "box";
    case Cone::coulomb: return "coulomb";
  }
  return "unknown";
}

std::string_view name(FrictionLaw f) { return f == FrictionLaw::exact ? "exact" : "relaxed"; }

template <class T> void ContactProblem<T>::resize(Index m) {
  groups.clear();
  free_velocity = target = VectorX<T>::Constant(m, T(0));
  const auto count = static_cast<std::size_t>(m);
  for (std::vector<T>* const v : {&R_inverse, &friction, &low, &high}) v->assign(count, T(0));
  warm_start.resize(0);
}

template <class T> void ContactProblem<T>::validate() const {
  check_sizes(*this);
  Index next = 0;
  for (std::size_t e = 0; e < groups.size(); ++e) {
    const ConeRows& c = groups[e];
    const std::string group = "group " + std::to_string(e);
    if (c.row != next) refuse(group, "begins at row " + std::to_string(c.row), "row " + std::to_string(next) + ": groups ascend and leave no row out");
    const bool contact = c.cone == Cone::coulomb;
    if (c.rows < (contact ? 2 : 1) || (contact && c.rows > max_cone_rows))
      refuse(group, "has " + std::to_string(c.rows) + " rows", contact ? "2 … " + std::to_string(max_cone_rows) : "1 or more");
    next += c.rows;
    if (next > rows()) refuse(group, "ends at row " + std::to_string(next), "at most " + std::to_string(rows()) + " rows");
    for (Index r = c.row; r < next; ++r) check_row(*this, c, r, is_off(c));
  }
  if (next != rows()) refuse("groups", "hold " + std::to_string(next) + " rows", std::to_string(rows()));
  if (!mechanism) check_matrix(G);
}

template <class T> ConeRows& append(ContactProblem<T>& p, Cone cone, Index rows) {
  const Index first = p.groups.empty() ? 0 : p.groups.back().row + p.groups.back().rows;
  require(first + rows <= p.rows(), "append: the problem has not so many rows left");
  p.groups.push_back({cone, first, rows});
  return p.groups.back();
}

template <class T> ConeRows& append_contact(ContactProblem<T>& p, const T& mu, Index tangents) {
  ConeRows& c = append(p, Cone::coulomb, 1 + tangents);
  for (Index k = 1; k <= tangents; ++k) p.friction[static_cast<std::size_t>(c.row + k)] = mu;
  return c;
}

#define DELASSUS_INSTANTIATE(T)                                \
  template struct ContactProblem<T>;                           \
  template ConeRows& append(ContactProblem<T>&, Cone, Index);  \
  template ConeRows& append_contact(ContactProblem<T>&, const T&, Index);
DELASSUS_INSTANTIATE(double)
DELASSUS_INSTANTIATE(Quad)

}  // namespace delassus::simulation
