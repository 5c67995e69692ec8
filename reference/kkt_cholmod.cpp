#include "algorithms/kit/test_scalars.h"
#include "reference/kkt_cholmod.h"

#include <cholmod.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "reference/kkt_order.h"

namespace delassus::reference {

/// CHOLMOD's objects with their lifetime, and the factorisation of one system.
class SparseKkt::Factor {
 public:
  Factor(const Kkt<double>& system, std::vector<int> order, bool with_rows)
      : layout_(system.layout), order_(std::move(order)), entries_(system.entries(with_rows)) {
    cholmod_start(&common_);
    common_.print = 0;
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_GIVEN;
    common_.postorder = 0;
    common_.supernodal = CHOLMOD_SIMPLICIAL;
    common_.final_asis = 1;
    common_.final_ll = 0;
  }
  ~Factor() {
    cholmod_free_factor(&factor_, &common_);
    cholmod_free_sparse(&matrix_, &common_);
    cholmod_finish(&common_);
  }
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;

  /// Whether fill and work are within the limits of kkt_cholmod_trusts.
  bool analyse() {
    if (order_.empty()) return true;
    fill();
    factor_ = cholmod_analyze_p(matrix_, order_.data(), nullptr, 0, &common_);
    if (!factor_) throw std::runtime_error("kkt_cholmod: CHOLMOD could not analyse the system");
    return common_.lnz <= largest_fill && common_.fl <= largest_work;
  }

  /// Other numbers in the same places.
  void assign(const Kkt<double>& system) {
    entries_ = system.entries(true);
    if (!order_.empty()) fill();
  }

  [[nodiscard]] double operations() const { return common_.fl + 4 * common_.lnz; }

  /// The unknown whose pivot is lost first, or −1.
  Index factorise() {
    if (order_.empty()) return -1;
    cholmod_factorize(matrix_, factor_, &common_);
    if (common_.status < CHOLMOD_OK) throw std::runtime_error("kkt_cholmod: CHOLMOD ran out of memory or indices");
    return lost_pivot();
  }

  /// x = (matrix)⁻¹ b in double.
  VectorX<double> solve(const VectorX<double>& b) {
    cholmod_dense view{};
    view.nrow = view.nzmax = view.d = static_cast<std::size_t>(b.size());
    view.ncol = 1;
    view.x = const_cast<double*>(b.data());
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor_, &view, &common_);
    if (!x) throw std::runtime_error("kkt_cholmod: CHOLMOD could not solve");
    VectorX<double> out = Eigen::Map<const VectorX<double>>(static_cast<const double*>(x->x), b.size());
    cholmod_free_dense(&x, &common_);
    return out;
  }

  /// r −= (matrix) x in Quad.
  void subtract_product(const VectorX<Quad>& x, VectorX<Quad>& r) const {
    for (const auto& e : entries_) {
      const Quad value(e.value);
      r[e.row] -= value * x[e.column];
      if (e.row != e.column) r[e.column] -= value * x[e.row];
    }
  }

 private:
  void fill() {
    const std::size_t n = order_.size();
    cholmod_free_sparse(&matrix_, &common_);
    cholmod_triplet* t = cholmod_allocate_triplet(n, n, entries_.size(), -1, CHOLMOD_REAL, &common_);
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      static_cast<int*>(t->i)[k] = static_cast<int>(entries_[k].row);
      static_cast<int*>(t->j)[k] = static_cast<int>(entries_[k].column);
      static_cast<double*>(t->x)[k] = entries_[k].value;
    }
    t->nnz = entries_.size();
    matrix_ = cholmod_triplet_to_sparse(t, t->nnz, &common_);
    cholmod_free_triplet(&t, &common_);
  }

  // Compares each pivot with its expected sign and with the diagonal of |L||D||Lᵀ|.
  Index lost_pivot() const {
    const int* begin = static_cast<const int*>(factor_->p);
    const int* row = static_cast<const int*>(factor_->i);
    const int* count = static_cast<const int*>(factor_->nz);
    const double* value = static_cast<const double*>(factor_->x);
    VectorX<double> bound = VectorX<double>::Zero(static_cast<Index>(order_.size()));
    for (std::size_t k = 0; k < order_.size(); ++k) {
      const double d = value[begin[k]];
      bound[static_cast<Index>(k)] += std::fabs(d);
      for (int e = begin[k] + 1; e < begin[k] + count[k]; ++e) bound[row[e]] += value[e] * value[e] * std::fabs(d);
      const double pivot = d * pivot_sign(layout_, order_[k]);
      if (!(pivot > 30 * unit_roundoff<double> * bound[static_cast<Index>(k)])) return order_[k];
    }
    return -1;
  }

  static constexpr double largest_fill = 5e7, largest_work = 1e10;
  KktLayout layout_;
  std::vector<int> order_;
  std::vector<KktEntry<double>> entries_;
  cholmod_common common_{};
  cholmod_sparse* matrix_ = nullptr;
  cholmod_factor* factor_ = nullptr;
};

