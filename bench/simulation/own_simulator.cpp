#include "bench/simulation/own_simulator.h"

#include <algorithm>

#include "reference/definition.h"
#include "simulation/step.h"

namespace delassus::bench {
namespace {

using Vector = VectorX<double>;
using Set = simulation::RowSet<double>;

/// Every effect that brings rows.
std::vector<std::string> effects_with_rows() {
  std::vector<std::string> out;
  for (const auto& row : simulation::effects())
    for (const char* one : {"loops", "other joints", "joint locks", "couplings", "joint limits", "joint friction", "collision detection", "contacts", "contact friction",
                            "torsional friction", "rolling friction", "restitution", "sleeping"})
      if (row.name == one) out.emplace_back(row.name);
  return out;
}

class Own final : public Simulator {
 public:
  Own(const Scene& scene, const simulation::Settings& settings) : scene_(scene), simulation_(scene_, settings), started_(simulation_.state()), before_(started_) {}

  void reset() override { simulation_.restore(started_); }
  bool step() override {
    before_.q = simulation_.state().q, before_.nu = simulation_.state().nu;
    return simulation_.step().ok();
  }
  [[nodiscard]] std::string why_not() const override { return std::string(name(simulation_.last().report.status)) + " " + simulation_.last().message; }
  [[nodiscard]] Index contacts() const override {
    return std::count_if(simulation_.rows().begin(), simulation_.rows().end(), [](const Set& s) { return s.kind == Set::Kind::contact; });
  }
  [[nodiscard]] Index row_count() const override { return simulation_.last().rows; }
  [[nodiscard]] int iterations() const override { return simulation_.last().iterations; }

  [[nodiscard]] MatrixX<double> M(const Vector& q) override { return reference::mass_matrix(smooth(q, Vector::Zero(scene_.model.dofs()))->problem()); }
  [[nodiscard]] Vector free_acceleration(const Vector& q, const Vector& nu) override {
    const auto s = smooth(q, nu);
    return s->change() / s->settings().step;
  }

  [[nodiscard]] Stepped last() const override {
    const double h = simulation_.settings().step;
    Stepped out;
    out.q = before_.q, out.before = before_.nu, out.after = before_.nu + simulation_.change();
    out.pushed = h * simulation_.force();
    const auto& armature = simulation_.problem().armature;
    out.added = Eigen::Map<const Vector>(armature.data(), static_cast<Index>(armature.size()));
    const auto& plan = simulation_.plan();
    const Vector& impulses = simulation_.impulses();
    Index row = 0;
    for (const Constraint& c : plan.model.constraints) {
      const Index n = delassus::row_count(plan.model, c);
      out.rows.push_back({c, impulses.segment(row, n), Eigen::Map<const Vector>(plan.damping.diagonal.data() + row, n), 0});
      row += n;
    }
    Poses<double> at;
    poses(scene_.model, out.q, at);
    for (const Set& s : simulation_.rows()) {
      out.rows.push_back(of(s, at, impulses.segment(row, s.directions), h));
      row += s.directions;
    }
    return out;
  }

 private:
  static HeldRows of(const Set& s, const Poses<double>& at, const Vector& impulse, double h) {
    HeldRows out;
    out.gap = s.gap;
    if (s.kind == Set::Kind::contact) {
      require(s.directions == 1 || (s.directions == 3 && s.tangents), "own_simulator: contacts with torsional or rolling friction");
      Matrix3<double> axes;
      axes << s.axes.col(1), s.axes.col(2), s.axes.col(0);
      const Vector3<double> reference = at.reference[static_cast<std::size_t>(at.tree[static_cast<std::size_t>(s.body)])];
      out.constraint = contact_in_world(at, s.body, s.other, reference + s.point, axes, s.directions == 3 ? s.coefficient : 0);
      out.impulse = Vector::Zero(3);
      out.impulse.head(s.directions) = impulse;
      out.R_inverse = Vector::Constant(3, s.R_inverse);
      return out;
    }
    out.constraint.kind = s.kind == Set::Kind::limit ? Constraint::Kind::joint_limit : Constraint::Kind::joint_friction;
    out.constraint.a.body = s.body, out.constraint.dof = s.dof, out.constraint.side = s.side, out.constraint.friction = s.effort / h;
    out.impulse = impulse;
    return out;
  }
  /// A step without rows that is too short for anything implicit to count.
  [[nodiscard]] std::unique_ptr<simulation::Simulation<double>> smooth(const Vector& q, const Vector& nu) const {
    Scene scene = scene_;
    scene.q = q;
    scene.motion.nu = nu;
    simulation::Settings settings;
    settings.step = 0x1p-60;
    settings.without = effects_with_rows();
    auto out = std::make_unique<simulation::Simulation<double>>(scene, settings);
    require(out->step().ok(), "own_simulator: a step without rows fails");
    return out;
  }

  Scene scene_;
  simulation::Simulation<double> simulation_;
  simulation::State<double> started_, before_;
};

}  // namespace

std::unique_ptr<Simulator> own_simulator(const Scene& scene, double step, double residual, const std::vector<std::string>& without) {
  simulation::Settings settings;
  settings.step = step, settings.residual = residual, settings.without = without;
  return std::make_unique<Own>(scene, settings);
}

}  // namespace delassus::bench
