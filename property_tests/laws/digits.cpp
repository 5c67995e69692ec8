#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/digits.h"

#include <algorithm>

#include "algorithms/factors/factor.h"

namespace delassus {

/// The steps of Factor one at a time, and what they leave behind. Steps and columns count in sweep order.
template <class T> class FactorView {
 public:
  static void add_weights(Factor<T>& f, const BlockDiagonal<T>& weights) { f.add_weights(weights); }
  static bool eliminate(Factor<T>& f, int step) { return f.eliminate(step); }
  static SixBySix<T> inertia(const Factor<T>& f, int step) { return f.inertia(step); }
  static const T& d_inverse(const Factor<T>& f, int column) { return f.d_inverse_[static_cast<std::size_t>(column)]; }
  static void backward(const Factor<T>& f, const T* x, Six<T>* forces, T* u) {
    f.scatter(x, forces, u);
    f.backward(f.plan_->active_runs(), forces, u);
  }
  static void forward(const Factor<T>& f, Six<T>* forces, T* u, T* y) {
    f.forward(f.plan_->active_runs(), forces, u);
    f.gather(forces, u, y);
  }
};

namespace digits {
namespace {

using View = FactorView<Stochastic>;

/// Random rounding of this thread for the lifetime of the object.
class Rounding {
 public:
  explicit Rounding(bool on) : before_(random_rounding(on)) {}
  ~Rounding() { random_rounding(before_); }
  Rounding(const Rounding&) = delete;
  Rounding& operator=(const Rounding&) = delete;

 private:
  bool before_;
};

/// Digits of several numbers together.
class Pool {
 public:
  void add(const Stochastic& x, double weight = 1) {
    value_ += weight * x.mean() * x.mean();
    error_ += weight * x.half_width() * x.half_width();
  }
  [[nodiscard]] double digits() const { return common_digits(std::sqrt(value_), std::sqrt(error_)); }

 private:
  double value_ = 0, error_ = 0;
};

double digits_of(const std::vector<Stochastic>& x) {
  Pool pool;
  for (const Stochastic& e : x) pool.add(e);
  return pool.digits();
}

/// A computation, run again and again. Positions in it: 0 weights and R x, 1 … N the steps of the factor, then the
/// sweeps and the difference.
class Run {
 public:
  Run(const Problem<double>& problem, const Damping<double>& damping, const VectorX<double>& x, Computation computation)
      : allowed_(random_rounding(true)), computation_(computation),
        plan_(make_plan(*problem.structure, computation == Computation::apply ? Matrix::M : Matrix::M_R, Branches::all)),
        problem_(problem.cast<Stochastic>()), damping_(damping.cast<Stochastic>()) {
    random_rounding(allowed_);
    const auto m = static_cast<std::size_t>(problem.structure->rows);
    for (const double e : x) x_.emplace_back(e);
    scaled_ = motion_ = result_ = std::vector<Stochastic>(m);
    links_.resize(static_cast<std::size_t>(plan_.steps));
    inertia_.resize(links_.size());
    forces_.resize(links_.size());
    u_.resize(static_cast<std::size_t>(plan_.active_columns()));
    weights_.analyze(*problem.structure);
    factor_.analyze(*problem.structure, plan_);
  }

  /// Rounds at random from position `from` on.
  Report operator()(int from) {
    from_ = from;
    const Report report = factorise();
    if (!report.ok()) return report;
    {
      const Rounding on = rounding(backward_sweep());
      View::backward(factor_, scaled_.data(), forces_.data(), u_.data());
    }
    record_joints(&Link::backward, backward_);
    {
      const Rounding on = rounding(forward_sweep());
      View::forward(factor_, forces_.data(), u_.data(), motion_.data());
    }
    record_joints(&Link::forward, forward_);
    record_accelerations();
    combine();
    return report;
  }

  [[nodiscard]] int backward_sweep() const { return 1 + plan_.steps; }
  [[nodiscard]] int forward_sweep() const { return 2 + plan_.steps; }
  [[nodiscard]] int difference() const { return 3 + plan_.steps; }

  [[nodiscard]] const std::vector<Stochastic>& scaled() const { return scaled_; }
  [[nodiscard]] const std::vector<Link>& links() const { return links_; }  ///< by steps
  [[nodiscard]] const std::vector<Stochastic>& motion() const { return motion_; }
  [[nodiscard]] const std::vector<Stochastic>& result() const { return result_; }
  [[nodiscard]] double backward_digits() const { return backward_.digits(); }

 private:
  Rounding rounding(int position) const { return Rounding(allowed_ && position >= from_); }

  Report factorise() {
    const Rounding prelude = rounding(0);
    Report report = factor_.start(problem_);  // every step is active: nothing is eliminated yet
    if (computation_ == Computation::apply) weights_.assign(damping_);
    else if (report.ok()) report = weights_.assign_inverse(damping_);
    if (!report.ok()) return report;
    scaled_ = x_;
    if (computation_ == Computation::solve) {
      View::add_weights(factor_, weights_);
      weights_.multiply(x_.data(), scaled_.data());
    }
    for (int i = 0; i < plan_.steps; ++i) {
      inertia_[static_cast<std::size_t>(i)] = View::inertia(factor_, i);
      const Rounding step = rounding(1 + i);
      if (!View::eliminate(factor_, i))
        return {Status::lost_pivot, problem_.structure->first_dof[static_cast<std::size_t>(plan_.body[static_cast<std::size_t>(i)])]};
      record_factor(i);
    }
    return report;
  }

