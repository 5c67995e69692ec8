#include "simulation/solvers/friction_shift.h"

namespace delassus::simulation {

template <class T> void FrictionShift<T>::analyze(const ContactProblem<T>& p) {
  const auto groups = static_cast<Index>(p.groups.size());
  Index cones = 0;
  for (const ConeRows& c : p.groups) cones += c.cone == Cone::coulomb;
  const Index k = p.law == FrictionLaw::exact ? std::min(cones, directions) : 0;
  gamma_.setZero(groups), left_.setZero(groups);
  for (VectorX<T>* const v : {&slope_, &turned_, &moved_, &pushed_}) v->setZero(p.rows());
  basis_.setZero(groups, k + 1);
  small_.setZero(k + 1, k + 1);
  for (VectorX<T>* const v : {&cosine_, &sine_, &answer_}) v->setZero(k);
}

template <class T> void FrictionShift<T>::plain(const ContactProblem<T>& p, const VectorX<T>& u) {
  for (std::size_t e = 0; e < p.groups.size(); ++e) {
    const ConeRows& c = p.groups[e];
    const bool has = c.cone == Cone::coulomb && p.law == FrictionLaw::exact && !p.is_off(c);
    gamma_[static_cast<Index>(e)] = has ? tangent_norm(u.data() + c.row, p.friction.data() + c.row, c.rows) : T(0);
  }
}

template <class T> Index FrictionShift<T>::sliding(const ContactProblem<T>& p, const PrimalNewton<T>& point) const {
  Index count = 0;
  for (std::size_t e = 0; e < p.groups.size(); ++e) count += p.groups[e].cone == Cone::coulomb && !p.is_off(p.groups[e]) && point.slides(e);
  return count;
}

// (1 − Φ') v
template <class T> void FrictionShift<T>::multiply(const ContactProblem<T>& p, PrimalNewton<T>& point, const T* v, T* out) {
  moved_.setZero();
  for (std::size_t e = 0; e < p.groups.size(); ++e) moved_[p.groups[e].row] = slope_[p.groups[e].row] != T(0) ? v[e] : T(0);
  point.multiply_hessian(moved_, turned_);
  point.respond(turned_, pushed_);  // −J d
  moved_ -= pushed_;
  point.multiply_hessian(moved_, turned_);  // −dλ
  for (std::size_t e = 0; e < p.groups.size(); ++e) {
    const ConeRows& c = p.groups[e];
    out[e] = v[e];
    for (Index r = c.row + 1; slope_[c.row] != T(0) && r < c.row + c.rows; ++r) out[e] += slope_[r] * (pushed_[r] + p.R_inverse[static_cast<std::size_t>(r)] * turned_[r]);
  }
}

template <class T>
Report FrictionShift<T>::newton(const ContactProblem<T>& p, PrimalNewton<T>& point, const VectorX<T>& R_inverse, const VectorX<T>& lambda, const VectorX<T>& u, double share) {
  using std::abs;
  using std::sqrt;
  slope_.setZero();
  left_.setZero();
  for (std::size_t e = 0; e < p.groups.size(); ++e) {
    const ConeRows& c = p.groups[e];
    if (c.cone != Cone::coulomb || p.is_off(c)) continue;
    const T* const mu = p.friction.data() + c.row;
    const T phi = tangent_norm(u.data() + c.row, mu, c.rows);
    left_[static_cast<Index>(e)] = phi - gamma_[static_cast<Index>(e)];
    if (point.sticks(e) || !(phi > T(0))) continue;
    slope_[c.row] = T(1);  // marks it
    for (Index r = 1; r < c.rows; ++r) slope_[c.row + r] = mu[r] * mu[r] * u[c.row + r] / phi;
  }
  const Report report = point.linearise(R_inverse, lambda);
  if (!report.ok()) return report;

  // GMRES from δ = 0
  const T start = left_.norm();
  Index k = 0;
  if (start > T(0)) basis_.col(0) = left_ / start;
  auto rest = small_.col(small_.cols() - 1);
  rest.setZero();
  rest[0] = start;
  for (; k < small_.cols() - 1 && abs(rest[k]) > T(1e-3) * start; ++k) {
    auto next = basis_.col(k + 1);
    multiply(p, point, basis_.col(k).data(), next.data());
    for (Index j = 0; j <= k; ++j) {
      small_(j, k) = next.dot(basis_.col(j));
      next -= small_(j, k) * basis_.col(j);
    }
    const T length = next.norm();
    if (length > T(0)) next /= length;
    for (Index j = 0; j < k; ++j) {
      const T above = small_(j, k), below = small_(j + 1, k);
      small_(j, k) = cosine_[j] * above + sine_[j] * below;
      small_(j + 1, k) = cosine_[j] * below - sine_[j] * above;
    }
    const T size = sqrt(small_(k, k) * small_(k, k) + length * length);
    if (!(size > T(0))) break;
    cosine_[k] = small_(k, k) / size, sine_[k] = length / size;
    small_(k, k) = size;
    rest[k + 1] = -sine_[k] * rest[k];
    rest[k] *= cosine_[k];
  }
  for (Index j = k; j-- > 0;) {
    answer_[j] = rest[j];
    for (Index i = j + 1; i < k; ++i) answer_[j] -= small_(j, i) * answer_[i];
    answer_[j] /= small_(j, j);
    gamma_ += T(share) * answer_[j] * basis_.col(j);
  }
  gamma_ += T(1 - share) * left_;
  for (Index e = 0; e < gamma_.size(); ++e) gamma_[e] = std::max(T(0), gamma_[e]);
  return {};
}

template class FrictionShift<double>;

}  // namespace delassus::simulation
