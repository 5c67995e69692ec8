#include "algorithms/kit/test_scalars.h"
#include "reference/lagrangian.h"

#include <cln/cln.h>

#include <stdexcept>

namespace delassus::reference::lagrangian {
namespace {

using GiNaC::ex;
using GiNaC::matrix;
using GiNaC::numeric;

constexpr unsigned digits = 60;

/// Entry by entry df/dt.
matrix rate_of(const Mechanism& m, const matrix& f) {
  matrix out(f.rows(), f.cols());
  for (unsigned i = 0; i < f.rows(); ++i)
    for (unsigned j = 0; j < f.cols(); ++j) out(i, j) = rate(m, f(i, j));
  return out;
}

/// tr(X P Yᵀ) = Σ_ij Y_ij (X P)_ij with P = ½ tr(I) 1 − I.
ex trace_product(const matrix& X, const matrix& Y, const matrix& inertia) {
  const ex trace = inertia(0, 0) + inertia(1, 1) + inertia(2, 2);
  matrix P(3, 3);
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = 0; j < 3; ++j) P(i, j) = (i == j ? trace / 2 : ex(0)) - inertia(i, j);
  const matrix XP = X.mul(P);
  ex sum = 0;
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = 0; j < 3; ++j) sum += Y(i, j) * XP(i, j);
  return sum;
}

matrix derivative(const matrix& f, const GiNaC::symbol& by) {
  matrix out(f.rows(), f.cols());
  for (unsigned i = 0; i < f.rows(); ++i)
    for (unsigned j = 0; j < f.cols(); ++j) out(i, j) = f(i, j).diff(by);
  return out;
}

/// A double, exactly, carried to `digits` digits.
numeric wide(double x) { return numeric(cln::cl_float(cln::rational(cln::cl_DF(x)), cln::float_format(digits))); }

/// Rounded to the nearest sum of three doubles, then to Quad.
Quad narrow(const ex& e) {
  if (!GiNaC::is_a<numeric>(e)) throw std::logic_error("lagrangian: a symbol has no value");
  const cln::cl_R x = cln::the<cln::cl_R>(GiNaC::ex_to<numeric>(e).to_cl_N());
  cln::cl_R rest = x;
  Quad sum(0);
  double parts[3];
  for (double& part : parts) {
    part = cln::double_approx(rest);
    rest = rest - cln::rational(cln::cl_DF(part));
  }
  for (int k = 2; k >= 0; --k) sum += Quad(parts[k]);
  return sum;
}

MatrixX<Quad> narrow(const matrix& x) {
  MatrixX<Quad> out(x.rows(), x.cols());
  for (unsigned i = 0; i < x.rows(); ++i)
    for (unsigned j = 0; j < x.cols(); ++j) out(i, j) = narrow(x(i, j));
  return out;
}

matrix column(const VectorX<double>& x) {
  matrix out(static_cast<unsigned>(x.size()), 1);
  for (unsigned i = 0; i < out.rows(); ++i) out(i, 0) = wide(x[i]);
  return out;
}

/// Coordinate values; the four of a quaternion divided by their length.
std::vector<numeric> coordinates(const Mechanism& m, const VectorX<double>& q) {
  std::vector<numeric> out;
  for (Index i = 0; i < q.size(); ++i) out.push_back(wide(q[i]));
  for (const unsigned w : m.quaternions) {
    numeric square = 0;
    for (unsigned k = w; k < w + 4; ++k) square += out[k] * out[k];
    const numeric length = GiNaC::sqrt(square);
    for (unsigned k = w; k < w + 4; ++k) out[k] = out[k] / length;
  }
  return out;
}

}  // namespace

Mechanism specialised(const Mechanism& m) {
  Mechanism out = m;
  const auto put = [&](auto& x) { x = GiNaC::ex_to<matrix>(ex(x).subs(m.shown.values, GiNaC::subs_options::no_pattern)); };
  for (RigidBody& body : out.bodies) {
    body.mass = body.mass.subs(m.shown.values, GiNaC::subs_options::no_pattern);
    put(body.com), put(body.rotation), put(body.inertia);
  }
  for (ex& a : out.armature) a = a.subs(m.shown.values, GiNaC::subs_options::no_pattern);
  for (Rows& r : out.rows) put(r.phi), put(r.axes);
  std::erase_if(out.parameters, [&](const Parameter& p) { return m.shown.values.count(p.symbol) == 1; });
  out.parameters.insert(out.parameters.end(), m.shown.added.begin(), m.shown.added.end());
  out.shown.values.clear();
  out.shown.added.clear();
  return out;
}

ex rate(const Mechanism& m, const ex& f) {
  ex sum = 0;
  for (const Coordinate& c : m.q) sum += f.diff(c.symbol) * c.rate;
  return sum;
}

ex kinetic_energy(const Mechanism& m) {
  ex T = 0;
  for (const RigidBody& body : m.bodies) {
    const matrix v = rate_of(m, body.com);
    for (unsigned k = 0; k < 3; ++k) T += body.mass * v(k, 0) * v(k, 0) / 2;
    const matrix R_rate = rate_of(m, body.rotation);
    T += trace_product(R_rate, R_rate, body.inertia) / 2;
  }
  for (std::size_t k = 0; k < m.nu.size(); ++k) T += m.armature[k] * m.nu[k] * m.nu[k] / 2;
  return T;
}

