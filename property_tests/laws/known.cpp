#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/known.h"

#include "reference/reference.h"

namespace delassus::laws {
namespace {

constexpr Index most_dofs = 300, most_rows_apply = 1000, most_rows_solve = 400;

/// nullptr when M is singular or the case too large.
reference::Sensitivity* sensitivity(const Case& c) {
  Known& known = *c.known;
  const Structure& s = *c.problem.structure;
  if (!known.tried && s.dofs() <= most_dofs && s.rows <= most_rows_apply) {
    try {
      known.sensitivity.emplace(c.problem, c.damping);
    } catch (const std::runtime_error& e) {
      known.no_sensitivity = e.what();
    }
  }
  known.tried = true;
  return known.sensitivity ? &*known.sensitivity : nullptr;
}

const MatrixX<Quad>& quad_definition(Function f, const Case& c) {
  Known& known = *c.known;
  reference::Sensitivity* s = sensitivity(c);
  if (!s) throw std::runtime_error("no definition: " + known.no_sensitivity);
  if (!known.A) known.A = s->matrices().A();
  if (f == Function::solve && !known.A_inverse) known.A_inverse = reference::dense_damped_inverse(s->matrices());
  return f == Function::apply ? *known.A : *known.A_inverse;
}

/// The diagonal of A, which holds its largest entries, leaves room in double for bounds.
bool within_double(const Case& c) {
  const MatrixX<Quad>& A = quad_definition(Function::apply, c);
  for (Index r = 0; r < A.rows(); ++r)
    if (A(r, r) != Quad(0) && !(A(r, r) > Quad(0x1p-900) && A(r, r) < Quad(0x1p900))) return false;
  return true;
}

}  // namespace

const reference::Dense<Quad>& matrices(const Case& c) {
  reference::Sensitivity* s = sensitivity(c);
  if (!s) throw std::runtime_error("no definition: " + c.known->no_sensitivity);
  return s->matrices();
}

namespace {

const MatrixX<Rational>& exact_definition(Function f, const Case& c) {
  Known& known = *c.known;
  if (!known.exact) {
    known.exact = reference::dense(c.problem.cast<Rational>(), c.damping.cast<Rational>());
    known.exact_A = known.exact->A();
  }
  if (f == Function::solve && !known.exact_inverse) known.exact_inverse = reference::dense_damped_inverse(*known.exact);
  return f == Function::apply ? *known.exact_A : *known.exact_inverse;
}

std::vector<Index> hard_rows(const Case& c) {
  std::vector<bool> in_block(static_cast<std::size_t>(c.rows()), false);
  for (const auto& b : c.damping.blocks)
    for (Index r = 0; r < b.R_inverse.rows(); ++r) in_block[static_cast<std::size_t>(b.row + r)] = true;
  std::vector<Index> out;
  for (Index r = 0; r < c.rows(); ++r)
    if (!in_block[static_cast<std::size_t>(r)] && c.damping.diagonal[static_cast<std::size_t>(r)] == 0) out.push_back(r);
  return out;
}

/// Σ_j b_rj² (M⁻¹)_jj of every row, b_rj² = Σ |k_ω|²|s_ω|² + |k_v|²|s_v|².
VectorX<Quad> row_sizes(const Problem<double>& p, const MatrixX<Quad>& M) {
  const Structure& s = *p.structure;
  const MatrixX<Quad> M_inverse = reference::PivotedLdlt<Quad>(M).inverse();
  VectorX<Quad> size = VectorX<Quad>::Constant(s.rows, Quad(0));
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (const Index j : reference::path_dofs(s, link.body))
        for (Index r = 0; r < e.rows; ++r) {
          const auto &k = p.K[static_cast<std::size_t>(link.first + r)], &x = p.S[static_cast<std::size_t>(j)];
          const double product = k.head<3>().squaredNorm() * x.head<3>().squaredNorm() + k.tail<3>().squaredNorm() * x.tail<3>().squaredNorm();
          size[e.row + r] += Quad(product) * M_inverse(j, j);
        }
  for (const auto& e : s.joint_constraints)
    for (Index r = 0; r < e.rows; ++r)
      for (Index j = 0; j < s.dofs(e.body); ++j) {
        const Quad k = p.joint_K[static_cast<std::size_t>(e.first + r * s.dofs(e.body) + j)];
        size[e.row + r] += k * k * M_inverse(s.first_dof[static_cast<std::size_t>(e.body)] + j, s.first_dof[static_cast<std::size_t>(e.body)] + j);
      }
  return size;
}

}  // namespace

bool dependent_to_rounding(const Case& c) {
  std::optional<bool>& known = c.known->dependent_to_rounding;
  if (known) return *known;
  const std::vector<Index> rows = hard_rows(c);
  const auto m = static_cast<Index>(rows.size());
  if (m == 0 || !sensitivity(c)) return *(known = false);
  const reference::Dense<Quad>& d = sensitivity(c)->matrices();
  const VectorX<Quad> size = row_sizes(c.problem, d.M);
  // PivotedLdlt loses pivots below 30 eps · steps · scale, eps of Quad; asked for is (30 eps · m)² · size, eps of double.
  const double noise = pass_below * unit_roundoff<double> * static_cast<double>(m);
  const Quad unit = Quad(noise) * Quad(noise) / Quad(pass_below * unit_roundoff<Quad>);
  MatrixX<Quad> A(m, m);
  VectorX<Quad> scale(m);
  for (Index r = 0; r < m; ++r) {
    const Index row = rows[static_cast<std::size_t>(r)];
    const Quad root = sqrt(Quad(size[row]));  // rows in units of their size
    if (root == Quad(0)) return *(known = true);
    scale[r] = unit;
    for (Index k = 0; k < m; ++k) A(r, k) = d.A0(row, rows[static_cast<std::size_t>(k)]) / root / sqrt(Quad(size[rows[static_cast<std::size_t>(k)]]));
  }
  return *(known = !reference::PivotedLdlt<Quad>(std::move(A), scale).regular());
}

const char* why_no_bound(Function f, const Case& c) {
  const Structure& s = *c.problem.structure;
  if (s.dofs() > most_dofs || s.rows > most_rows_apply) return "too large for the dense bounds (300 dofs, 1000 rows)";
  if (f == Function::solve && s.rows > most_rows_solve) return "too large for the dense bounds of solve (400 rows)";
  if (!sensitivity(c)) return "M is singular";
  if (!within_double(c)) return "A is beyond 2^±900, where bounds leave the range of double";
  if (f == Function::solve && !sensitivity(c)->regular()) return "A is singular";
  if (f == Function::solve && dependent_to_rounding(c)) return "hard rows depend on others to the rounding of their numbers";
  return nullptr;
}

double condition(const Case& c) { return sensitivity(c)->condition(); }

Quad condition_of_M(const Case& c) {
  auto [at, is_new] = c.known->answers.try_emplace("condition of M");
  if (is_new) {
    const MatrixX<Quad>& M = sensitivity(c)->matrices().M;
    const auto magnitude = [](MatrixX<Quad> x) {
      for (Index k = 0; k < x.size(); ++k) x.data()[k] = abs(x.data()[k]);
      return x;
    };
    const MatrixX<Quad> product = reference::product<Quad>(magnitude(reference::PivotedLdlt<Quad>(M).inverse()), magnitude(M));
    Quad largest(0);
    for (Index r = 0; r < M.rows(); ++r) largest = std::max(largest, Quad(product.row(r).sum()));
    at->second = MatrixX<Quad>::Constant(1, 1, largest);
  }
  return (*at->second)(0, 0);
}

double stiffness(const Case& c) {
  if (!damped(c)) return 0;
  const reference::Dense<Quad>& d = sensitivity(c)->matrices();
  const MatrixX<Quad> R = reference::PivotedLdlt<Quad>(d.R_inverse).inverse();
  double worst = 0;
  for (Index r = 0; r < c.rows(); ++r) worst = std::max(worst, static_cast<double>(Quad(R(r, r) * d.A0(r, r))));
  return worst;
}

double product_condition(const Case& c) {
  if (c.rows() == 0) return 1;
  const VectorX<double> ones = VectorX<double>::Ones(c.rows());
  const MatrixX<Quad>& A = quad_definition(Function::apply, c);
  Quad norm(0);
  for (Index r = 0; r < A.rows(); ++r) {
    Quad sum(0);
    for (Index k = 0; k < A.cols(); ++k) sum += abs(Quad(A(r, k)));
    norm = std::max(norm, sum);
  }
  return sensitivity(c)->apply_sensitivity(ones).maxCoeff() / static_cast<double>(norm);
}

bool exactly_regular(const Case& c) {
  std::optional<bool>& known = c.known->exactly_regular;
  if (!known) known = reference::PivotedLdlt<Rational>(exact_definition(Function::apply, c)).regular();
  return *known;
}

bool damped(const Case& c) {
  Known& known = *c.known;
  if (known.damped) return *known.damped;
  std::vector<bool> in_block(static_cast<std::size_t>(c.rows()), false);
  bool positive = true;
  for (const auto& b : c.damping.blocks) {
    positive = positive && reference::PivotedLdlt<Quad>(converted<Quad>(b.R_inverse)).regular();
    for (Index r = 0; r < b.R_inverse.rows(); ++r) in_block[static_cast<std::size_t>(b.row + r)] = true;
  }
  for (std::size_t r = 0; r < in_block.size(); ++r) positive = positive && (in_block[r] || c.damping.diagonal[r] > 0);
  known.damped = positive;
  return positive;
}

template <> const MatrixX<Quad>& definition<double>(Function f, const Case& c) { return quad_definition(f, c); }
template <> const MatrixX<Rational>& definition<Rational>(Function f, const Case& c) { return exact_definition(f, c); }

/// The row says of a solve without apply that it, too, is a sum of mobilities.
bool by_mobilities(const OperatorRow& op) { return !op.applies && op.apply_error == ErrorClass::amplified && op.solve_error == ErrorClass::amplified; }

MatrixX<Quad> error_bound(Function f, const OperatorRow& op, const Case& c, const MatrixX<double>& x, Data data) {
  const reference::Sensitivity& s = *sensitivity(c);
  MatrixX<Quad> bound(x.rows(), x.cols());
  for (Index k = 0; k < x.cols(); ++k) {
    const VectorX<double> a = x.col(k);
    VectorX<double> b;
    if (f == Function::apply) {
      b = s.apply_sensitivity(a);
      if (op.apply_error == ErrorClass::amplified) b += s.apply_mobile(a);
    } else {
      VectorX<double> lambda(a.size());
      const MatrixX<Quad> exact = reference::product<Quad>(quad_definition(f, c), converted<Quad>(MatrixX<double>(a)));
      for (Index r = 0; r < a.size(); ++r) lambda[r] = static_cast<double>(exact(r, 0));
      b = s.solve_sensitivity(a, lambda);
      if (op.solve_error == ErrorClass::refined) {
        if (data == Data::given && c.known->data == Data::given) b.setZero();
        b += s.solve_refined(a, lambda);
      }
      if (op.solve_error == ErrorClass::normwise) b = s.solve_normwise(a, lambda);
      if (op.solve_error == ErrorClass::normwise && op.apply_error == ErrorClass::amplified) b += s.solve_normwise_mobile(lambda);
      if (op.solve_error == ErrorClass::amplified) b += s.solve_amplified(a);
      if (by_mobilities(op)) b += s.solve_mobile(a);
    }
    // Of second order: where products cancel to a bound that is zero but for Quad's rounding, eps² of the others is met.
    const double second = b.size() == 0 ? 0 : unit_roundoff<double> * b.maxCoeff();
    for (Index r = 0; r < b.size(); ++r) bound(r, k) = Quad(b[r] == 0 ? 0 : b[r] + second);
  }
  return bound;
}

std::string_view bound_name(Function f, const OperatorRow& op, Data data) {
  if (f == Function::apply) return op.apply_error == ErrorClass::amplified ? "apply_mobile + apply_sensitivity" : "apply_sensitivity";
  switch (op.solve_error) {
    case ErrorClass::componentwise: return "solve_sensitivity";
    case ErrorClass::normwise: return op.apply_error == ErrorClass::amplified ? "solve_normwise_mobile + solve_normwise" : "solve_normwise";
    case ErrorClass::refined: return data == Data::given ? "solve_refined" : "solve_refined + solve_sensitivity";
    case ErrorClass::amplified: return by_mobilities(op) ? "solve_mobile + solve_amplified + solve_sensitivity" : "solve_amplified + solve_sensitivity";
  }
  return "solve_sensitivity";
}

const Case& variant(const Case& c, const std::string& name, const std::function<Variant<double>(const Case&)>& make,
                    Data data) {
  auto& all = c.known->variants;
  auto at = all.find(name);
  if (at == all.end()) {
    Variant<double> v = make(c);
    at = all.emplace(name, make_case(std::move(v.problem), std::move(v.damping), c.label + ", " + name, c.seed)).first;
    at->second.known->data = data;
  }
  return at->second;
}

const std::optional<MatrixX<Quad>>& answer(Function f, std::string_view reference, const Case& c,
                                           const MatrixX<double>& x) {
  const std::string key = std::string(reference) + (f == Function::apply ? " apply" : " solve");
  auto [at, is_new] = c.known->answers.try_emplace(key);
  if (!is_new) return at->second;
  for (const reference::ReferenceRow& row : reference::references()) {
    if (row.name != reference || !row.trusts(c.problem, c.damping)) continue;
    try {
      at->second = f == Function::apply ? row.apply(c.problem, c.damping, x) : row.solve(c.problem, c.damping, x);
    } catch (const std::runtime_error&) {  // it reports that it cannot be trusted here
    }
  }
  return at->second;
}

template <class T> MatrixX<Wide<T>> damping_of(const Structure& s, const Damping<T>& d) {
  MatrixX<Wide<T>> out = MatrixX<Wide<T>>::Zero(s.rows, s.rows);
  for (Index r = 0; r < s.rows; ++r) out(r, r) = scalar_cast<Wide<T>>(d.diagonal[static_cast<std::size_t>(r)]);
  for (const auto& b : d.blocks)
    for (Index i = 0; i < b.R_inverse.rows(); ++i)
      for (Index j = 0; j < b.R_inverse.cols(); ++j) out(b.row + i, b.row + j) = scalar_cast<Wide<T>>(b.R_inverse(i, j));
  return out;
}
template MatrixX<Quad> damping_of<double>(const Structure&, const Damping<double>&);
template MatrixX<Rational> damping_of<Rational>(const Structure&, const Damping<Rational>&);

}  // namespace delassus::laws