  void record_factor(int i) {
    Link& link = links_[static_cast<std::size_t>(i)];
    link = {plan_.body[static_cast<std::size_t>(i)], 0, most_digits, 0, 0, 0, std::nan("")};
    const SixBySix<Stochastic>& H = inertia_[static_cast<std::size_t>(i)];
    Pool pool;
    for (int c = 0; c < 6; ++c)
      for (int r = 0; r < 6; ++r) pool.add(H.column[c][r], inverse(H.column[r][r].mean() * H.column[c][c].mean()));
    link.inertia = pool.digits();
    for_columns(i, [&](int c) { link.pivot = std::min(link.pivot, View::d_inverse(factor_, c).digits()); });
  }

  void record_joints(double Link::*kept, Pool& all) {
    all = Pool();
    for (int i = 0; i < plan_.steps; ++i) {
      Pool joint;
      for_columns(i, [&](int c) {
        const double D = inverse(View::d_inverse(factor_, c).mean());
        joint.add(u_[static_cast<std::size_t>(c)], D);
        all.add(u_[static_cast<std::size_t>(c)], D);
      });
      links_[static_cast<std::size_t>(i)].*kept = joint.digits();
    }
  }

  void record_accelerations() {
    for (std::size_t i = 0; i < links_.size(); ++i) {
      Pool pool;
      for (int r = 0; r < 6; ++r) pool.add(forces_[i][r], std::fabs(inertia_[i].column[r][r].mean()));
      links_[i].acceleration = pool.digits();
    }
  }

  // a = J ν + R⁻¹ x, or f = R x − R J ν.
  void combine() {
    const Rounding on = rounding(difference());
    weights_.multiply(computation_ == Computation::apply ? x_.data() : motion_.data(), result_.data());
    for (std::size_t r = 0; r < result_.size(); ++r)
      result_[r] = computation_ == Computation::apply ? motion_[r] + result_[r] : scaled_[r] - result_[r];
  }

  static double inverse(double x) { return x > 0 ? 1 / x : 0; }
  template <class F> void for_columns(int i, F f) const {
    for (int c = plan_.first_column[static_cast<std::size_t>(i)]; c < plan_.first_column[static_cast<std::size_t>(i) + 1]; ++c) f(c);
  }

  bool allowed_;  // random rounding was on when this was made; otherwise it stays off everywhere
  int from_ = 0;
  Computation computation_;
  Plan plan_;
  Problem<Stochastic> problem_;
  Damping<Stochastic> damping_;
  Factor<Stochastic> factor_;
  BlockDiagonal<Stochastic> weights_;  // R⁻¹ for apply, R for solve
  std::vector<Stochastic> x_, scaled_, motion_, result_, u_;
  std::vector<Six<Stochastic>> forces_;
  std::vector<SixBySix<Stochastic>> inertia_;  // when its step runs
  std::vector<Link> links_;
  Pool backward_, forward_;
};

/// Fills the costs of the stages and, when asked for, of the links, which are in order of steps.
void find_costs(Run& run, Measured& out, bool of_links) {
  const auto left = [&](int position) {  // of the result, rounding at random from a position on
    Pool pool;
    for (int k = 0; k < cost_runs; ++k) {
      if (!run(position).ok()) return 0.0;
      for (const Stochastic& r : run.result()) pool.add(r);
    }
    return pool.digits();
  };
  const int starts[] = {0, 1, run.backward_sweep(), run.forward_sweep(), run.difference()};
  double behind = most_digits;
  for (std::size_t k = out.stages.size(); k-- > 0;) {
    const double before = left(starts[k]);
    out.stages[k].cost = std::max(0.0, behind - before);
    behind = before;
  }
  if (!of_links) return;
  behind = left(run.backward_sweep());
  for (std::size_t i = out.links.size(); i-- > 0;) {
    const double before = left(1 + static_cast<int>(i));
    out.links[i].cost = std::max(0.0, behind - before);
    behind = before;
  }
}

}  // namespace

double Link::fewest() const { return std::min({inertia, pivot, backward, forward, acceleration}); }

Measured measure(const Problem<double>& problem, const Damping<double>& damping, const VectorX<double>& x,
                 Computation computation, std::uint64_t seed, Costs costs) {
  problem.check_sizes();
  damping.check_sizes(*problem.structure);
  require(x.size() == problem.structure->rows, "digits: x must have one entry per row");
  seed_rounding(seed);
  Run run(problem, damping, x, computation);
  Measured out;
  out.report = run(0);
  if (!out.report.ok()) return out;
  out.links = run.links();
  out.motion = run.motion();
  out.result = run.result();
  double pivots = most_digits;
  for (const Link& l : out.links) pivots = std::min(pivots, l.pivot);
  const double unknown = std::nan("");
  out.stages = {{"weights and R x", digits_of(run.scaled()), unknown}, {"factor", pivots, unknown},
                {"backward sweep", run.backward_digits(), unknown}, {"forward sweep and J", digits_of(out.motion), unknown},
                {computation == Computation::apply ? "damping" : "difference", digits_of(out.result), unknown}};
  if (costs != Costs::none) find_costs(run, out, costs == Costs::of_links_too);
  std::sort(out.links.begin(), out.links.end(), [](const Link& a, const Link& b) { return a.body < b.body; });
  return out;
}

}  // namespace digits
}  // namespace delassus