Derived derive(const Mechanism& m) {
  const unsigned n = static_cast<unsigned>(m.nu.size());
  unsigned rows = 0;
  for (const Rows& r : m.rows) rows += r.phi.rows();
  Derived out{matrix(n, n), matrix(rows, n)};
  const ex T = kinetic_energy(m);
  for (unsigned j = 0; j < n; ++j) {
    const ex momentum = T.diff(m.nu[j]);
    for (unsigned i = 0; i < n; ++i) out.M(i, j) = momentum.diff(m.nu[i]);
  }
  unsigned first = 0;
  for (const Rows& r : m.rows) {
    const matrix along = r.axes.transpose().mul(rate_of(m, r.phi));
    for (unsigned i = 0; i < along.rows(); ++i)
      for (unsigned j = 0; j < n; ++j) out.J(first + i, j) = along(i, 0).diff(m.nu[j]);
    first += along.rows();
  }
  return out;
}

Bias bias(const Mechanism& m, const matrix& g) {
  const unsigned n = static_cast<unsigned>(m.nu.size());
  unsigned rows = 0;
  for (const Rows& r : m.rows) rows += r.phi.rows();
  Bias out{matrix(n, 1), matrix(rows, 1)};
  for (const RigidBody& body : m.bodies) {
    const matrix v = rate_of(m, body.com), a = rate_of(m, v).sub(g);
    const matrix R_rate = rate_of(m, body.rotation), R_second = rate_of(m, R_rate);
    for (unsigned k = 0; k < n; ++k) {
      const matrix along = derivative(v, m.nu[k]);
      for (unsigned c = 0; c < 3; ++c) out.forces(k, 0) += body.mass * a(c, 0) * along(c, 0);
      out.forces(k, 0) += trace_product(R_second, derivative(R_rate, m.nu[k]), body.inertia);
    }
  }
  unsigned first = 0;
  for (const Rows& r : m.rows) {
    const matrix second = rate_of(m, r.axes.transpose().mul(rate_of(m, r.phi)));
    for (unsigned i = 0; i < second.rows(); ++i) out.rows(first++, 0) = second(i, 0);
  }
  return out;
}

Numbers::Numbers(const Mechanism& m, const Derived& derived, const std::vector<double>& parameters,
                 const VectorX<double>& q) : nu_(m.nu) {
  if (parameters.size() != m.parameters.size() || q.size() != static_cast<Index>(m.q.size()))
    throw std::logic_error("lagrangian: the numbers do not fit mechanism " + m.name);
  for (std::size_t k = 0; k < parameters.size(); ++k) values_[m.parameters[k].symbol] = wide(parameters[k]);
  const std::vector<numeric> at = coordinates(m, q);
  for (std::size_t k = 0; k < at.size(); ++k) values_[m.q[k].symbol] = at[k];
  M_ = substitute(derived.M);
  J_ = substitute(derived.J);
  lambda_inverse_ = J_.mul(M_.inverse(GiNaC::solve_algo::gauss)).mul(J_.transpose());
}

matrix Numbers::substitute(const matrix& expressions) const {
  matrix out(expressions.rows(), expressions.cols());
  for (unsigned i = 0; i < out.rows(); ++i)
    for (unsigned j = 0; j < out.cols(); ++j) out(i, j) = expressions(i, j).subs(values_, GiNaC::subs_options::no_pattern);
  return out;
}

matrix Numbers::damped(const std::vector<double>& R_inverse) const {
  if (R_inverse.size() != lambda_inverse_.rows()) throw std::logic_error("lagrangian: R⁻¹ needs one number per row");
  matrix A = lambda_inverse_;
  for (unsigned i = 0; i < A.rows(); ++i) A(i, i) += wide(R_inverse[i]);
  return A;
}

MatrixX<Quad> Numbers::M() const { return narrow(M_); }
MatrixX<Quad> Numbers::J() const { return narrow(J_); }
MatrixX<Quad> Numbers::lambda_inverse() const { return narrow(lambda_inverse_); }
MatrixX<Quad> Numbers::evaluate(const matrix& expressions) const { return narrow(substitute(expressions)); }

MatrixX<Quad> Numbers::evaluate(const matrix& expressions, const VectorX<double>& nu) const {
  if (nu.size() != static_cast<Index>(nu_.size())) throw std::logic_error("lagrangian: ν needs one number per degree of freedom");
  GiNaC::exmap velocities;
  for (Index k = 0; k < nu.size(); ++k) velocities[nu_[static_cast<std::size_t>(k)]] = wide(nu[k]);
  return evaluate(GiNaC::ex_to<matrix>(ex(expressions).subs(velocities, GiNaC::subs_options::no_pattern)));
}

VectorX<Quad> Numbers::apply(const std::vector<double>& R_inverse, const VectorX<double>& x) const {
  return narrow(damped(R_inverse).mul(column(x))).col(0);
}

VectorX<Quad> Numbers::solve(const std::vector<double>& R_inverse, const VectorX<double>& a) const {
  return narrow(damped(R_inverse).inverse(GiNaC::solve_algo::gauss).mul(column(a))).col(0);
}

}  // namespace delassus::reference::lagrangian
