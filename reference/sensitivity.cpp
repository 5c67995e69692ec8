#include "algorithms/kit/test_scalars.h"
#include "reference/sensitivity.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

namespace delassus::reference {

namespace {

using Matrix = MatrixX<double>;
using Vector = VectorX<double>;

/// |X|, each entry rounded once.
Matrix magnitudes(const MatrixX<Quad>& X) {
  Matrix Y(X.rows(), X.cols());
  for (Index j = 0; j < X.cols(); ++j)
    for (Index i = 0; i < X.rows(); ++i) Y(i, j) = std::fabs(static_cast<double>(X(i, j)));
  return Y;
}

VectorX<Quad> quad(const Vector& x) {
  VectorX<Quad> y(x.size());
  for (Index i = 0; i < x.size(); ++i) y[i] = Quad(x[i]);
  return y;
}

/// The problem with every number replaced by its absolute value: its J is J_abs.
Problem<double> absolute(Problem<double> p) {
  for (auto& s : p.S) s = s.cwiseAbs().eval();
  for (auto& h : p.H) h = h.cwiseAbs().eval();
  for (auto& k : p.K) k = k.cwiseAbs().eval();
  for (auto& k : p.joint_K) k = std::fabs(k);
  return p;
}

/// d with d_k² = Σ_i (|S_k|ᵀ h_i)² + armature, h_i = √diag H_i, over the bodies i that joint k moves: d_k d_l bounds every
/// product |L||D||Lᵀ| that an L D Lᵀ factor of M forms, in joints or in bodies. Shape n. `p` holds absolute values.
Vector scale_of_mass(const Problem<double>& p) {
  const Structure& s = *p.structure;
  Vector squares(s.dofs());
  for (Index k = 0; k < s.dofs(); ++k) squares[k] = p.armature[k];
  for (Index i = 0; i < s.bodies(); ++i) {
    const Vector6<double> h = p.H[i].diagonal().cwiseSqrt();
    for (const Index k : path_dofs(s, i)) squares[k] += std::pow(p.S[k].dot(h), 2);
  }
  return squares.cwiseSqrt();
}

/// Names of the connected parts of the pattern `related`: entry k is the smallest index joined to k. Shape n.
std::vector<Index> components(const Matrix& related) {
  std::vector<Index> name(static_cast<std::size_t>(related.rows()));
  std::iota(name.begin(), name.end(), Index{0});
  const auto root = [&](Index k) {
    while (name[k] != k) k = name[k];
    return k;
  };
  for (Index l = 0; l < related.cols(); ++l)
    for (Index k = 0; k < related.rows(); ++k)
      if (related(k, l) != 0) {
        const Index a = root(k), b = root(l);
        name[std::max(a, b)] = std::min(a, b);
      }
  for (Index k = 0; k < related.rows(); ++k) name[k] = root(k);
  return name;
}

/// d dᵀ between indices of one component, 0 elsewhere.
Matrix outer_within(const Vector& d, const std::vector<Index>& component) {
  Matrix X(d.size(), d.size());
  for (Index l = 0; l < d.size(); ++l)
    for (Index k = 0; k < d.size(); ++k) X(k, l) = component[k] == component[l] ? d[k] * d[l] : 0;
  return X;
}

/// (d' dᵀ + d d'ᵀ)/2 between joints on one path, 0 elsewhere.
Matrix outer_on_paths(const Vector& d, const Vector& in_basis, const Structure& s) {
  Matrix X = Matrix::Zero(d.size(), d.size());
  for (Index i = 0; i < s.bodies(); ++i) {
    const std::vector<Index> path = path_dofs(s, i);
    for (Index l = s.first_dof[i]; l < s.first_dof[i + 1]; ++l)
      for (const Index k : path) X(k, l) = X(l, k) = (in_basis[k] * d[l] + d[k] * in_basis[l]) / 2;
  }
  return X;
}

/// |L⁻ᵀ||Lᵀ| of a unit lower triangular L.
Matrix growth_of_basis(const MatrixX<Quad>& L) {
  const Index n = L.rows();
  Matrix C = Matrix::Zero(n, n);
  for (Index k = 0; k < n; ++k) {
    VectorX<Quad> x = VectorX<Quad>::Zero(n);  // L⁻¹ e_k
    x[k] = Quad(1);
    for (Index i = k; i < n; ++i) {
      for (Index m = k; m < i; ++m) x[i] -= L(i, m) * x[m];
      for (Index l = i; l < n; ++l) C(k, l) += std::fabs(static_cast<double>(x[i] * L(l, i)));
    }
  }
  return C;
}

/// C, block diagonal by joints: a joint of several degrees of freedom is eliminated in the basis E = L⁻ᵀ of its D = L diag Lᵀ,
/// and a relative rounding ε of the columns of S E is one of S by ε|S||E||E⁻¹| ≤ ε|S|C. Shape n × n. Cost Σ (dofs on a path)².
Matrix growth_of_bases(const Structure& s, MatrixX<Quad> M) {
  Matrix C = Matrix::Identity(M.rows(), M.rows());
  for (Index body = s.bodies(); body-- > 0;) {
    const Index first = s.first_dof[body], n = s.dofs(body);
    MatrixX<Quad> L = MatrixX<Quad>::Identity(n, n);
    std::vector<Index> left = path_dofs(s, body);
    for (Index c = first; c < first + n; ++c) {
      left.erase(std::find(left.begin(), left.end(), c));
      for (Index d = c + 1; d < first + n; ++d) L(d - first, c - first) = M(d, c) / M(c, c);
      for (const Index k : left)
        for (const Index l : left) M(k, l) -= M(k, c) * M(l, c) / M(c, c);
    }
    C.block(first, first, n, n) = growth_of_basis(L);
  }
  return C;
}

template <class X> auto magnitude(const X& x) {
  return x.unaryExpr([](const Quad& v) { return std::fabs(static_cast<double>(v)); }).eval();
}

/// What is known of a body on the way of forces inwards.
struct OnTheWay {
  Matrix6<double> mobility;         ///< |Ω|
  MatrixX<Quad> S, D_inverse_Ut;    ///< 6 × n_i, n_i × 6
};

/// √(yᵀ |Ω|_l y), the largest over the bodies l on the path of i: κ is carried in exactly, P κ = κ − U D⁻¹Sᵀκ, and the last step to l is
/// made in magnitudes, y = |κ| + |U D⁻¹||Sᵀ||κ|: what rounds is each of its terms, and of P Ω P'.
double reach(const Structure& s, const std::vector<OnTheWay>& way, Index i, Vector6<Quad> kappa) {
  Vector6<double> y = magnitude(kappa);
  double largest = 0;
  for (Index l = i; l != ground; l = s.parent[l]) {
    largest = std::max(largest, y.dot(way[l].mobility * y));
    y = magnitude(kappa) + magnitude(way[l].D_inverse_Ut).transpose() * (magnitude(way[l].S).transpose() * magnitude(kappa));
    kappa -= way[l].D_inverse_Ut.transpose() * (way[l].S.transpose() * kappa);
  }
  return std::sqrt(largest);
}

/// ω of apply_mobile. Shape m. Cost n³, and n² per body.
Vector reaches(const Problem<Quad>& p, const MatrixX<Quad>& M_inverse, const Matrix& C) {
  const Structure& s = *p.structure;
  std::vector<OnTheWay> way(static_cast<std::size_t>(s.bodies()));
  std::vector<MatrixX<Quad>> D_inverse(way.size());
  std::vector<Matrix6<Quad>> inertia = p.H;  // articulated
  const Matrix in_basis = C * magnitude(M_inverse) * C.transpose();
  for (Index i = 0; i < s.bodies(); ++i) {
    const std::vector<Index> path = path_dofs(s, i);
    way[i].mobility.setZero();
    for (const Index k : path)
      for (const Index l : path) way[i].mobility += magnitude(p.S[k]) * in_basis(k, l) * magnitude(p.S[l]).transpose();
  }
  for (Index i = s.bodies(); i-- > 0;) {
    const Index first = s.first_dof[i], n = s.dofs(i);
    MatrixX<Quad>& S = way[i].S;
    S.resize(6, n);
    for (Index k = 0; k < n; ++k) S.col(k) = p.S[first + k];
    const MatrixX<Quad> U = inertia[i] * S;
    MatrixX<Quad> D = S.transpose() * U;
    for (Index k = 0; k < n; ++k) D(k, k) += p.armature[first + k];
    D_inverse[i] = PivotedLdlt<Quad>(D).inverse();
    way[i].D_inverse_Ut = D_inverse[i] * U.transpose();
    if (s.parent[i] != ground) inertia[s.parent[i]] += inertia[i] - U * way[i].D_inverse_Ut;
  }
  Vector w = Vector::Zero(s.rows);
  for (const auto& e : s.link_constraints)
    for (const auto& link : e.links)
      for (Index r = 0; r < e.rows; ++r) w[e.row + r] += reach(s, way, link.body, p.K[link.first + r]);
  for (const auto& j : s.joint_constraints)
    for (Index r = 0; r < j.rows; ++r) {
      const VectorX<Quad> k = Eigen::Map<const VectorX<Quad>>(p.joint_K.data() + j.first + r * s.dofs(j.body), s.dofs(j.body));
      const Vector own = magnitude(k);
      w[j.row + r] = std::sqrt(own.dot(magnitude(D_inverse[j.body]) * own));
      if (s.parent[j.body] != ground) w[j.row + r] += reach(s, way, s.parent[j.body], Vector6<Quad>(way[j.body].D_inverse_Ut.transpose() * k));
    }
  return w;
}

double norm(const Matrix& X) { return X.size() == 0 ? 0 : X.rowwise().sum().maxCoeff(); }
double norm(const Vector& x) { return x.size() == 0 ? 0 : x.cwiseAbs().maxCoeff(); }

}  // namespace

struct Sensitivity::Data {
  Dense<Quad> dense;
  Matrix J_abs, C, M_bound, M_inverse_abs, R_inverse_abs;
  Vector mass_scale;
  Problem<Quad> problem;
  std::optional<Vector> omega;  // of apply_mobile