namespace {

constexpr int refinement_limit = 60;
using Factor = SparseKkt::Factor;

Quad largest(const VectorX<Quad>& x) {
  Quad out(0);
  for (Index i = 0; i < x.size(); ++i)
    if (!(abs(x[i]) <= out)) out = abs(x[i]);
  return out;
}

/// x = (matrix)⁻¹ b; `answer` maps unknowns to the result, whose size decides about convergence.
template <class Answer> VectorX<Quad> refine(Factor& factor, const VectorX<Quad>& b, const Answer& answer) {
  VectorX<Quad> x = VectorX<Quad>::Constant(b.size(), Quad(0)), r = b;
  Quad previous(-1), change(0), size(0);
  for (int step = 0; step < refinement_limit; ++step) {
    const Quad scale = largest(r);
    if (scale == Quad(0)) return x;
    if (!isfinite(scale)) break;
    VectorX<double> right(r.size());
    for (Index i = 0; i < r.size(); ++i) right[i] = static_cast<double>(r[i] / scale);
    const VectorX<double> correction = factor.solve(right);
    VectorX<Quad> dx(x.size());
    for (Index i = 0; i < x.size(); ++i) dx[i] = Quad(correction[i]) * scale;
    x += dx;
    change = largest(answer(dx));
    size = largest(answer(x));
    if (step > 0 && !(change + change < previous)) break;
    previous = change;
    r = b;
    factor.subtract_product(x, r);
  }
  if (!(change <= size * Quad(0x1p-60))) throw std::runtime_error("kkt_cholmod: refinement did not converge");
  return x;
}

void require_regular(Factor& factor) {
  (void)factor.analyse();
  const Index lost = factor.factorise();
  if (lost >= 0) throw std::runtime_error("kkt_cholmod: pivot lost at unknown " + std::to_string(lost));
}

MatrixX<Quad> quad(const MatrixX<double>& X) {
  MatrixX<Quad> Y(X.rows(), X.cols());
  for (Index j = 0; j < X.cols(); ++j)
    for (Index i = 0; i < X.rows(); ++i) Y(i, j) = Quad(X(i, j));
  return Y;
}

}  // namespace

MatrixX<Quad> kkt_cholmod_apply(const Problem<double>& problem, const Damping<double>& damping, const MatrixX<double>& f) {
  require(f.rows() == problem.structure->rows, "kkt_cholmod_apply: wrong number of rows");
  Factor factor(kkt(problem, damping), kkt_order(problem, damping, false), false);
  require_regular(factor);
  const Kkt<Quad> system = kkt(problem.cast<Quad>(), damping.cast<Quad>());
  const MatrixX<Quad> force = quad(f), right = system.forces(force);
  const MatrixX<Quad> nothing = MatrixX<Quad>::Constant(f.rows(), 1, Quad(0));
  MatrixX<Quad> motion(right.rows(), right.cols());
  for (Index c = 0; c < f.cols(); ++c)
    motion.col(c) = refine(factor, right.col(c), [&](const VectorX<Quad>& x) -> VectorX<Quad> {
      return system.accelerations(x, nothing);
    });
  return system.accelerations(motion, force);
}

MatrixX<Quad> kkt_cholmod_solve(const Problem<double>& problem, const Damping<double>& damping, const MatrixX<double>& a) {
  const Index m = problem.structure->rows;
  require(a.rows() == m, "kkt_cholmod_solve: wrong number of rows");
  const Kkt<double> system = kkt(problem, damping);
  Factor factor(system, kkt_order(problem, damping, true), true);
  require_regular(factor);
  MatrixX<Quad> lambda(m, a.cols());
  for (Index c = 0; c < a.cols(); ++c) {
    VectorX<Quad> right = VectorX<Quad>::Constant(system.layout.size(), Quad(0));
    for (Index r = 0; r < m; ++r) right[system.layout.mu(r)] = Quad(a(r, c));
    lambda.col(c) = -refine(factor, right, [m](const VectorX<Quad>& x) -> VectorX<Quad> { return x.tail(m); }).tail(m);
  }
  return lambda;
}

SparseKkt::SparseKkt(const Problem<double>& problem, const Damping<double>& damping) {
  const Kkt<double> system = kkt(problem, damping);
  layout_ = system.layout;
  factor_ = std::make_unique<Factor>(system, kkt_order(problem, damping, true), true);
  (void)factor_->analyse();
}

SparseKkt::~SparseKkt() = default;

bool SparseKkt::update(const Problem<double>& problem, const Damping<double>& damping) {
  factor_->assign(kkt(problem, damping));
  return factor_->factorise() < 0;
}

VectorX<double> SparseKkt::solve(const VectorX<double>& a) const {
  VectorX<double> right = VectorX<double>::Zero(layout_.size());
  right.tail(a.size()) = a;
  return -factor_->solve(right).tail(a.size());
}

double SparseKkt::operations() const { return factor_->operations(); }

bool kkt_cholmod_trusts(const Problem<double>& problem, const Damping<double>& damping) {
  Factor factor(kkt(problem, damping), kkt_order(problem, damping, true), true);
  return factor.analyse() && factor.factorise() < 0;
}

}  // namespace delassus::reference
