#include "simulation/solvers/primal_newton.h"

namespace delassus::simulation {

template <class T> std::string PrimalNewton<T>::refusal(const ContactProblem<T>& p) {
  if (!p.mechanism) return "the problem is a given matrix G; the motion of a mechanism is needed";
  const auto within = [](const auto& constraints, const ConeRows& c) {
    for (const auto& e : constraints)
      if (e.row <= c.row && c.row + c.rows <= e.row + e.rows) return true;
    return false;
  };
  for (std::size_t e = 0; e < p.groups.size(); ++e) {
    const ConeRows& c = p.groups[e];
    if (c.cone == Cone::coulomb && !within(p.mechanism->structure->link_constraints, c) && !within(p.mechanism->structure->joint_constraints, c))
      return "group " + std::to_string(e) + " has rows of several constraints; a contact must be one constraint of the mechanism";
  }
  return "";
}

template <class T> void PrimalNewton<T>::analyze(const ContactProblem<T>& p) {
  const Structure& s = *p.mechanism->structure;
  plan_ = make_plan(s, Matrix::M_R);
  factor_.analyze(s, plan_);
  weights_.analyze(s);
  tree_ = std::make_unique<TreeOperators<T>>(p.mechanism->structure);
  work_ = std::make_unique<Workspace<T>>(factor_.solve_workspace());
  H_.diagonal.assign(static_cast<std::size_t>(p.rows()), T(0));
  H_.blocks.clear();
  block_of_.assign(p.groups.size(), 0);
  for (std::size_t e = 0; e < p.groups.size(); ++e) {
    if (p.groups[e].cone != Cone::coulomb) continue;
    block_of_[e] = H_.blocks.size();
    H_.blocks.push_back({p.groups[e].row, MatrixX<T>::Zero(p.groups[e].rows, p.groups[e].rows)});
  }
  for (VectorX<T>* const v : {&w_, &Mw_, &d_, &Md_, &tau_}) v->setZero(s.dofs());
  for (VectorX<T>* const v : {&u_, &Jd_, &moved_, &trial_, &origin_, &gained_}) v->setZero(p.rows());
}

template <class T> Report PrimalNewton<T>::start(const ContactProblem<T>& p) {
  problem_ = &p;
  w_.setZero();
  origin_.setZero();
  const Report report = factor_.start(*p.mechanism);
  return report.ok() ? tree_->update(*p.mechanism) : report;
}

template <class T> Report PrimalNewton<T>::begin_at(const VectorX<T>& lambda) {
  tree_->J_transposed(lambda, tau_);
  return tree_->M_inverse(tau_, w_);
}

template <class T> void PrimalNewton<T>::begin_from(const VectorX<T>& lambda) {
  w_.setZero();
  origin_ = lambda;
}

// λ and H of one group; in the metric R⁻¹ a cone is scaled by R^½ of each row.
template <class T> void PrimalNewton<T>::cone(const ConeRows& c, std::size_t e, const T* R_inverse, const T* u, T* lambda) {
  using std::sqrt;
  if (c.cone != Cone::coulomb) {
    for (Index r = c.row; r < c.row + c.rows; ++r) {
      const T free = -u[r] / R_inverse[r];
      lambda[r] = free;
      project(*problem_, {c.cone, r, 1}, lambda + r);
      H_.diagonal[static_cast<std::size_t>(r)] = lambda[r] == free ? T(1) / R_inverse[r] : T(0);
    }
    return;
  }
  T root[max_cone_rows], mu[max_cone_rows], x[max_cone_rows];
  for (Index k = 0; k < c.rows; ++k) {
    root[k] = T(1) / sqrt(R_inverse[c.row + k]);
    mu[k] = k == 0 ? T(0) : problem_->friction[static_cast<std::size_t>(c.row + k)] * root[0] / root[k];
    x[k] = -root[k] * u[c.row + k];
  }
  MatrixX<T>& H = H_.blocks[block_of_[e]].R_inverse;
  const auto projected = ConeProjection<T>::project(x, mu, c.rows);
  projected.derivative(x, mu, c.rows, H.data());
  for (Index j = 0; j < c.rows; ++j) {
    lambda[c.row + j] = root[j] * x[j];
    for (Index i = 0; i < c.rows; ++i) H(i, j) *= root[i] * root[j];
  }
}

template <class T> void PrimalNewton<T>::evaluate(const VectorX<T>& R_inverse, const VectorX<T>& u, VectorX<T>& lambda) {
  for (std::size_t e = 0; e < problem_->groups.size(); ++e) {
    const ConeRows& c = problem_->groups[e];
    if (!problem_->is_off(c)) {
      cone(c, e, R_inverse.data(), u.data(), lambda.data());
      continue;
    }
    lambda.segment(c.row, c.rows).setZero();
    if (c.cone == Cone::coulomb) H_.blocks[block_of_[e]].R_inverse.setZero();
    else std::fill_n(H_.diagonal.begin() + c.row, c.rows, T(0));
  }
}

template <class T> Report PrimalNewton<T>::direction(const VectorX<T>& lambda, VectorX<T>& d, VectorX<T>& Jd) {
  weights_.assign(H_);  // it holds what it is given: here H itself
  const Report report = factor_.update_weights(weights_);
  if (!report.ok()) return report;
  tau_ = -Mw_;
  gained_ = lambda - origin_;
  factor_.solve(gained_.data(), tau_.data(), Jd.data(), d.data(), work_->data());
  return report;
}

// φ'(α) and φ''(α) = dᵀM d + (J d)ᵀH (J d)
template <class T> typename PrimalNewton<T>::Slope PrimalNewton<T>::slope(const VectorX<T>& R_inverse, const T& alpha) {
  moved_ = u_ + alpha * Jd_;
  evaluate(R_inverse, moved_, trial_);
  weights_.assign(H_);
  Slope s{d_.dot(Mw_) + alpha * d_.dot(Md_) - Jd_.dot(trial_ - origin_), d_.dot(Md_)};
  weights_.multiply(Jd_.data(), moved_.data());
  s.curvature += Jd_.dot(moved_);
  return s;
}

template <class T> T PrimalNewton<T>::length(const VectorX<T>& R_inverse) {
  using std::abs;
  const T start = abs(slope(R_inverse, T(0)).value);
  T low(0), high(0), alpha(1);
  for (int k = 0; k < 60; ++k) {
    const Slope s = slope(R_inverse, alpha);
    if (abs(s.value) <= T(1e-10) * start) break;
    (s.value < T(0) ? low : high) = alpha;
    T next = alpha - s.value / s.curvature;
    if (high > T(0) && !(next > low && next < high)) next = low + (high - low) / T(2);
    if (!(next > low) || next == alpha) break;
    alpha = next;
  }
  return alpha;
}

template <class T>
typename PrimalNewton<T>::Outcome PrimalNewton<T>::minimise(const VectorX<T>& R_inverse, const VectorX<T>& b, double velocity, int iterations, VectorX<T>& lambda) {
  Outcome out;
  double before = std::numeric_limits<double>::infinity();
  for (bool last = false;; ++out.iterations) {
    tree_->J(w_, u_);
    u_ += b;
    tree_->M(w_, Mw_);
    evaluate(R_inverse, u_, lambda);
    if (last || out.iterations == iterations) break;
    out.report = direction(lambda, d_, Jd_);
    if (!out.report.ok()) return out;
    tree_->M(d_, Md_);
    const T alpha = length(R_inverse);
    w_ += alpha * d_;
    const double step = static_cast<double>((alpha * Jd_).template lpNorm<Eigen::Infinity>());
    const double floor = 8 * unit_roundoff<T> * static_cast<double>(u_.template lpNorm<Eigen::Infinity>() + b.template lpNorm<Eigen::Infinity>());
    last = !(step > std::max(velocity, floor)) || (step < 1e3 * floor && step >= before);
    before = step;
  }
  // Fenchel: ½ wᵀMw + ℓ(u) + ½ λᵀ(G + R⁻¹)λ + λᵀb at λ(u) is ½ ‖w − M⁻¹Jᵀ(λ − λ₀)‖²_M
  gained_ = lambda - origin_;
  tree_->J_transposed(gained_, tau_);
  tau_ = Mw_ - tau_;
  if (tree_->M_inverse(tau_, d_).ok()) out.gap = static_cast<double>(T(0.5) * d_.dot(tau_));
  return out;
}

template class PrimalNewton<double>;

}  // namespace delassus::simulation
