#include "algorithms/kit/columns.h"
#include "algorithms/kit/instantiate.h"
#include "algorithms/operators/ladder.h"

#include <algorithm>
#include <utility>

namespace delassus {

namespace {
/// First rows and numbers of rows of the constraints of several rows, ascending.
std::vector<std::pair<Index, Index>> wide_constraints(const Structure& s) {
  std::vector<std::pair<Index, Index>> all;
  const auto add = [&](const auto& c) {
    if (c.rows > 1) all.emplace_back(c.row, c.rows);
  };
  std::for_each(s.link_constraints.begin(), s.link_constraints.end(), add);
  std::for_each(s.joint_constraints.begin(), s.joint_constraints.end(), add);
  std::sort(all.begin(), all.end());
  return all;
}
}  // namespace

template <class T> void Ladder<T>::do_analyze() {
  const Structure& s = *this->structure();
  rungs_.clear();
  of_soft_rows_.clear();
  of_hard_rows_.clear();
  dense_ = nullptr;
  last_ = nullptr;
  hard_ = false;
  of_soft_rows_.reserve(4);
  of_hard_rows_.reserve(4);
  for (const char* name : {"lcaba_refined", "lcaba_qr", "proximal", "kkt_elimination"}) {
    const OperatorRow& row = find_operator(name);
    if (!std::get<Maker<T>>(row.makers) || (row.decides_rank && s.rows > max_dense_rows)) continue;
    Rung& rung = rungs_.emplace_back(row);
    of_soft_rows_.push_back(&rung);
    if (row.zero_damping) of_hard_rows_.push_back(&rung);
    if (row.decides_rank) dense_ = &rung;
  }
  if (dense_ != nullptr && s.rows <= first_dense_rows) std::rotate(of_hard_rows_.begin(), of_hard_rows_.end() - 1, of_hard_rows_.end());
  problem_ = {};
  make(rungs_.front());
  first_ = &dynamic_cast<const LcabaRefined<T>&>(*rungs_.front().op);
  plain_.diagonal.assign(static_cast<std::size_t>(s.rows), T(0));
  blocks_ = {};
}

template <class T> void Ladder<T>::make_blocks() {
  blocks_.diagonal = plain_.diagonal;
  for (const auto& [row, rows] : wide_constraints(*this->structure())) blocks_.blocks.push_back({row, MatrixX<T>::Zero(rows, rows)});
}

// A copy that allocates nothing, but once for blocks.
template <class T> void Ladder<T>::keep(const Damping<T>& damping) {
  if (!damping.blocks.empty() && blocks_.diagonal.empty()) make_blocks();
  damping_ = damping.blocks.empty() ? &plain_ : &blocks_;
  std::copy(damping.diagonal.begin(), damping.diagonal.end(),
            (damping.blocks.empty() ? plain_ : blocks_).diagonal.begin());
  if (damping.blocks.empty()) return;
  auto given = damping.blocks.begin();
  for (auto& kept : blocks_.blocks) {
    const Index rows = kept.R_inverse.rows();
    kept.R_inverse.setZero();
    for (Index r = 0; r < rows; ++r) {
      const T& given_r = damping.diagonal[kept.row + r];
      const bool off = ScalarTraits<T>::is_infinite(given_r);
      kept.R_inverse(r, r) = off ? T(0) : given_r;
      blocks_.diagonal[kept.row + r] = off ? given_r : T(0);
    }
    for (; given != damping.blocks.end() && given->row < kept.row + rows; ++given) {
      const Index at = given->row - kept.row;
      if (at < 0) continue;  // a block over the row of a constraint of one row
      kept.R_inverse.block(at, at, given->R_inverse.rows(), given->R_inverse.rows()) = given->R_inverse;
    }
  }
  for (const auto& b : damping.blocks)
    if (b.R_inverse.rows() == 1 && !in_wide(b.row) && !ScalarTraits<T>::is_infinite(blocks_.diagonal[b.row]))
      blocks_.diagonal[b.row] += b.R_inverse(0, 0);
}

template <class T> bool Ladder<T>::in_wide(Index row) const {
  return std::any_of(blocks_.blocks.begin(), blocks_.blocks.end(),
                     [row](const auto& b) { return row >= b.row && row < b.row + b.R_inverse.rows(); });
}

template <class T> Report Ladder<T>::do_update(const Problem<T>& problem, const Damping<T>& damping) { return taken(problem, damping, false); }

template <class T> Report Ladder<T>::do_update_rows(const Problem<T>& problem, const Damping<T>& damping) { return taken(problem, damping, true); }

template <class T> bool Ladder<T>::surely_hard() const {
  if (dense_ == nullptr || of_hard_rows_.front() != dense_) return false;
  return damping_->blocks.empty() && std::find(damping_->diagonal.begin(), damping_->diagonal.end(), T(0)) != damping_->diagonal.end();
}

template <class T> void Ladder<T>::make(Rung& rung) const {
  rung.op = rung.row->template make<T>();
  rung.op->analyze(this->structure());
  if (&rung != &rungs_.front() && problem_.structure == nullptr) problem_ = Problem<T>(this->structure());
  if (&rung == dense_) last_ = &dynamic_cast<const KktElimination<T>&>(*rung.op);
}

template <class T> Report Ladder<T>::taken(const Problem<T>& problem, const Damping<T>& damping, bool same_motions) {
  keep(damping);
  Rung& rung = surely_hard() ? *dense_ : rungs_.front();
  const bool rows = same_motions && rung.state != State::stale;
  for (Rung& other : rungs_) other.state = State::stale;
  problem_is_current_ = false;
  if (rung.op == nullptr) make(rung);
  rung.updated = rows ? rung.op->update_rows(problem, *damping_) : rung.op->update(problem, *damping_);
  rung.state = State::current;
  holder_ = &rung;
  return first_usable();
}

template <class T> const std::vector<Index>& Ladder<T>::dependent_rows() const {
  return hard_ && dense_ != nullptr && prepare(*dense_).ok() ? dense_->op->dependent_rows() : Operator<T>::dependent_rows();
}

template <class T> Report Ladder<T>::do_update_damping(const Damping<T>& damping) {
  keep(damping);
  for (Rung& rung : rungs_)
    if (rung.state == State::current) rung.state = State::stale_damping;
  return first_usable();
}

// The first rung that can be used, factored; what the first says when none can.
template <class T> Report Ladder<T>::first_usable() {
  hard_ = surely_hard();
  if (!hard_) {
    static_cast<void>(prepare(rungs_.front()));
    hard_ = !first_->invertible().ok();
  }
  Report first;
  for (Rung* const rung : order()) {
    const Report report = prepare(*rung);
    if (report.ok()) return report;
    if (first.ok() || first.status == Status::zero_damping) first = report;
  }
  return first;
}

template <class T> Report Ladder<T>::prepare(Rung& rung) const {
  if (rung.state.load(std::memory_order_acquire) == State::current) return rung.updated;
  const std::lock_guard lock(preparing_);
  if (rung.state == State::stale) {
    if (rung.op == nullptr) make(rung);
    if (!std::exchange(problem_is_current_, true)) holder_ == dense_ ? last_->numbers(problem_) : first_->numbers(problem_);
    rung.updated = rung.op->update(problem_, *damping_);
  }
  if (rung.state == State::stale_damping) rung.updated = rung.op->update_damping(*damping_);
  rung.state.store(State::current, std::memory_order_release);
  return rung.updated;
}

namespace {
bool has_answer(const Report& r) { return r.ok() || r.status == Status::not_converged; }

/// What a report is worth when no rung is ok: a contradiction, an iterate, a reason, nothing.
int worth(const Report& r) {
  switch (r.status) {
    case Status::inconsistent: return 3;
    case Status::not_converged: return 2;
    case Status::zero_damping: return 1;
    case Status::not_supported: return 0;
    default: return has_answer(r) ? 4 : 1;
  }
}

/// Smaller, −1 and NaN being larger than all others.
bool smaller(double x, double y) { return x >= 0 && !(x >= y && y >= 0); }

bool better(const Report& r, const Report& than) {
  if (worth(r) != worth(than)) return worth(r) > worth(than);
  if (r.status == Status::not_converged)
    return r.error_bound >= 0 || than.error_bound >= 0 ? smaller(r.error_bound, than.error_bound)
                                                       : smaller(r.error_estimate, than.error_estimate);
  return than.status == Status::zero_damping && r.status != Status::zero_damping;
}
}  // namespace

template <class T> class Ladder<T>::Lent {
 public:
  Lent(Rung& rung, std::mutex& lending) : rung_(rung), lending_(lending) {
    const std::lock_guard lock(lending_);
    if (rung_.idle.empty()) {
      workspace_ = std::make_unique<Workspace<T>>(std::max(rung_.op->workspace(), rung_.op->kkt_workspace()));
      rung_.idle.reserve(++rung_.lent);
    } else {
      workspace_ = std::move(rung_.idle.back());
      rung_.idle.pop_back();
    }
  }
  Lent(const Lent&) = delete;
  Lent& operator=(const Lent&) = delete;
  ~Lent() {
    const std::lock_guard lock(lending_);
    rung_.idle.push_back(std::move(workspace_));
  }
  Workspace<T>& operator*() { return *workspace_; }

 private:
  Rung& rung_;
  std::mutex& lending_;
  std::unique_ptr<Workspace<T>> workspace_;
};

template <class T>
template <class Ask, class Keep>
Report Ladder<T>::climb(Accuracy wanted, const Ask& ask, const Keep& keep_answer) const {
  Report best{Status::not_supported};
  int steps = 0, tried = 0;
  for (Rung* const rung : order()) {
    if (best.status == Status::not_converged && steps >= wanted.steps) break;
    // who has no bound must show all digits where another one sees a contradiction
    const double accuracy = best.status == Status::inconsistent ? 0 : wanted.error;
    Report report = prepare(*rung);
    if (report.ok()) {
      const Accuracy left{accuracy, wanted.steps - steps};
      report = rung == &rungs_.front() ? ask(*rung->op, left, nullptr) : ask(*rung->op, left, &*Lent(*rung, lending_));
    }
    report.rung = rung->row->name;
    report.rungs_tried = ++tried;
    report.iterations = steps += report.iterations;
    if (!better(report, best)) continue;
    if (has_answer(report)) keep_answer();
    best = report;
    if (best.ok()) break;
  }
  return best;
}

template <class T> Report Ladder<T>::solve_column(const T* a, T* f, Accuracy wanted, T* workspace) const {
  const Index m = this->size();
  const Eigen::Map<const MatrixX<T>> right(a, m, 1);
  Eigen::Map<MatrixX<T>> answer(workspace, m, 1);
  Workspace<T> of_first(workspace + padded(m), first_->workspace());
  return climb(
      wanted, [&](const Operator<T>& op, Accuracy left, Workspace<T>* lent) { return op.solve(right, answer, left, lent ? *lent : of_first); },
      [&] { std::copy_n(workspace, m, f); });
}

template <class T>
bool Ladder<T>::solve_together(ConstRef<T> a, Ref<T> f, Accuracy wanted, typename ColumnByColumn<T>::Reports& reports, T* workspace) const {
  const Rung& first = rungs_.front();
  if (order().front() != &first || !prepare(rungs_.front()).ok()) return false;
  if (!first_->solve_together(a, f, wanted, reports, workspace)) return false;
  for (Index c = 0; c < a.cols(); ++c) {
    T* const answer = f.data() + c * f.outerStride();
    using std::isfinite;
    const bool finite = std::all_of(answer, answer + f.rows(), [](const T& x) { return isfinite(x); });
    reports[c].rung = first.row->name;
    reports[c].rungs_tried = 1;
    if (!reports[c].ok() || !finite) reports[c] = solve_column(a.data() + c * a.outerStride(), answer, wanted, workspace);
  }
  return true;
}

// Each rung begins where the best one before it ended, when a pair was given.
template <class T>
Report Ladder<T>::do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy wanted, Start start, T* workspace) const {
  const Index m = this->size(), n = this->structure()->dofs();
  const Eigen::Map<const MatrixX<T>> of_motion(r1, n, 1), of_rows(r2, m, 1);
  Eigen::Map<MatrixX<T>> motion(workspace, n, 1), forces(workspace + padded(n), m, 1);
  Workspace<T> of_first(workspace + padded(n) + padded(m), first_->kkt_workspace());
  return climb(
      wanted,
      [&](const Operator<T>& op, Accuracy left, Workspace<T>* lent) {
        std::copy_n(nu, start == Start::given ? n : 0, motion.data());
        std::copy_n(lambda, start == Start::given ? m : 0, forces.data());
        return op.solve_kkt(of_motion, of_rows, motion, forces, left, lent ? *lent : of_first, start);
      },
      [&] {
        std::copy_n(motion.data(), n, nu);
        std::copy_n(forces.data(), m, lambda);
      });
}

template <class T> Index Ladder<T>::do_workspace(Index columns) const { return padded(this->size()) + first_->workspace(columns); }

template <class T> Index Ladder<T>::do_kkt_workspace() const {
  return padded(this->structure()->dofs()) + padded(this->size()) + first_->kkt_workspace();
}

template <class T> Index Ladder<T>::do_bytes() const {
  const std::lock_guard lock(preparing_);
  const std::lock_guard lending(lending_);
  Index all = 0;
  for (const Rung& rung : rungs_)
    if (rung.op != nullptr) {
      all += rung.op->bytes();
      for (const auto& w : rung.idle) all += w->size() * static_cast<Index>(sizeof(T));
    }
  return all + static_cast<Index>(problem_.H.size() * sizeof(Matrix6<T>) +
                                  (problem_.S.size() + problem_.K.size()) * sizeof(Vector6<T>) +
                                  (problem_.armature.size() + problem_.joint_K.size() + 2 * plain_.diagonal.size()) * sizeof(T));
}

#define DELASSUS_INSTANTIATE(T) template class Ladder<T>;
DELASSUS_FOR_EACH_ORDERED_SCALAR(DELASSUS_INSTANTIATE)

}  // namespace delassus
