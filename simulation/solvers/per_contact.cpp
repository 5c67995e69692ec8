#include "simulation/solvers/per_contact.h"

#include <numbers>

namespace delassus::simulation {
namespace {

/// One contact alone, its tangents scaled: A (rows × rows), b, and λ of the cone ‖λ_t‖ ≤ λ_n.
template <class T> struct Local {
  T A[3][3], b[3], lambda[3];
  Index rows;

  struct Slip {
    T across, along, normal;
  };
  [[nodiscard]] Slip slip(const T& c, const T& s) const {
    const T coupling = A[0][1] * c + (rows > 2 ? A[0][2] * s : T(0));
    const T n = -b[0] / (A[0][0] - coupling);
    T u[2] = {};
    for (Index i = 1; i < rows; ++i) u[i - 1] = b[i] + n * (A[i][0] - A[i][1] * c - (rows > 2 ? A[i][2] * s : T(0)));
    return {c * u[1] - s * u[0], c * u[0] + s * u[1], n};
  }
  bool take(const T& c, const T& s) {
    const Slip at = slip(c, s);
    if (!(at.normal > T(0)) || !(at.along >= T(0)) || !std::isfinite(at.normal)) return false;
    lambda[0] = at.normal;
    lambda[1] = -at.normal * c;
    lambda[2] = -at.normal * s;
    return true;
  }

  bool stick() {
    T L[9], x[3];
    for (Index j = 0; j < rows; ++j) {
      x[j] = -b[j];
      for (Index i = 0; i < rows; ++i) L[j * rows + i] = A[i][j];
    }
    if (ldlt_factor(L, rows, rows) >= 0) return false;
    ldlt_solve(L, rows, rows, x);
    T square(0);
    for (Index i = 1; i < rows; ++i) square += x[i] * x[i];
    if (!(x[0] >= T(0)) || square > x[0] * x[0]) return false;
    std::copy(x, x + rows, lambda);
    return true;
  }

  // Between two angles where d × u_t changes its sign.
  bool bisect(T low, T high, T& angle) {
    const bool rising = slip(std::cos(low), std::sin(low)).across < T(0);
    for (int k = 0; k < 60; ++k) {
      const T middle = low + (high - low) / T(2);
      if (middle == low || middle == high) break;
      ((slip(std::cos(middle), std::sin(middle)).across < T(0)) == rising ? low : high) = middle;
    }
    angle = high;
    return take(std::cos(high), std::sin(high));
  }

  bool slide(T& angle) {
    if (rows == 2) return take(T(1), T(0)) || take(T(-1), T(0));
    constexpr int samples = 32;
    const T width = T(2 * std::numbers::pi / samples);
    for (int k = 0; k < samples; ++k) {  // outwards from the direction of last time
      const T low = angle + width * (T((k + 1) / 2 * (k % 2 == 0 ? 1 : -1)) - T(0.5)), high = low + width;
      const Slip a = slip(std::cos(low), std::sin(low)), c = slip(std::cos(high), std::sin(high));
      if ((a.across < T(0)) == (c.across < T(0)) || !(a.along > T(0) || c.along > T(0))) continue;
      T found = angle;
      if (!bisect(low, high, found)) continue;
      angle = found;
      return true;
    }
    return false;
  }
};

}  // namespace

template <class T> std::string PerContact<T>::refusal(const ContactProblem<T>& p) const {
  for (std::size_t e = 0; e < p.groups.size(); ++e) {
    const ConeRows& c = p.groups[e];
    if (c.cone != Cone::coulomb || p.is_off(c)) continue;
    const std::string group = "group " + std::to_string(e);
    if (p.law != FrictionLaw::exact) return group + " asks for the convex relaxation; per_contact solves exact Coulomb friction";
    if (c.rows > 3) return group + " has " + std::to_string(c.rows) + " rows; per_contact takes one tangent or two";
    for (Index k = 1; k < c.rows; ++k)  // scaled they are a disc only if they are equal
      if (p.friction[static_cast<std::size_t>(c.row + k)] != p.friction[static_cast<std::size_t>(c.row + 1)])
        return group + " has unequal coefficients; per_contact takes equal ones";
  }
  return "";
}

template <class T> void PerContact<T>::do_analyze(const ContactProblem<T>& p) {
  A_.resize(p.rows(), p.rows());
  angle_.assign(p.groups.size(), T(0));
}

template <class T> void PerContact<T>::move(Index r, const T& step, VectorX<T>& lambda) {
  if (step == T(0)) return;
  lambda[r] += step;
  this->u_ += step * A_.col(r);
}

template <class T> void PerContact<T>::row(const ContactProblem<T>& p, const ConeRows& c, Index r, VectorX<T>& lambda) {
  if (!(A_(r, r) > T(0))) return;
  T next = lambda[r] - this->u_[r] / A_(r, r);
  project(p, {c.cone, r, 1}, &next);
  move(r, next - lambda[r], lambda);
}

template <class T> void PerContact<T>::contact(const ContactProblem<T>& p, const ConeRows& c, VectorX<T>& lambda) {
  const auto group = static_cast<std::size_t>(&c - p.groups.data());
  const T& mu = p.friction[static_cast<std::size_t>(c.row + 1)];
  if (!(mu > T(0))) {  // its normal alone
    row(p, {Cone::half_line, c.row, 1}, c.row, lambda);
    return;
  }
  Local<T> local;
  local.rows = c.rows;
  for (Index i = 0; i < c.rows; ++i) {
    local.b[i] = this->u_[c.row + i];
    for (Index j = 0; j < c.rows; ++j) local.b[i] -= A_(c.row + i, c.row + j) * lambda[c.row + j];
    for (Index j = 0; j < c.rows; ++j) local.A[i][j] = A_(c.row + i, c.row + j) * (i > 0 ? mu : T(1)) * (j > 0 ? mu : T(1));
    if (i > 0) local.b[i] *= mu;
    local.lambda[i] = T(0);
  }
  if (local.b[0] < T(0) && !local.stick() && !local.slide(angle_[group])) {
    T trace(0);
    for (Index i = 0; i < c.rows; ++i) trace += A_(c.row + i, c.row + i);
    if (!(trace > T(0))) return;
    const T* const u = this->u_.data() + c.row;
    T next[max_cone_rows];
    for (Index k = 0; k < c.rows; ++k) next[k] = lambda[c.row + k] - u[k] / trace;
    next[0] -= tangent_norm(u, p.friction.data() + c.row, c.rows) / trace;
    ConeProjection<T>::project(next, p.friction.data() + c.row, c.rows);
    for (Index k = 0; k < c.rows; ++k) move(c.row + k, next[k] - lambda[c.row + k], lambda);
    return;
  }
  for (Index k = 0; k < c.rows; ++k) move(c.row + k, (k > 0 ? mu : T(1)) * local.lambda[k] - lambda[c.row + k], lambda);
}

template <class T> SolverReport PerContact<T>::do_solve(const ContactProblem<T>& p, const Wanted& wanted, VectorX<T>& lambda) {
  A_ = this->op_.matrix();
  for (const ConeRows& c : p.groups)
    if (!p.is_off(c))
      for (Index r = c.row; r < c.row + c.rows; ++r) A_(r, r) += p.R_inverse[static_cast<std::size_t>(r)];
  std::fill(angle_.begin(), angle_.end(), T(0));
  this->op_.velocity(lambda.data(), this->u_.data());
  SolverReport report;
  for (;; ++report.iterations) {
    if (residuals(p, lambda.data(), this->u_.data(), this->op_.diagonal().data()).natural <= wanted.velocity && this->judged(p, lambda).natural <= wanted.velocity)
      return report;
    if (report.iterations == wanted.iterations) break;
    for (const ConeRows& c : p.groups) {
      if (p.is_off(c)) continue;
      if (c.cone == Cone::coulomb) contact(p, c, lambda);
      else
        for (Index r = c.row; r < c.row + c.rows; ++r) row(p, c, r, lambda);
    }
    project_all(p, lambda.data());  // the last bits of μ λ_n
  }
  report.status = Status::not_converged;
  return report;
}

template class PerContact<double>;

}  // namespace delassus::simulation
