#include "reference/lagrangian_page.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "reference/lagrangian_simplify.h"

namespace delassus::reference::lagrangian {
namespace {

using GiNaC::ex;
using GiNaC::matrix;
using GiNaC::numeric;

std::string number(const numeric& x) {
  std::ostringstream s;
  s << x;
  return s.str();
}

std::string raised(const std::string& base, int exponent) {
  static const char* const digit[]{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  if (exponent == 1) return base;
  std::string out = base;
  for (const char c : std::to_string(exponent)) out += digit[c - '0'];
  return out;
}

matrix rows_of(const matrix& x, const std::vector<unsigned>& rows) {
  matrix out(static_cast<unsigned>(rows.size()), x.cols());
  for (unsigned i = 0; i < out.rows(); ++i)
    for (unsigned j = 0; j < x.cols(); ++j) out(i, j) = x(rows[i], j);
  return out;
}

std::string entry(const std::string& name, unsigned i, unsigned j) {
  return name + "(" + std::to_string(i + 1) + "," + std::to_string(j + 1) + ")";
}

/// One line per entry that is not zero, the zeros in one last line; many are not listed. Of a symmetric matrix the upper
/// triangle.
template <class Write> std::string lines(const std::string& name, const matrix& x, bool symmetric, Write write) {
  constexpr int listed = 4;
  std::string out, zeros;
  int count = 0;
  for (unsigned i = 0; i < x.rows(); ++i)
    for (unsigned j = symmetric ? i : 0; j < x.cols(); ++j)
      if (x(i, j).is_zero()) zeros += entry(name, i, j) + " = ", ++count;
      else out += entry(name, i, j) + " = " + write(i, j) + "\n";
  if (count > listed) return out + "all others 0\n";
  return count == 0 ? out : out + zeros + "0\n";
}

/// In brackets unless it is one factor.
std::string bracketed(std::string text) {
  if (text.find(' ') == std::string::npos) return text;
  return text.insert(0, 1, '(').append(1, ')');
}

/// In brackets when it is a sum that no bracket closes.
std::string over(const ex& top, const Text& text) {
  const std::string product = text.product(top);
  const bool sum = product == text.sum(top) && GiNaC::is_a<GiNaC::add>(top);
  return sum ? bracketed(product) : product;
}

/// The sign common to numerator and denominator chosen so that the denominator starts with a positive term.
void fix_sign(const Text& text, ex& top, ex& bottom) {
  if (text.sum(bottom).front() != '-') return;
  top = (-top).expand();
  bottom = (-bottom).expand();
}

std::string operator_lines(const ClosedForms& f, const Text& text) {
  std::vector<std::string> denominators;
  for (unsigned i = 0; i < f.numerator.rows(); ++i)
    for (unsigned j = i; j < f.numerator.cols(); ++j)
      if (!f.numerator(i, j).is_zero()) denominators.push_back(text.product(f.denominator(i, j)));
  const bool common = denominators.size() > 1 && denominators[0].find(' ') != std::string::npos &&
                      std::all_of(denominators.begin(), denominators.end(),
                                  [&](const std::string& d) { return d == denominators[0]; });
  const std::string out = lines("Λ⁻¹", f.numerator, true, [&](unsigned i, unsigned j) {
    const std::string bottom = text.product(f.denominator(i, j));
    if (bottom == "1") return text.product(f.numerator(i, j));
    return over(f.numerator(i, j), text) + " / " + (common ? "D" : bracketed(bottom));
  });
  return common ? "D = " + denominators[0] + "\n" + out : out;
}

/// Rows "| symbol | meaning | unit |" of what occurs in M and J.
std::string legend(const Mechanism& m, const ClosedForms& f) {
  std::string out = "| symbol | meaning | unit |\n|---|---|---|\n";
  const auto row = [&](const GiNaC::symbol& s, const std::string& meaning, const std::string& unit) {
    if (ex(f.M).has(s) || ex(f.J).has(s)) out += "| " + s.get_name() + " | " + meaning + " | " + unit + " |\n";
  };
  for (const Parameter& p : m.parameters) row(p.symbol, p.meaning, p.unit);
  for (const Coordinate& c : m.q) row(c.symbol, c.meaning, c.unit);
  return out;
}

std::string section(const Mechanism& general) {
  const Mechanism m = specialised(general);
  const ClosedForms f = closed_forms(m, derive(m));
  const Text text(m);
  const auto write = [&](const matrix& x) { return [&](unsigned i, unsigned j) { return text.product(x(i, j)); }; };
  return "## " + m.name + "\n" + m.about + "\n" + m.shown.text + "\n\n" + legend(m, f) + "\n```\n" +
         lines("M", f.M, true, write(f.M)) + "\n" + lines("J", f.J, false, write(f.J)) + "\n" + operator_lines(f, text) +
         "```\n";
}

const char* const introduction =
    "# Closed forms\n\n"
    "Written by the program `lagrangian_page` from the symbolic reference (`reference/lagrangian.h`); a test compares this\n"
    "file with what the program writes. Kinetic energy and constraint functions are differentiated symbolically; spatial\n"
    "algebra is not used. `M` is the joint-space inertia, `J` the constraint Jacobian, `Λ⁻¹ = J M⁻¹ Jᵀ` the Delassus\n"
    "operator without damping. Columns of `M` and `J` follow ν, which is q̇ unless something else is said. Of `M` and `Λ⁻¹`\n"
    "the upper triangle is shown. `D` is a common denominator. Angles of a chain are relative to the body before. SI\n"
    "units, radians.\n";

}  // namespace

Text::Text(const Mechanism& m) {
  for (const Parameter& p : m.parameters) order_.push_back(p.symbol);
  for (const Coordinate& c : m.q) order_.push_back(c.symbol);
}

void Text::factor(const ex& base, int exponent, Term& out) const {
  if (GiNaC::is_a<numeric>(base)) {
    out.coefficient *= GiNaC::ex_to<numeric>(pow(base, exponent));
  } else if (GiNaC::is_a<GiNaC::symbol>(base)) {
    const auto at = std::find_if(order_.begin(), order_.end(), [&](const GiNaC::symbol& s) { return base.is_equal(s); });
    if (at == order_.end()) throw std::logic_error("lagrangian: a symbol that is not the mechanism's");
    out.exponents[static_cast<std::size_t>(at - order_.begin())] += exponent;
  } else if (GiNaC::is_exactly_a<GiNaC::function>(base)) {
    const std::string name = GiNaC::ex_to<GiNaC::function>(base).get_name();
    out.functions[name + "(" + sum(base.op(0)) + ")"] += exponent;
  } else {
    throw std::logic_error("lagrangian: text of something that is no polynomial");
  }
}

Text::Term Text::term(const ex& e) const {
  Term out;
  out.exponents.assign(order_.size(), 0);
  const bool product = GiNaC::is_a<GiNaC::mul>(e);
  for (std::size_t k = 0; k < (product ? e.nops() : 1); ++k) {
    const ex part = product ? e.op(k) : e;
    if (GiNaC::is_a<GiNaC::power>(part) && part.op(1).info(GiNaC::info_flags::posint))
      factor(part.op(0), GiNaC::ex_to<numeric>(part.op(1)).to_int(), out);
    else factor(part, 1, out);
  }
  return out;
}

std::vector<Text::Term> Text::terms(const ex& e) const {
  std::vector<Term> all;
  if (!GiNaC::is_a<GiNaC::add>(e)) all.push_back(term(e));
  else
    for (std::size_t k = 0; k < e.nops(); ++k) all.push_back(term(e.op(k)));
  std::sort(all.begin(), all.end(), [](const Term& a, const Term& b) {
    if (a.functions != b.functions) return a.functions < b.functions;
    return a.exponents > b.exponents;
  });
  return all;
}

std::string Text::factors(const Term& t) const {
  std::string out;
  const auto append = [&](const std::string& base, int exponent) {
    if (exponent == 0) return;
    if (!out.empty()) out += ' ';
    out += raised(base, exponent);
  };
  for (std::size_t k = 0; k < order_.size(); ++k) append(order_[k].get_name(), t.exponents[k]);
  for (const auto& [base, exponent] : t.functions) append(base, exponent);
  return out;
}

std::string Text::sum(std::vector<Term> all) const {
  std::string out;
  for (const Term& t : all) {
    const bool negative = t.coefficient.is_negative();
    out += out.empty() ? (negative ? "-" : "") : (negative ? " - " : " + ");
    const numeric size = GiNaC::abs(t.coefficient);
    const std::string rest = factors(t);
    if (rest.empty() || !size.is_equal(1)) out += number(size);
    if (!rest.empty() && !size.is_equal(1)) out += ' ';
    out += rest;
  }
  return out;
}

std::string Text::sum(const ex& e) const { return sum(terms(e)); }

std::string Text::product(const ex& e) const {
  std::vector<Term> all = terms(e);
  if (all.size() == 1) return sum(std::move(all));
  Term common = all[0];
  for (const Term& t : all) {
    common.coefficient = GiNaC::gcd(common.coefficient.numer(), t.coefficient.numer()) /
                         GiNaC::lcm(common.coefficient.denom(), t.coefficient.denom());
    for (std::size_t k = 0; k < order_.size(); ++k) common.exponents[k] = std::min(common.exponents[k], t.exponents[k]);
    for (auto& [base, exponent] : common.functions) {
      const auto at = t.functions.find(base);
      exponent = std::min(exponent, at == t.functions.end() ? 0 : at->second);
    }
  }
  const auto negative = std::count_if(all.begin(), all.end(), [](const Term& t) { return t.coefficient.is_negative(); });
  common.coefficient = GiNaC::abs(common.coefficient);
  if (all[0].coefficient.is_negative() && 2 * negative > static_cast<std::ptrdiff_t>(all.size()))
    common.coefficient = -common.coefficient;
  for (Term& t : all) {
    t.coefficient /= common.coefficient;
    for (std::size_t k = 0; k < order_.size(); ++k) t.exponents[k] -= common.exponents[k];
    for (const auto& [base, exponent] : common.functions)
      if (exponent != 0) t.functions[base] -= exponent;
  }
  const std::string front = sum(std::vector<Term>{common}), rest = sum(std::move(all));
  if (front == "1") return rest;
  return (front == "-1" ? "-" : front + " ") + bracketed(rest);
}

ClosedForms closed_forms(const Mechanism& m, const Derived& derived) {
  const Simplifier simplifier(m);
  const Text text(m);
  ClosedForms f{simplifier.polynomial(derived.M), simplifier.polynomial(rows_of(derived.J, m.shown.rows)), {}, {}};
  const matrix whole = f.J.mul(f.M.inverse()).mul(f.J.transpose());
  f.numerator = f.denominator = matrix(whole.rows(), whole.cols());
  for (unsigned i = 0; i < whole.rows(); ++i)
    for (unsigned j = 0; j < whole.cols(); ++j) {
      auto [top, bottom] = simplifier.fraction(whole(i, j));
      fix_sign(text, top, bottom);
      f.numerator(i, j) = top;
      f.denominator(i, j) = bottom;
    }
  return f;
}

std::string closed_forms_page() {
  std::string page = introduction;
  for (const Mechanism& m : mechanisms()) page.append("\n").append(section(m));
  return page;
}

}  // namespace delassus::reference::lagrangian