  // A⁻¹ and what only the bounds of solve need.
  std::optional<PivotedLdlt<Quad>> A;
  Matrix A_inverse_abs;
  double A_norm = 0;

  // R = (R⁻¹)⁻¹ and M_R = M + Jᵀ R J: what only the bound of the direct formula needs.
  struct Direct {
    MatrixX<Quad> R, MR_inverse;
    Matrix R_abs, MR_inverse_abs, MR_bound;
  };
  std::optional<Direct> direct;

  const PivotedLdlt<Quad>& factor() {
    if (!A) {
      A.emplace(factorise(dense));
      A_norm = norm(magnitudes(dense.A()));
      if (A->regular()) A_inverse_abs = magnitudes(A->inverse());
    }
    return *A;
  }
  void require_regular() {
    if (!factor().regular())
      throw std::runtime_error("A = J M⁻¹ Jᵀ + R⁻¹ is singular: pivot lost at row " + std::to_string(A->lost_row()));
  }
  const Direct& direct_formula() {
    if (!direct) {
      Direct d;
      d.R = PivotedLdlt<Quad>(dense.R_inverse).inverse();
      const MatrixX<Quad> MR = dense.M + product<Quad>(dense.J.transpose(), product(d.R, dense.J));
      d.MR_inverse = PivotedLdlt<Quad>(MR).inverse();
      d.R_abs = magnitudes(d.R);
      d.MR_inverse_abs = magnitudes(d.MR_inverse);
      const Matrix stiffness = J_abs.transpose() * d.R_abs * J_abs;
      const Vector scale = (mass_scale.cwiseAbs2() + stiffness.diagonal()).cwiseSqrt();
      d.MR_bound = outer_within(scale, components(M_bound + stiffness));
      direct = std::move(d);
    }
    return *direct;
  }
};

Sensitivity::Sensitivity(const Problem<double>& problem, const Damping<double>& damping)
    : data_(std::make_unique<Data>()) {
  Data& d = *data_;
  d.problem = problem.cast<Quad>();
  d.dense = reference::dense(d.problem, damping.cast<Quad>());
  const Problem<double> p = absolute(problem);
  d.J_abs = constraint_jacobian(p);
  d.mass_scale = scale_of_mass(p);
  d.M_inverse_abs = magnitudes(PivotedLdlt<Quad>(d.dense.M).inverse());
  d.C = growth_of_bases(*p.structure, d.dense.M);
  d.M_bound = outer_on_paths(d.mass_scale, d.C.transpose() * d.mass_scale, *p.structure);
  d.R_inverse_abs = magnitudes(d.dense.R_inverse);
}
Sensitivity::~Sensitivity() = default;
Sensitivity::Sensitivity(Sensitivity&&) noexcept = default;
Sensitivity& Sensitivity::operator=(Sensitivity&&) noexcept = default;

Index Sensitivity::rows() const { return data_->J_abs.rows(); }
const Dense<Quad>& Sensitivity::matrices() const { return data_->dense; }
bool Sensitivity::regular() const { return data_->factor().regular(); }

VectorX<double> Sensitivity::apply_sensitivity(const VectorX<double>& x) const {
  require(x.size() == rows(), "Sensitivity: wrong number of rows");
  const Data& d = *data_;
  const Vector force = d.J_abs.transpose() * x.cwiseAbs();
  const Vector rate = d.M_inverse_abs * force;                             // |M⁻¹| J_absᵀ |x|
  const Vector through = d.M_inverse_abs * (d.M_bound * rate);             // through δM
  const Vector twice = d.M_inverse_abs * (d.M_bound * through);            // and twice, of second order
  const Vector of_rows = (d.C * rate + d.M_inverse_abs * (d.C.transpose() * force)) / 2;
  const Vector change = of_rows + through + unit_roundoff<double> * twice;
  return d.J_abs * change + d.R_inverse_abs * x.cwiseAbs();
}

VectorX<double> Sensitivity::apply_mobile(const VectorX<double>& x) const {
  require(x.size() == rows(), "Sensitivity: wrong number of rows");
  if (!data_->omega) data_->omega = reaches(data_->problem, PivotedLdlt<Quad>(data_->dense.M).inverse(), data_->C);
  return *data_->omega * data_->omega->dot(x.cwiseAbs());
}

VectorX<double> Sensitivity::solve_mobile(const VectorX<double>& a) const {
  require(a.size() == rows(), "Sensitivity: wrong number of rows");
  data_->require_regular();
  const Matrix& R = data_->direct_formula().R_abs;
  return R * apply_mobile(R * a.cwiseAbs());
}

VectorX<Quad> Sensitivity::solve(const VectorX<double>& a) const {
  require(a.size() == rows(), "Sensitivity: wrong number of rows");
  data_->require_regular();
  return data_->factor().solve(quad(a));
}

VectorX<double> Sensitivity::solve_sensitivity(const VectorX<double>& a, const VectorX<double>& lambda) const {
  require(a.size() == rows(), "Sensitivity: wrong number of rows");
  data_->require_regular();
  return data_->A_inverse_abs * (apply_sensitivity(lambda) + a.cwiseAbs());
}

VectorX<double> Sensitivity::solve_normwise(const VectorX<double>& a, const VectorX<double>& lambda) const {
  require(a.size() == rows(), "Sensitivity: wrong number of rows");
  data_->require_regular();
  const double residual = data_->A_norm * norm(lambda) + norm(apply_sensitivity(lambda)) + norm(a);
  return Vector::Constant(rows(), norm(data_->A_inverse_abs) * residual);
}

VectorX<double> Sensitivity::solve_normwise_mobile(const VectorX<double>& lambda) const {
  require(lambda.size() == rows(), "Sensitivity: wrong number of rows");
  data_->require_regular();
  return VectorX<double>::Constant(rows(), norm(data_->A_inverse_abs) * norm(apply_mobile(lambda)));
}

VectorX<double> Sensitivity::solve_refined(const VectorX<double>& a, const VectorX<double>& lambda) const {
  const Vector sensitivity = solve_sensitivity(a, lambda), least = Vector::Constant(rows(), norm(lambda));
  if (!PivotedLdlt<Quad>(data_->dense.R_inverse).regular()) return unit_roundoff<double> * sensitivity + least;
  const double energy = std::sqrt(std::fabs(a.dot(lambda)));  // ‖ν‖²_M + ‖λ‖²_{R⁻¹}
  const Vector root = magnitudes(MatrixX<Quad>(data_->direct_formula().R.diagonal())).cwiseSqrt();
  return unit_roundoff<double> * sensitivity + least.cwiseMin(root * energy);
}

VectorX<double> Sensitivity::solve_amplified(const VectorX<double>& a) const {
  require(a.size() == rows(), "Sensitivity: wrong number of rows");
  const Data::Direct& d = data_->direct_formula();
  const Matrix& J = data_->J_abs;
  const VectorX<Quad> Ra = product<Quad>(d.R, quad(a));
  const MatrixX<Quad> nu_exact = product<Quad>(d.MR_inverse, product<Quad>(data_->dense.J.transpose(), Ra));
  const Vector nu = magnitudes(nu_exact);
  const Vector force = d.R_abs * a.cwiseAbs();                             // |R||a|
  const Vector of_rate = d.MR_inverse_abs * (d.MR_bound * nu + J.transpose() * force);
  return d.R_abs * (a.cwiseAbs() + J * (nu + of_rate));
}

double Sensitivity::condition() const {
  data_->require_regular();
  return data_->A_norm * norm(data_->A_inverse_abs);
}

}  // namespace delassus::reference
