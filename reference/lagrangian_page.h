// docs/closed_forms.md, from the symbolic reference: M, J and Λ⁻¹ of every mechanism in short form.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "reference/lagrangian.h"

namespace delassus::reference::lagrangian {

/// Text of expressions, the same on every run: symbols in a given order, terms in the order of their factors.
class Text {
 public:
  /// Symbols in the order of the mechanism's parameters, then coordinates.
  explicit Text(const Mechanism& mechanism);
  /// An expanded polynomial as a sum. @throws std::logic_error when it is none, or a symbol is not the mechanism's.
  [[nodiscard]] std::string sum(const GiNaC::ex& polynomial) const;
  /// The same with the factors common to all terms in front.
  [[nodiscard]] std::string product(const GiNaC::ex& polynomial) const;

 private:
  struct Term {
    GiNaC::numeric coefficient = 1;
    std::vector<int> exponents;             // of symbols, in order
    std::map<std::string, int> functions;   // text to exponent
  };
  [[nodiscard]] std::vector<Term> terms(const GiNaC::ex& e) const;
  [[nodiscard]] Term term(const GiNaC::ex& e) const;
  void factor(const GiNaC::ex& base, int exponent, Term& out) const;
  [[nodiscard]] std::string factors(const Term& t) const;
  [[nodiscard]] std::string sum(std::vector<Term> all) const;

  std::vector<GiNaC::symbol> order_;
};

/// Short forms of a mechanism, of the rows it shows.
struct ClosedForms {
  GiNaC::matrix M, J, numerator, denominator;   ///< Λ⁻¹(i,j) = numerator(i,j) / denominator(i,j)
};
[[nodiscard]] ClosedForms closed_forms(const Mechanism& specialised, const Derived& derived);

/// The whole page.
[[nodiscard]] std::string closed_forms_page();

}  // namespace delassus::reference::lagrangian
