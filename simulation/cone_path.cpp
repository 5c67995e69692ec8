#include "simulation/cone_path.h"

#include <algorithm>

#include "algorithms/errors/message.h"
#include "algorithms/kit/counted.h"

namespace delassus::simulation {
namespace {

template <class T> std::array<Index, 4> pattern_of(const RowSet<T>& s) {
  return {static_cast<Index>(s.kind), s.body, s.kind == RowSet<T>::Kind::contact ? s.other : s.dof, s.directions};
}

/// The numbers in double, of a scalar that counts.
template <class T> void in_double(const Problem<T>& from, Problem<double>& to) {
  const auto all = [](const auto& x, auto& y) {
    for (std::size_t k = 0; k < x.size(); ++k) {
      if constexpr (std::is_same_v<std::decay_t<decltype(x[k])>, T>) y[k] = static_cast<double>(x[k]);
      else y[k] = x[k].unaryExpr([](const T& v) { return static_cast<double>(v); });
    }
  };
  all(from.S, to.S), all(from.armature, to.armature), all(from.H, to.H), all(from.K, to.K), all(from.joint_K, to.joint_K);
}

constexpr Index of_equations = 3, of_more_rows = 4;  // the first entry of their identity

/// Impulses are kept by threes: who the first three rows of a set are, and the others.
template <class T> Identity identity_of(const RowSet<T>& s, Index k) {
  return k == 0 ? s.identity : Identity{of_more_rows, s.identity[1], s.identity[2], s.identity[3]};
}

}  // namespace

bool of_equation(const Identity& of) { return of[0] == of_equations; }

const std::vector<std::string>& usual_solvers() {
  static const std::vector<std::string> names{"proximal", "admm", "pgs"};
  return names;
}

template <class T>
ConePath<T>::ConePath(std::shared_ptr<const Structure> structure, const Damping<double>& damping, std::shared_ptr<EquationsPath<T>> equations,
                      const std::string& solver, double residual, FrictionLaw law, std::vector<Index> rows)
    : base_(std::move(structure)), damping_(damping), equations_(std::move(equations)), residual_(residual), law_(law), row_of_(std::move(rows)) {
  if (!damping_.blocks.empty())
    throw ModelError("", "damping", "is a block, and the scene has contacts, limits or joint friction", "a number or a list; blocks where all rows are equations");
  for (Index r = static_cast<Index>(row_of_.size()); r < base_->rows; ++r) row_of_.push_back(r);
  if (base_->rows == 0) free_ = std::make_unique<FreePath<T>>(base_);
  const std::vector<std::string> names = solver.empty() ? usual_solvers() : std::vector<std::string>{solver};
  for (const std::string& n : names) solvers_.push_back({n, find_solver(n).make(), false});
}

/// The structure of the rows that always hold and those of this step.
template <class T> void ConePath<T>::plan(const std::vector<RowSet<T>>& rows) {
  std::vector<std::array<Index, 4>> pattern;
  for (const RowSet<T>& s : rows) pattern.push_back(pattern_of(s));
  if (structure_ && pattern == pattern_) return;
  pattern_ = std::move(pattern);
  structure_ = std::make_shared<Structure>(*base_);
  for (const RowSet<T>& s : rows) {
    if (s.kind != RowSet<T>::Kind::contact) structure_->add_joint_constraint(1, s.body);
    else if (s.other == ground) structure_->add_link_constraint(s.directions, {s.body});
    else structure_->add_link_constraint(s.directions, {s.body, s.other});
  }
  mechanism_ = std::make_shared<Problem<double>>(structure_);
  if constexpr (std::is_same_v<T, double>) numbers_ = mechanism_;
  else numbers_ = std::make_shared<Problem<T>>(structure_);
  tree_ = std::make_unique<TreeOperators<T>>(structure_);
  const Index n = structure_->dofs(), m = structure_->rows;
  push_ = motion_ = more_ = MatrixX<T>::Constant(n, 1, T(0));
  rows_of_ = MatrixX<T>::Constant(m, 1, T(0));
  problem_ = {};
  problem_.mechanism = mechanism_;
  problem_.law = law_;
  problem_.resize(m);
  if (base_->rows > 0) append(problem_, Cone::free, base_->rows);
  for (const RowSet<T>& s : rows) {
    if (s.kind == RowSet<T>::Kind::joint_friction) append(problem_, Cone::box, 1);
    else if (s.directions == 1) append(problem_, Cone::half_line, 1);
    else append_contact(problem_, 0.0, s.directions - 1);
  }
  for (Asked& a : solvers_) a.analyzed = false;
}

/// The numbers of M̂ and J, and of the cones.
template <class T> void ConePath<T>::fill(const Moment<T>& now) {
  const Problem<T>& from = *now.problem;
  Problem<T>& numbers = *numbers_;
  numbers.S = from.S, numbers.H = from.H, numbers.armature = from.armature;
  std::copy(from.K.begin(), from.K.end(), numbers.K.begin());
  std::copy(from.joint_K.begin(), from.joint_K.end(), numbers.joint_K.begin());
  std::size_t link = base_->link_constraints.size(), joint = base_->joint_constraints.size();
  Index row = base_->rows;
  for (Index r = 0; r < row; ++r) problem_.R_inverse[static_cast<std::size_t>(r)] = damping_.diagonal[static_cast<std::size_t>(r)];
  for (const RowSet<T>& s : *now.rows) {
    const auto r = static_cast<std::size_t>(row);
    problem_.target[row] = static_cast<double>(s.target);
    if (s.kind == RowSet<T>::Kind::contact) {
      const auto& links = structure_->link_constraints[link++].links;
      for (Index k = 0; k < s.directions; ++k) {
        const auto of = s.row(k);
        const Vector3<T> d = s.axes.col(of.axis);
        if (of.spins) {
          numbers.K[links[0].first + k] << of.arm * d, Vector3<T>::Constant(T(0));
          if (s.other != ground) numbers.K[links[1].first + k] << -of.arm * d, Vector3<T>::Constant(T(0));
        } else {
          numbers.K[links[0].first + k] << s.point.cross(d), d;
          if (s.other != ground) numbers.K[links[1].first + k] << -s.point_of_other.cross(d), -d;
        }
        problem_.R_inverse[r + static_cast<std::size_t>(k)] = static_cast<double>(s.R_inverse);
        if (k > 0) problem_.friction[r + static_cast<std::size_t>(k)] = static_cast<double>(s.coefficient);
      }
    } else {
      const auto& to = structure_->joint_constraints[joint++];
      for (Index k = 0; k < structure_->dofs(s.body); ++k) numbers.joint_K[to.first + k] = T(k == s.dof ? s.side : 0);
      problem_.low[r] = -static_cast<double>(s.effort), problem_.high[r] = static_cast<double>(s.effort);
    }
    row += s.directions;
  }
  if constexpr (!std::is_same_v<T, double>) in_double(numbers, *mechanism_);
  tree_->take(numbers);
}

/// Impulses of the rows that were there in the last step.
template <class T> void ConePath<T>::start_warm(const Moment<T>& now) {
  problem_.warm_start = VectorX<double>::Zero(structure_->rows);
  const auto& known = now.state->impulses;  // ascending
  const auto take = [&](const Identity& of, Index row, Index n) {
    const auto it = std::lower_bound(known.begin(), known.end(), of, [](const auto& a, const Identity& b) { return a.of < b; });
    if (it == known.end() || it->of != of) return;
    for (Index k = 0; k < n; ++k) problem_.warm_start[row + k] = static_cast<double>(it->value[static_cast<std::size_t>(k)]);
  };
  Index row = base_->rows;
  for (Index r = 0; r < row; ++r) take({of_equations, row_of_[static_cast<std::size_t>(r)], 0, 0}, r, 1);
  for (const RowSet<T>& s : *now.rows) {
    for (Index k = 0; k < s.directions; k += 3) take(identity_of(s, k), row + k, std::min<Index>(3, s.directions - k));
    row += s.directions;
  }
}

template <class T> StepReport ConePath<T>::solve() {
  StepReport out;
  out.path = name();
  out.rows = structure_->rows;
  out.islands = 1;
  std::string words;
  for (Asked& a : solvers_) {
    const std::string refusal = a.solver->refusal(problem_);
    if (!refusal.empty()) {
      words += (words.empty() ? "" : "; ") + a.name + ": " + refusal;
      continue;
    }
    if (!a.analyzed) a.solver->analyze(problem_);
    a.analyzed = true;
    SolverReport r;
    if constexpr (std::is_same_v<T, double>) r = a.solver->solve(problem_, {.velocity = residual_}, lambda_, tree_.get());
    else r = a.solver->solve(problem_, {.velocity = residual_}, lambda_);
    out.iterations += r.iterations;
    out.residual = r.residuals.natural;
    out.report.status = r.status;
    if (r.ok()) return out;
    words += (words.empty() ? "" : "; ") + a.name + ": " + std::string(delassus::name(r.status)) + " after " + std::to_string(r.iterations) +
             " iterations, residual " + number_text(r.residuals.natural) + " m/s";
  }
  if (out.report.ok()) out.report.status = Status::not_supported;
  out.message = words;
  return out;
}

template <class T> StepReport ConePath<T>::velocities(Moment<T>& now, VectorX<T>& change, VectorX<T>& impulses) {
  asked_ = false;
  if (now.rows->empty()) return base_->rows > 0 ? equations_->velocities(now, change, impulses) : free_->velocities(now, change, impulses);
  plan(*now.rows);
  fill(now);
  start_warm(now);
  StepReport out;
  out.path = name();
  push_.col(0) = now.h * *now.force;
  out.report = tree_->M_inverse(push_, motion_);
  if (!out.report.ok()) return out;
  more_.col(0) = now.state->nu + motion_.col(0);
  tree_->J(more_, rows_of_);
  for (Index r = 0; r < rows_of_.rows(); ++r) problem_.free_velocity[r] = static_cast<double>(rows_of_(r, 0));
  if (!problem_.free_velocity.allFinite()) {  // no solver is asked: they refuse it
    out.report.status = Status::not_finite;
    out.message = "a velocity is not finite: what moves is too fast for steps of this length";
    return out;
  }
  out = solve();
  asked_ = true, solved_ = out.ok();
  if (!out.ok()) return out;
  impulses = lambda_.template cast<T>();
  rows_of_.col(0) = impulses;
  tree_->J_transposed(rows_of_, push_);
  change = motion_.col(0);
  out.report = tree_->M_inverse(push_, motion_);
  change += motion_.col(0);
  if (equations_) equations_->take(*now.problem);
  return out;
}

template <class T> void ConePath<T>::problems(const typename Path<T>::Visit& visit) const {
  if (asked_) visit(problem_, solved_);
}

template <class T> void ConePath<T>::remember(const Moment<T>& now, State<T>& next) {
  next.impulses.clear();
  if (now.rows->empty()) return;
  const auto value = [&](Index r) { return T(lambda_[r]); };
  Index row = base_->rows;
  for (const RowSet<T>& s : *now.rows) {
    for (Index first = 0; first < s.directions; first += 3) {
      typename State<T>::Impulse i{identity_of(s, first), {T(0), T(0), T(0)}};
      for (Index k = 0; k < std::min<Index>(3, s.directions - first); ++k) i.value[static_cast<std::size_t>(k)] = value(row + first + k);
      next.impulses.push_back(i);
    }
    row += s.directions;
  }
  for (Index r = 0; r < base_->rows; ++r) next.impulses.push_back({{of_equations, row_of_[static_cast<std::size_t>(r)], 0, 0}, {value(r), T(0), T(0)}});
  std::sort(next.impulses.begin(), next.impulses.end(), [](const auto& a, const auto& b) { return a.of < b.of; });
}

template <class T> Index ConePath<T>::bytes() const {
  Index sum = (free_ ? free_->bytes() : 0) + (equations_ ? equations_->bytes() : 0);
  if (structure_) sum += static_cast<Index>(sizeof(Vector6<T>)) * 2 * (structure_->K_rows + structure_->dofs()) + static_cast<Index>(sizeof(Matrix6<T>)) * 2 * structure_->bodies();
  return sum;
}

template class ConePath<double>;
template class ConePath<Counted>;

}  // namespace delassus::simulation
