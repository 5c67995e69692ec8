#include "simulation/contact_operator.h"

#include "algorithms/kit/ldlt.h"

namespace delassus::simulation {

template <class T> bool ContactOperator<T>::fits(const ContactProblem<T>& p) const {
  const auto structure = p.mechanism ? p.mechanism->structure : nullptr;
  return problem_ != nullptr && m_ == p.rows() && structure == structure_;
}

template <class T> void ContactOperator<T>::analyze(const ContactProblem<T>& p) {
  problem_ = &p;
  m_ = p.rows();
  structure_ = p.mechanism ? p.mechanism->structure : nullptr;
  off_.clear();
  off_.reserve(static_cast<std::size_t>(m_));
  diagonal_.resize(m_);
  shifted_.diagonal = p.R_inverse;
  tree_ = nullptr;
  own_tree_.reset();
  solve_.reset();
  blocks_.reset();
  matrix_.resize(0, 0);
  if (!structure_) return;
  blocks_ = std::make_unique<DelassusBlocks<T>>(structure_);
}

template <class T> Report ContactOperator<T>::update(const ContactProblem<T>& p, TreeOperators<T>* tree) {
  require(fits(p), "ContactOperator::update: call analyze with a problem of this structure first");
  problem_ = &p;
  solve_current_ = matrix_current_ = false;
  off_.clear();
  for (Index r = 0; r < m_; ++r)
    if (ScalarTraits<T>::is_infinite(p.R_inverse[static_cast<std::size_t>(r)])) off_.push_back(r);
  Report report;
  if (structure_) {
    if (tree == nullptr && !own_tree_) own_tree_ = std::make_unique<TreeOperators<T>>(structure_);
    tree_ = tree != nullptr ? tree : own_tree_.get();
    if (tree == nullptr) tree_->take(*p.mechanism);
    report = blocks_->update(*tree_);
    if (report.ok()) report = blocks_->diagonal(diagonal_);
  } else {
    diagonal_ = p.G.diagonal();
  }
  for (Index r = 0; r < m_; ++r) diagonal_[r] += p.R_inverse[static_cast<std::size_t>(r)];
  switch_off(diagonal_.data());
  return report;
}

template <class T> void ContactOperator<T>::multiply(const T* lambda, T* u) {
  Eigen::Map<VectorX<T>> out(u, m_);
  const Eigen::Map<const VectorX<T>> in(lambda, m_);
  if (structure_) (void)tree_->delassus(in, out);  // NaN where M is singular
  else out.noalias() = problem_->G * in;
  for (Index r = 0; r < m_; ++r) out[r] += problem_->R_inverse[static_cast<std::size_t>(r)] * lambda[r];
  switch_off(u);
}

template <class T> void ContactOperator<T>::velocity(const T* lambda, T* u) {
  multiply(lambda, u);
  for (Index r = 0; r < m_; ++r) u[r] += problem_->free_velocity[r] - problem_->target[r];
  switch_off(u);
}

template <class T> const MatrixX<T>& ContactOperator<T>::matrix() {
  if (matrix_current_) return matrix_;
  matrix_.resize(m_, m_);
  if (structure_) {
    unit_.setZero(m_, 1);
    for (Index c = 0; c < m_; ++c) {
      unit_(c, 0) = T(1);
      multiply(unit_.data(), matrix_.data() + c * m_);
      unit_(c, 0) = T(0);
      matrix_(c, c) -= problem_->R_inverse[static_cast<std::size_t>(c)];
    }
  } else {
    matrix_ = problem_->G;
  }
  for (const Index r : off_) {
    matrix_.row(r).setZero();
    matrix_.col(r).setZero();
  }
  matrix_current_ = true;
  return matrix_;
}

template <class T> Report ContactOperator<T>::factor(const T* shift) {
  for (Index r = 0; r < m_; ++r) shifted_.diagonal[static_cast<std::size_t>(r)] = problem_->R_inverse[static_cast<std::size_t>(r)] + shift[r];
  if (structure_) {
    if (!solve_) {
      solve_ = find_operator("lcaba_refined").make<T>();
      solve_->analyze(structure_);
      solve_work_ = std::make_unique<Workspace<T>>(solve_->workspace());
    }
    const Report report = solve_current_ ? solve_->update_damping(shifted_) : solve_->update(*problem_->mechanism, shifted_);
    solve_current_ = true;
    return report;
  }
  dense_ = problem_->G;
  for (const Index r : off_) {
    dense_.row(r).setZero();
    dense_.col(r).setZero();
  }
  for (Index r = 0; r < m_; ++r) {
    const T& d = shifted_.diagonal[static_cast<std::size_t>(r)];
    if (ScalarTraits<T>::is_infinite(d)) dense_(r, r) = T(1);
    else dense_(r, r) += d;
  }
  const Index lost = ldlt_factor(dense_.data(), m_, m_);
  return lost < 0 ? Report{} : Report{.status = Status::lost_pivot, .where = lost, .of_A = true};
}

template <class T> Report ContactOperator<T>::solve(const T* b, T* x) {
  Report report;
  if (structure_) {
    report = solve_->solve(Eigen::Map<const MatrixX<T>>(b, m_, 1), Eigen::Map<MatrixX<T>>(x, m_, 1), *solve_work_);
  } else {
    std::copy(b, b + m_, x);
    ldlt_solve(dense_.data(), m_, m_, x);
  }
  switch_off(x);
  return report;
}

template class ContactOperator<double>;

}  // namespace delassus::simulation
