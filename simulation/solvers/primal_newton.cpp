#include "simulation/solvers/primal_newton.h"

#include <algorithm>
#include <utility>

namespace delassus::simulation {

template <class T> std::string PrimalNewton<T>::refusal(const ContactProblem<T>& p) {
  if (!p.mechanism) return "the problem is a given matrix G; the motion of a mechanism is needed";
  const auto within = [](const auto& constraints, const ConeRows& c) {  // their rows ascend
    const auto next = std::upper_bound(constraints.begin(), constraints.end(), c.row, [](Index row, const auto& e) { return row < e.row; });
    return next != constraints.begin() && c.row + c.rows <= std::prev(next)->row + std::prev(next)->rows;
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
  work_ = std::make_unique<Workspace<T>>(factor_.solve_workspace());
  H_.diagonal.assign(static_cast<std::size_t>(p.rows()), T(0));
  H_.blocks.clear();
  block_of_.assign(p.groups.size(), 0);
  projected_.assign(p.groups.size(), {});
  for (std::size_t e = 0; e < p.groups.size(); ++e) {
    if (p.groups[e].cone != Cone::coulomb) continue;
    block_of_[e] = H_.blocks.size();
    H_.blocks.push_back({p.groups[e].row, MatrixX<T>::Zero(p.groups[e].rows, p.groups[e].rows)});
  }
  for (VectorX<T>* const v : {&w_, &Mw_, &d_, &Md_, &tau_}) v->setZero(s.dofs());
  for (VectorX<T>* const v : {&u_, &Jd_, &HJd_, &expected_, &moved_, &trial_, &origin_, &gained_, &root_, &mu_, &scaled_}) v->setZero(p.rows());
}

template <class T> Report PrimalNewton<T>::start(const ContactProblem<T>& p, TreeOperators<T>& tree) {
  problem_ = &p;
  tree_ = &tree;
  w_.setZero();
  origin_.setZero();
  expects_ = false;
  return factor_.start(*p.mechanism);
}

template <class T> Report PrimalNewton<T>::begin_at(const VectorX<T>& lambda) {
  tree_->J_transposed(lambda, tau_);
  return tree_->M_inverse(tau_, w_);
}

template <class T> Report PrimalNewton<T>::begin_from(const VectorX<T>& lambda, const VectorX<T>& x, const VectorX<T>& R_inverse, const VectorX<T>& b) {
  origin_ = lambda;
  take(R_inverse);
  for (Index r = 0; r < x.size(); ++r) u_[r] = -R_inverse[r] * x[r];
  impulses(R_inverse, u_, expected_);
  curve(R_inverse, u_, expected_);
  moved_ = b - u_;
  multiply_hessian(moved_, HJd_);
  expected_ -= HJd_;  // λ at u = b; along d it is expected_ − H J d
  Mw_.setZero();
  const Report report = direction(expected_, w_, Jd_);
  multiply_hessian(Jd_, HJd_);
  expected_ -= HJd_;
  u_ = b + Jd_;
  expects_ = true;
  return report;
}

// In the metric R⁻¹ a cone is scaled by R^½ of each row.
template <class T> void PrimalNewton<T>::take(const VectorX<T>& R_inverse) {
  using std::sqrt;
  for (const ConeRows& c : problem_->groups) {
    if (c.cone != Cone::coulomb || problem_->is_off(c)) continue;
    for (Index r = c.row; r < c.row + c.rows; ++r) {
      root_[r] = T(1) / sqrt(R_inverse[r]);
      mu_[r] = r == c.row ? T(0) : problem_->friction[static_cast<std::size_t>(r)] * root_[c.row] / root_[r];
    }
  }
}

// λ(u)
template <class T> void PrimalNewton<T>::impulses(const VectorX<T>& R_inverse, const VectorX<T>& u, VectorX<T>& lambda) {
  for (std::size_t e = 0; e < problem_->groups.size(); ++e) {
    const ConeRows& c = problem_->groups[e];
    if (problem_->is_off(c)) {
      lambda.segment(c.row, c.rows).setZero();
    } else if (c.cone == Cone::coulomb) {
      for (Index r = c.row; r < c.row + c.rows; ++r) scaled_[r] = -root_[r] * u[r];
      projected_[e] = ConeProjection<T>::project(scaled_.data() + c.row, mu_.data() + c.row, c.rows);
      for (Index r = c.row; r < c.row + c.rows; ++r) lambda[r] = root_[r] * scaled_[r];
    } else {
      for (Index r = c.row; r < c.row + c.rows; ++r) {
        lambda[r] = -u[r] / R_inverse[r];
        project(*problem_, {c.cone, r, 1}, lambda.data() + r);
      }
    }
  }
}

// H at the u and λ of the last impulses.
template <class T> void PrimalNewton<T>::curve(const VectorX<T>& R_inverse, const VectorX<T>& u, const VectorX<T>& lambda) {
  for (std::size_t e = 0; e < problem_->groups.size(); ++e) {
    const ConeRows& c = problem_->groups[e];
    const bool off = problem_->is_off(c);
    if (c.cone != Cone::coulomb) {
      for (Index r = c.row; r < c.row + c.rows; ++r)
        H_.diagonal[static_cast<std::size_t>(r)] = !off && lambda[r] == -u[r] / R_inverse[r] ? T(1) / R_inverse[r] : T(0);
      continue;
    }
    MatrixX<T>& H = H_.blocks[block_of_[e]].R_inverse;
    if (off) {
      H.setZero();
      continue;
    }
    projected_[e].derivative(scaled_.data() + c.row, mu_.data() + c.row, c.rows, H.data());
    for (Index j = 0; j < c.rows; ++j)
      for (Index i = 0; i < c.rows; ++i) H(i, j) *= root_[c.row + i] * root_[c.row + j];
  }
}

template <class T> void PrimalNewton<T>::evaluate(const VectorX<T>& R_inverse, const VectorX<T>& u, VectorX<T>& lambda) {
  take(R_inverse);
  impulses(R_inverse, u, lambda);
  curve(R_inverse, u, lambda);
}

template <class T> Report PrimalNewton<T>::factor_hessian() {
  weights_.assign(H_);  // it holds what it is given: here H itself
  return factor_.update_weights(weights_);
}

template <class T> Report PrimalNewton<T>::direction(const VectorX<T>& lambda, VectorX<T>& d, VectorX<T>& Jd) {
  const Report report = factor_hessian();
  if (!report.ok()) return report;
  tau_ = -Mw_;
  gained_ = lambda - origin_;
  factor_.solve(gained_.data(), tau_.data(), Jd.data(), d.data(), work_->data());
  return report;
}

template <class T> Report PrimalNewton<T>::linearise(const VectorX<T>& R_inverse, const VectorX<T>& lambda) {
  curve(R_inverse, u_, lambda);
  return factor_hessian();
}

template <class T> void PrimalNewton<T>::respond(const VectorX<T>& x, VectorX<T>& Jd) {
  tau_.setZero();
  factor_.solve(x.data(), tau_.data(), Jd.data(), d_.data(), work_->data());
}

// H x at the blocks of the last curve.
template <class T> void PrimalNewton<T>::multiply_hessian(const VectorX<T>& x, VectorX<T>& y) const {
  for (std::size_t e = 0; e < problem_->groups.size(); ++e) {
    const ConeRows& c = problem_->groups[e];
    if (c.cone == Cone::coulomb) y.segment(c.row, c.rows).noalias() = H_.blocks[block_of_[e]].R_inverse.lazyProduct(x.segment(c.row, c.rows));
    else
      for (Index r = c.row; r < c.row + c.rows; ++r) y[r] = H_.diagonal[static_cast<std::size_t>(r)] * x[r];
  }
}

// α; leaves u + α J d in moved_ and its λ in trial_.
template <class T> T PrimalNewton<T>::length(const VectorX<T>& R_inverse) {
  using std::abs;
  const T dMw = d_.dot(Mw_), dMd = d_.dot(Md_);
  const T start = abs(dMw - Jd_.dot(gained_));  // φ'(0): direction has left λ − λ₀
  T low(0), high(0), alpha(1);
  for (int k = 0;; ++k) {
    moved_ = u_ + alpha * Jd_;
    impulses(R_inverse, moved_, trial_);
    gained_ = trial_ - origin_;
    const T value = dMw + alpha * dMd - Jd_.dot(gained_);
    if (k == 60 || abs(value) <= T(flat_enough) * start) return alpha;
    (value < T(0) ? low : high) = alpha;
    curve(R_inverse, moved_, trial_);
    multiply_hessian(Jd_, HJd_);
    const T curvature = dMd + Jd_.dot(HJd_);  // φ''(α) = dᵀM d + (J d)ᵀH (J d)
    T next = alpha - value / curvature;
    if (high > T(0) && !(next > low && next < high)) next = low + (high - low) / T(2);
    if (!(next > low) || next == alpha) return alpha;
    alpha = next;
  }
}

// Whether λ is what H said but for rounding: the gradient is Jᵀ of the difference, and nothing else. What u rounds is as large as R
// makes it where λ = −R u, and in the interior of a cone alone.
template <class T> bool PrimalNewton<T>::is_expected(const VectorX<T>& R_inverse, const VectorX<T>& b, const VectorX<T>& lambda, double velocity) const {
  using std::abs;
  constexpr T eps(8 * unit_roundoff<T>);
  for (std::size_t e = 0; e < problem_->groups.size(); ++e) {
    const ConeRows& c = problem_->groups[e];
    const bool curved = c.cone == Cone::coulomb && projected_[e].region == Region::boundary;
    for (Index r = c.row; r < c.row + c.rows; ++r) {
      const T floor = eps * (curved ? T(R_inverse[r] * lambda[c.row]) : T(abs(u_[r]) + abs(b[r])));
      if (!(R_inverse[r] * abs(lambda[r] - expected_[r]) <= std::max(T(velocity), floor))) return false;
    }
  }
  return true;
}

template <class T>
typename PrimalNewton<T>::Outcome PrimalNewton<T>::minimise(const VectorX<T>& R_inverse, const VectorX<T>& b, double velocity, int iterations, VectorX<T>& lambda) {
  Outcome out;
  double before = std::numeric_limits<double>::infinity();
  take(R_inverse);
  if (!expects_) {
    tree_->J(w_, u_);
    u_ += b;
  }
  impulses(R_inverse, u_, lambda);
  if (std::exchange(expects_, false) && is_expected(R_inverse, b, lambda, velocity)) return out;
  tree_->M(w_, Mw_);
  for (bool last = false; !last && out.iterations < iterations; ++out.iterations) {
    curve(R_inverse, u_, lambda);
    out.report = direction(lambda, d_, Jd_);
    if (!out.report.ok()) return out;
    multiply_hessian(Jd_, HJd_);
    expected_ = lambda - HJd_;
    tree_->M(d_, Md_);
    const T alpha = length(R_inverse);
    w_ += alpha * d_;
    Mw_ += alpha * Md_;
    std::swap(u_, moved_);
    std::swap(lambda, trial_);
    const double step = static_cast<double>((alpha * Jd_).template lpNorm<Eigen::Infinity>());
    const double floor = 8 * unit_roundoff<T> * static_cast<double>(u_.template lpNorm<Eigen::Infinity>() + b.template lpNorm<Eigen::Infinity>());
    last = !(step > floor) || (step < 1e3 * floor && step >= before) || (alpha == T(1) && is_expected(R_inverse, b, lambda, velocity));
    before = step;
  }
  return out;
}

// Fenchel: ½ wᵀMw + ℓ(u) + ½ λᵀ(G + R⁻¹)λ + λᵀb at λ(u) is ½ ‖w − M⁻¹Jᵀ(λ − λ₀)‖²_M
template <class T> double PrimalNewton<T>::gap(const VectorX<T>& lambda) {
  gained_ = lambda - origin_;
  tree_->J_transposed(gained_, tau_);
  tau_ = Mw_ - tau_;
  return tree_->M_inverse(tau_, d_).ok() ? static_cast<double>(T(0.5) * d_.dot(tau_)) : -1;
}

template class PrimalNewton<double>;

}  // namespace delassus::simulation
