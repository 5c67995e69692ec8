#include "simulation/islands_path.h"

#include <algorithm>

#include "algorithms/kit/counted.h"
#include "algorithms/kit/index.h"

namespace delassus::simulation {
namespace {

/// Trees by the first tree of their set, in ascending order.
std::map<Index, std::vector<Index>> sets_of(const std::vector<Index>& first) {
  std::map<Index, std::vector<Index>> out;
  for (std::size_t t = 0; t < first.size(); ++t) out[first[t]].push_back(static_cast<Index>(t));
  return out;
}

}  // namespace

template <class T>
IslandsPath<T>::Mover::Mover(Part<T> of, const Moment<T>& whole) : part(std::move(of)), now(*whole.model, *whole.mechanism, whole.h) {
  now.state = &state, now.problem = &part.problem, now.force = &force, now.rows = &rows;
}

template <class T>
IslandsPath<T>::IslandsPath(std::string_view name, std::shared_ptr<const Structure> structure, Damping<double> damping, Make make, const MakeEquations& make_equations)
    : name_(name), structure_(std::move(structure)), damping_(std::move(damping)), make_(std::move(make)), islands_(*structure_) {
  loops_of_.assign(z(islands_.trees()), -1);
  of_tree_.assign(z(islands_.trees()), nullptr);
  for (const auto& [first, trees] : sets_of(islands_.loops())) {
    Part<T> part = part_of(trees);
    if (part.rows.empty()) continue;
    for (const Index t : trees) loops_of_[z(t)] = static_cast<Index>(loops_.size());
    auto path = make_equations(part.structure, part.damping(damping_));
    loops_.push_back({std::move(part), std::move(path)});
  }
  for (const Loops& l : loops_) (void)make_(l.part.structure, l.part.damping(damping_), l.path, l.part.rows);  // refusals come before the first step
}

/// Of all trees it is the whole: the same structure.
template <class T> Part<T> IslandsPath<T>::part_of(const std::vector<Index>& trees) const {
  Part<T> part(*structure_, islands_, trees);
  if (trees.size() == of_tree_.size()) part.structure = structure_, part.problem = Problem<T>(structure_);
  return part;
}

template <class T> typename IslandsPath<T>::Mover& IslandsPath<T>::mover_of(const std::vector<Index>& trees, const Moment<T>& now) {
  std::unique_ptr<Mover>& m = movers_[trees];
  if (!m) {
    std::vector<Loops*> loops;
    for (const Index t : trees)
      if (loops_of_[z(t)] >= 0) loops.push_back(&loops_[z(loops_of_[z(t)])]);
    std::sort(loops.begin(), loops.end());
    loops.erase(std::unique(loops.begin(), loops.end()), loops.end());
    Part<T> part = part_of(trees);
    const bool alone = loops.size() == 1 && loops[0]->part.bodies == part.bodies;  // its equations are those of the loops, on one structure
    m = std::make_unique<Mover>(alone ? loops[0]->part : std::move(part), now);
    if (alone) m->equations = loops[0]->path;
    else m->loops = std::move(loops);
    m->path = make_(m->part.structure, m->part.damping(damping_), m->equations, m->part.rows);
  }
  m->used = true;
  return *m;
}

/// Who moves apart from whom: looked for again where islands or what rests are not those of the last step.
template <class T> void IslandsPath<T>::group(const Moment<T>& now) {
  resting_.clear();  // none
  for (Index t = 0; now.resting != nullptr && t < islands_.trees(); ++t) resting_.push_back((*now.resting)[z(islands_.root_of(t))]);
  if (resting_ == grouped_resting_ && islands_.islands() == grouped_) return;
  grouped_ = islands_.islands(), grouped_resting_ = resting_;
  moving_.clear();
  of_tree_.assign(z(islands_.trees()), nullptr);
  for (auto& [trees, m] : movers_) m->used = false;
  for (const auto& [first, trees] : sets_of(islands_.islands())) {
    if (!resting_.empty() && resting_[z(first)] != 0) continue;
    moving_.push_back(&mover_of(trees, now));
    for (const Index t : trees) of_tree_[z(t)] = moving_.back();
  }
  std::erase_if(movers_, [](const auto& entry) { return !entry.second->used; });
  whole_ = moving_.size() == 1 && moving_[0]->part.structure == structure_;
}

/// Every island its rows, and where they stand in the whole.
template <class T> void IslandsPath<T>::deal(Moment<T>& now) {
  if (now.resting != nullptr) std::erase_if(*now.rows, [&](const RowSet<T>& s) { return (*now.resting)[z(s.body)] != 0; });
  islands_.join(*now.rows);
  now.island = &islands_.islands();
  group(now);
  if (whole_) return;
  for (Mover* m : moving_) m->rows.clear(), m->at.clear(), m->state.impulses.clear();
  kept_.clear();
  Index row = structure_->rows;
  for (const RowSet<T>& s : *now.rows) {
    Mover& m = *of_tree_[z(islands_.tree_of(s.body))];
    m.rows.push_back(s);
    m.rows.back().body = m.part.own(s.body);
    if (s.kind == RowSet<T>::Kind::contact && s.other != ground) m.rows.back().other = m.part.own(s.other);
    m.at.push_back(row);
    row += s.directions;
  }
  for (const auto& impulse : now.state->impulses) {
    Mover* const m = of_tree_[z(tree_of(impulse.of))];
    (m != nullptr ? m->state.impulses : kept_).push_back(impulse);
  }
}

template <class T> Index IslandsPath<T>::tree_of(const Identity& of) const {
  if (!of_equation(of)) return islands_.tree_of(of[1]);
  return std::max<Index>(0, islands_.tree_of_row()[z(of[1])]);
}

/// The numbers of rows that always hold, to who closes their drift.
template <class T> void IslandsPath<T>::hand_over(Mover& m, const Moment<T>& now) {
  for (Loops* l : m.loops) {
    l->part.take(*now.problem);
    l->path->take(l->part.problem);
  }
}

template <class T> StepReport IslandsPath<T>::move(Mover& m, Moment<T>& now, VectorX<T>& change, VectorX<T>& impulses) {
  m.part.take(*now.problem);
  m.part.gather(*now.force, m.force);
  m.part.gather(now.state->nu, m.state.nu);
  m.now.h = now.h, m.now.ahead = now.ahead, m.now.weight = now.weight;
  StepReport out = m.path->velocities(m.now, m.change, m.impulses);
  if (!out.ok()) return out;
  m.part.scatter(m.change, change);
  Index own = 0;
  if (m.impulses.size() > 0) {
    for (const Index r : m.part.rows) impulses[r] = m.impulses[own++];
    for (std::size_t e = 0; e < m.rows.size(); ++e)
      for (Index k = 0; k < m.rows[e].directions; ++k) impulses[m.at[e] + k] = m.impulses[own++];
  }
  hand_over(m, now);
  return out;
}

template <class T> StepReport IslandsPath<T>::move_whole(Moment<T>& now, VectorX<T>& change, VectorX<T>& impulses) {
  moved_ = 1;
  StepReport out = moving_[0]->path->velocities(now, change, impulses);
  if (!moving_[0]->loops.empty() && out.ok()) hand_over(*moving_[0], now);
  return out;
}

template <class T> StepReport IslandsPath<T>::velocities(Moment<T>& now, VectorX<T>& change, VectorX<T>& impulses) {
  if (!whole_ || islands_.trees() > 1 || now.resting != nullptr) deal(now);  // else one tree, one island
  if (whole_) return move_whole(now, change, impulses);
  Index rows = structure_->rows;
  for (const RowSet<T>& s : *now.rows) rows += s.directions;
  change = VectorX<T>::Constant(structure_->dofs(), T(0));
  impulses = VectorX<T>::Constant(rows, T(0));
  StepReport out;
  out.path = "free";
  moved_ = 0;
  for (Mover* m : moving_) {
    ++moved_;
    const StepReport r = move(*m, now, change, impulses);
    if (r.rows > 0 && out.path != "cones") out.path = r.path;
    out.rows += r.rows, out.islands += r.islands, out.iterations += r.iterations;
    out.residual = std::max(out.residual, r.residual);
    out.report = r.report, out.message = r.message;
    if (!out.ok()) break;
  }
  return out;
}

template <class T> void IslandsPath<T>::remember(const Moment<T>& now, State<T>& next) {
  if (whole_) return moving_[0]->path->remember(now, next);
  next.impulses = kept_;
  State<T> own;
  for (const Mover* m : moving_) {
    m->path->remember(m->now, own);
    next.impulses.insert(next.impulses.end(), own.impulses.begin(), own.impulses.end());
  }
  std::sort(next.impulses.begin(), next.impulses.end(), [](const auto& a, const auto& b) { return a.of < b.of; });
}

template <class T> void IslandsPath<T>::problems(const typename Path<T>::Visit& visit) const {
  for (std::size_t k = 0; k < moved_; ++k) moving_[k]->path->problems(visit);
}

template <class T> Index IslandsPath<T>::bytes() const {
  Index sum = 0;
  for (const Loops& l : loops_) sum += l.part.bytes() + l.path->bytes();
  for (const auto& [trees, m] : movers_) sum += m->part.bytes() + m->path->bytes();
  return sum;
}

template class IslandsPath<double>;
template class IslandsPath<Counted>;

}  // namespace delassus::simulation
