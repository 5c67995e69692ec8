#include "bench/accuracy/trajectory.h"

#include <algorithm>
#include <cmath>

#include "algorithms/errors/message.h"
#include "bench/interleaved.h"

namespace delassus::accuracy {
namespace {

using Vector = Vector3<double>;
using Matrix = Matrix3<double>;

void place(const Model& model, Poses<double>& poses, const VectorX<double>& q, std::vector<Placement>& out) {
  delassus::poses(model, q, poses);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Matrix& R = poses.rotation[i];
    out.push_back({poses.reference[static_cast<std::size_t>(poses.tree[i])], poses.position[i] + R * model.bodies[i].com, R});
  }
}

/// The rotation vector of R.
Vector logarithm(const Matrix& R) {
  const Vector axial = Vector(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)) / 2;
  const double sine = axial.norm(), angle = std::atan2(sine, (R.trace() - 1) / 2);
  return sine > 0 ? Vector(angle / sine * axial) : Vector(angle, 0, 0);
}

Matrix exponential(const Vector& u) {
  const double angle = u.norm();
  if (!(angle > 0)) return Matrix::Identity();
  Matrix K;
  K << 0, -u[2], u[1], u[2], 0, -u[0], -u[1], u[0], 0;
  return Matrix::Identity() + std::sin(angle) / angle * K + 2 * std::pow(std::sin(angle / 2) / angle, 2) * K * K;
}

Vector apart(const Placement& a, const Placement& b) { return (a.reference - b.reference) + (a.centre - b.centre); }

}  // namespace

Trajectory simulate(const Scene& scene, const Run& run) {
  Trajectory out;
  try {
    simulation::Simulation<double> s(scene, run.settings);
    Poses<double> poses;
    out.seconds = 0;
    for (int k = 0; k < run.instants && out.ok(); ++k) {
      const double start = bench::thread_seconds();
      for (std::int64_t j = 0; j < run.steps_each && out.ok(); ++j) {
        const simulation::StepReport& r = s.step();
        out.iterations += r.iterations;
        out.rejected += r.rejected;
        out.steps += run.settings.error > 0 ? r.taken : 1;
        if (!r.ok())
          out.why_not = "at " + number_text(s.time()) + " s: " + std::string(name(r.report.status)) + (r.message.empty() ? "" : "; ") + r.message;
        else if (out.seconds + bench::thread_seconds() - start > run.longest)
          out.too_long = true, out.why_not = "not within " + number_text(run.longest) + " s of computing: at " + number_text(s.time()) + " s then";
      }
      out.seconds += bench::thread_seconds() - start;
      place(scene.model, poses, s.state().q, out.at.emplace_back());
    }
  } catch (const ModelError& e) {
    out.refused = true;
    out.why_not = e.what();
  }
  if (!out.ok()) out.seconds = std::numeric_limits<double>::quiet_NaN();
  return out;
}

Distance distance(const Trajectory& a, const Trajectory& b) {
  Distance out;
  if (!a.ok() || !b.ok() || a.at.size() != b.at.size()) return out;
  out = {0, 0};
  for (std::size_t k = 0; k < a.at.size(); ++k) {
    double metres = 0, radians = 0;
    for (std::size_t i = 0; i < a.at[k].size(); ++i) {
      metres += apart(a.at[k][i], b.at[k][i]).squaredNorm();
      radians += logarithm(b.at[k][i].rotation.transpose() * a.at[k][i].rotation).squaredNorm();
    }
    const auto bodies = static_cast<double>(a.at[k].size());
    metres = std::sqrt(metres / bodies), radians = std::sqrt(radians / bodies);
    if (!(std::isfinite(metres) && std::isfinite(radians))) return {};
    out = {std::max(out.metres, metres), std::max(out.radians, radians)};
  }
  return out;
}

Trajectory extrapolated(const Trajectory& fine, const Trajectory& coarse, int order) {
  Trajectory out = fine;
  const double by = 1 / (std::pow(2.0, order) - 1);
  for (std::size_t k = 0; k < out.at.size(); ++k)
    for (std::size_t i = 0; i < out.at[k].size(); ++i) {
      Placement& p = out.at[k][i];
      const Placement& far = coarse.at[k][i];
      p.centre += by * apart(fine.at[k][i], far);
      p.rotation = p.rotation * exponential(by * logarithm(far.rotation.transpose() * p.rotation));
    }
  return out;
}

Reference reference_of(const Trajectory& h, const Trajectory& h2, const Trajectory& h4, int order) {
  Reference out;
  for (const Trajectory* t : {&h, &h2, &h4})
    if (!t->ok()) {
      out.why_not = t->why_not;
      out.limit.why_not = "no reference";
      return out;
    }
  const Distance last = distance(h, h2), before = distance(h2, h4);
  out.order = std::log2(before.size() / last.size());
  out.extrapolates = std::abs(out.order - order) <= 0.3;
  if (out.extrapolates) {
    out.limit = extrapolated(h, h2, order);
    out.error = distance(out.limit, extrapolated(h2, h4, order));
  } else {
    out.limit = h;
    const double q = out.order >= 0.5 ? std::min(out.order, static_cast<double>(order)) : 0.5, by = 1 / (std::pow(2.0, q) - 1);  // NaN: ½
    out.error = {by * last.metres, by * last.radians};
  }
  return out;
}

}  // namespace delassus::accuracy
