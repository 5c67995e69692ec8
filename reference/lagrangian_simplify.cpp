#include "reference/lagrangian_simplify.h"

#include <stdexcept>

namespace delassus::reference::lagrangian {
namespace {

using GiNaC::ex;
using GiNaC::matrix;
using GiNaC::numeric;

/// e with every power of s of two or more brought down by s² = value; expanded.
ex with_square(const ex& e, const ex& s, const ex& value) {
  const ex expanded = e.expand();
  ex out = 0;
  for (int k = 0; k <= expanded.degree(s); ++k)
    out += expanded.coeff(s, k) * pow(s, k % 2) * pow(value, k / 2);
  return out.expand();
}

std::size_t terms(const ex& e) { return GiNaC::is_a<GiNaC::add>(e) ? e.nops() : 1; }

/// Whether sin or cos is somewhere in e.
bool has_function(const ex& e) {
  if (GiNaC::is_a<GiNaC::function>(e)) return true;
  for (std::size_t k = 0; k < e.nops(); ++k)
    if (has_function(e.op(k))) return true;
  return false;
}

numeric coefficient_of(const ex& term) {
  if (GiNaC::is_a<numeric>(term)) return GiNaC::ex_to<numeric>(term);
  if (GiNaC::is_a<GiNaC::mul>(term))
    for (std::size_t k = 0; k < term.nops(); ++k)
      if (GiNaC::is_a<numeric>(term.op(k))) return GiNaC::ex_to<numeric>(term.op(k));
  return 1;
}

/// The number that makes all coefficients whole and without a common factor.
numeric content(const ex& expanded) {
  numeric top = 0, bottom = 1;
  const bool sum = GiNaC::is_a<GiNaC::add>(expanded);
  for (std::size_t k = 0; k < (sum ? expanded.nops() : 1); ++k) {
    const numeric c = coefficient_of(sum ? expanded.op(k) : expanded);
    top = GiNaC::gcd(top, c.numer());
    bottom = GiNaC::lcm(bottom, c.denom());
  }
  return abs(top) / bottom;
}

}  // namespace

Simplifier::Simplifier(const Mechanism& m) {
  for (const Coordinate& c : m.q)
    if (c.unit == "rad")
      angles_.push_back({c.symbol, GiNaC::symbol("cos_" + c.symbol.get_name()), GiNaC::symbol("sin_" + c.symbol.get_name()),
                         GiNaC::symbol("exp_" + c.symbol.get_name())});
  for (const unsigned w : m.quaternions) {
    unit_.push_back(m.q[w].symbol);
    ex rest = 1;
    for (unsigned k = w + 1; k < w + 4; ++k) rest -= pow(m.q[k].symbol, 2);
    unit_.push_back(rest);
  }
}

/// sin or cos of an integer combination of angles, in sines and cosines of single angles.
ex Simplifier::split(const ex& argument, bool sine) const {
  for (const Angle& a : angles_) {
    const ex k = argument.coeff(a.q, 1);
    if (k.is_zero()) continue;
    if (!k.info(GiNaC::info_flags::integer)) throw std::logic_error("lagrangian: an angle has a factor that is no integer");
    const int step = k.info(GiNaC::info_flags::positive) ? 1 : -1;
    const ex rest = (argument - step * a.q).expand(), c = split(rest, false), s = split(rest, true);
    return sine ? (s * a.c + step * c * a.s) : (c * a.c - step * s * a.s);
  }
  if (!argument.is_zero()) throw std::logic_error("lagrangian: a sine or cosine of something that is no angle");
  return sine ? 0 : 1;
}

ex Simplifier::in_single_angles(const ex& e) const {
  if (GiNaC::is_exactly_a<GiNaC::function>(e)) {
    const std::string name = GiNaC::ex_to<GiNaC::function>(e).get_name();
    if (name == "sin" || name == "cos") return split(e.op(0).expand(), name == "sin");
    throw std::logic_error("lagrangian: function " + name + " has no short form");
  }
  if (!has_function(e)) return e;
  if (GiNaC::is_a<GiNaC::power>(e)) return pow(in_single_angles(e.op(0)), e.op(1));
  const bool product = GiNaC::is_a<GiNaC::mul>(e);
  ex out = product ? 1 : 0;
  for (std::size_t k = 0; k < e.nops(); ++k) {
    const ex part = in_single_angles(e.op(k));
    out = product ? out * part : out + part;
  }
  return out;
}

ex Simplifier::reduced(const ex& e, bool keep_cosines) const {
  ex out = e.expand();
  for (const Angle& a : angles_)
    out = keep_cosines ? with_square(out, a.s, 1 - a.c * a.c) : with_square(out, a.c, 1 - a.s * a.s);
  return out;
}

ex Simplifier::with_functions(const ex& e) const {
  GiNaC::exmap functions;
  for (const Angle& a : angles_) {
    functions[a.c] = cos(a.q);
    functions[a.s] = sin(a.q);
  }
  return e.subs(functions, GiNaC::subs_options::no_pattern);
}

/// The part of e that belongs to exp(i argument), argument being fixed for the angles before `first`. sign: of the
/// first angle of the argument, 0 while it has none; arguments of sign −1 are the conjugates of those counted.
ex Simplifier::combined(const ex& e, std::size_t first, const ex& argument, int sign) const {
  if (e.is_zero() || sign < 0) return 0;
  if (first == angles_.size()) {
    const ex both = with_square(e, j_, -1), real = both.coeff(j_, 0), imaginary = both.coeff(j_, 1);
    return sign == 0 ? real : 2 * real * cos(argument) - 2 * imaginary * sin(argument);
  }
  const Angle& a = angles_[first];
  ex out = 0;
  for (int k = e.ldegree(a.z); k <= e.degree(a.z); ++k)
    out += combined(e.coeff(a.z, k), first + 1, argument + k * a.q, sign != 0 ? sign : (k > 0) - (k < 0));
  return out;
}

ex Simplifier::combined(const ex& e) const {
  GiNaC::exmap exponentials;
  for (const Angle& a : angles_) {
    exponentials[a.c] = (a.z + 1 / a.z) / 2;
    exponentials[a.s] = -j_ * (a.z - 1 / a.z) / 2;
  }
  return combined(e.subs(exponentials, GiNaC::subs_options::no_pattern).expand(), 0, 0, 0).expand();
}

ex Simplifier::polynomial(const ex& e) const {
  ex single = in_single_angles(e).expand();
  for (std::size_t k = 0; k < unit_.size(); k += 2) single = with_square(single, unit_[k], unit_[k + 1]);
  ex best = with_functions(reduced(single, true)).expand();
  for (const ex& other : {with_functions(reduced(single, false)).expand(), combined(single)})
    if (terms(other) < terms(best)) best = other;
  return best;
}

matrix Simplifier::polynomial(const matrix& x) const {
  matrix out(x.rows(), x.cols());
  for (unsigned i = 0; i < x.rows(); ++i)
    for (unsigned j = 0; j < x.cols(); ++j) out(i, j) = polynomial(x(i, j));
  return out;
}

std::pair<ex, ex> Simplifier::fraction(const ex& e) const {
  const ex both = in_single_angles(e).numer_denom();
  ex top = reduced(both.op(0), true), bottom = reduced(both.op(1), true);
  for (std::size_t k = 0; k < unit_.size(); k += 2) top = with_square(top, unit_[k], unit_[k + 1]);
  const ex cancelled = (top / bottom).numer_denom();
  top = polynomial(with_functions(cancelled.op(0)));
  bottom = polynomial(with_functions(cancelled.op(1)));
  const numeric scale = content(bottom);
  return {(top / scale).expand(), (bottom / scale).expand()};
}

}  // namespace delassus::reference::lagrangian
