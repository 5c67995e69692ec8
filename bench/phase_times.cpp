#include "bench/phase_times.h"

#include <algorithm>
#include <cmath>

#include "bench/interleaved.h"
#include "bench/text.h"
#include "bench/table1/uses.h"

namespace delassus::bench {

namespace {

constexpr Index most_columns = 8;

/// One operator and what it is asked.
class Subject {
 public:
  Subject(const OperatorRow& row, const Problem<double>& problem, const Damping<double>& damping, const MatrixX<double>& x)
      : row_(row), problem_(problem), damping_(damping), other_(other_damping(damping)), x_(x), y_(x), op_(row.make<double>()) {
    try {
      op_->analyze(problem.structure);
      work_ = std::make_unique<Workspace<double>>(op_->workspace(most_columns));
      ready_ = op_->update(problem, damping).ok();
    } catch (const ModelError&) {  // this row refuses the structure
    }
  }
  [[nodiscard]] bool answers(Phase phase) {
    const bool applies = phase == Phase::product || phase == Phase::product_of_eight, solves = phase == Phase::solve || phase == Phase::solve_of_eight;
    return ready_ && !(applies && !row_.applies) && !(solves && !row_.solves) && ask(phase);
  }
  /// True: ok.
  bool ask(Phase phase) {
    const bool ok = asked(phase);
    if (!ok) failed_[static_cast<std::size_t>(phase)] = true;
    return ok;
  }
  /// An answer that was not ok is none, whatever time it took.
  [[nodiscard]] bool failed(std::size_t phase) const { return failed_[phase]; }

 private:
  bool asked(Phase phase) {
    switch (phase) {
      case Phase::update: return op_->update(problem_, damping_).ok();
      case Phase::damping: return op_->update_damping((odd_ = !odd_) ? other_ : damping_).ok();
      case Phase::product: return op_->apply(x_.leftCols(1), y_.leftCols(1), *work_).ok();
      case Phase::solve: return op_->solve(x_.leftCols(1), y_.leftCols(1), *work_).ok();
      case Phase::product_of_eight: return op_->apply(x_, y_, *work_).ok();
      case Phase::solve_of_eight: return op_->solve(x_, y_, *work_).ok();
    }
    return false;
  }

  const OperatorRow& row_;
  const Problem<double>& problem_;
  const Damping<double>& damping_;
  const Damping<double> other_;
  const MatrixX<double>& x_;
  MatrixX<double> y_;
  std::unique_ptr<Operator<double>> op_;
  std::unique_ptr<Workspace<double>> work_;
  std::array<bool, phase_count> failed_{};
  bool ready_ = false, odd_ = false;
};

std::string pick_cell(const Pick& p) {
  if (p.best.empty()) return "–";
  if (p.chosen == p.best) return p.best + " 1.00";
  return p.chosen + " " + format("%.2f", p.ratio()) + " (" + p.best + ")";
}

std::string times_text(double x) { return std::isnan(x) ? "never" : x >= 1e6 ? format("%.1e", x) : format("%.0f", x); }

std::string chosen_row(const Quantities& q, const Demand& use) {
  const Choice c = choose(q, use);
  return std::string(use.solves > 0 ? c.solve : c.product);
}

}  // namespace

std::vector<RowTimes> phase_times(const Problem<double>& problem, const Damping<double>& damping, const std::vector<const OperatorRow*>& rows, double budget) {
  const Index m = problem.structure->rows;
  const MatrixX<double> x = sample_vector(m * most_columns).reshaped(m, most_columns);
  std::vector<std::unique_ptr<Subject>> subjects;
  std::vector<RowTimes> out;
  std::vector<std::function<void()>> tasks;
  std::vector<std::pair<std::size_t, std::size_t>> to;
  for (const OperatorRow* row : rows) {
    subjects.push_back(std::make_unique<Subject>(*row, problem, damping, x));
    RowTimes& r = out.emplace_back(RowTimes{std::string(row->name), row->holds != Holds::sparse, row->solve_error == ErrorClass::refined, {}});
    r.time.fill(NAN);
    for (std::size_t phase = 0; phase < phase_count; ++phase) {
      if (!subjects.back()->answers(static_cast<Phase>(phase))) continue;
      tasks.push_back([s = subjects.back().get(), phase] { (void)s->ask(static_cast<Phase>(phase)); });
      to.emplace_back(out.size() - 1, phase);
    }
  }
  const std::vector<Spread> spreads = interleaved(tasks, budget);
  for (std::size_t k = 0; k < to.size(); ++k)
    if (!subjects[to[k].first]->failed(to[k].second)) out[to[k].first].time[to[k].second] = spreads[k].low;
  return out;
}

const std::vector<Reuse>& reuses() {
  static const std::vector<Reuse> all{
      {"products", [](double n) { return Demand{.products = n}; }},
      {"products of 8 columns", [](double n) { return Demand{.products = n, .columns = 8}; }},
      {"solves", [](double n) { return Demand{.solves = n}; }},
      {"solves of 8 columns", [](double n) { return Demand{.solves = n, .columns = 8}; }},
      {"solves, each at another damping", [](double n) { return Demand{.solves = n, .dampings = n - 1}; }},
      {"solves with an error bound", [](double n) { return Demand{.solves = n, .certified = true}; }}};
  return all;
}

Pick pick(const std::vector<RowTimes>& rows, const Demand& use, const std::string& chosen) {
  Pick p;
  for (const RowTimes& r : rows) {
    if (use.solves > 0 && use.certified && !r.certified) continue;
    const double t = cost(r.time, use);
    if (r.op == chosen) p.chosen = chosen, p.chosen_time = t;
    if (t < p.best_time || (std::isnan(p.best_time) && !std::isnan(t))) p.best = r.op, p.best_time = t;
  }
  return p;
}

double measured_crossover(const std::vector<RowTimes>& rows, const Reuse& reuse) {
  const auto best = [&](bool is_explicit, double times) {
    std::vector<RowTimes> of;
    for (const RowTimes& r : rows)
      if (r.is_explicit == is_explicit) of.push_back(r);
    return pick(of, reuse.times(times), {}).best_time;
  };
  const auto wins = [&](double times) { return best(true, times) < best(false, times); };
  double none = 0, some = 1;
  while (!wins(some)) {
    none = some, some *= 2;
    if (some > 1e9) return NAN;
  }
  while (some - none > 1) {
    const double middle = std::floor((none + some) / 2);
    (wins(middle) ? some : none) = middle;
  }
  return some;
}

std::vector<std::string> doubtful(const ChoiceRow& row) {
  std::vector<std::string> ops;
  for (const Reuse& reuse : reuses())
    for (const double times : reuse_counts) {
      const Demand use = reuse.times(times);
      const Pick p = pick(row.times, use, chosen_row(row.quantities, use));
      if (!use.certified && p.ratio() > promised_ratio) ops.insert(ops.end(), {p.best, p.chosen});
    }
  std::sort(ops.begin(), ops.end());
  ops.erase(std::unique(ops.begin(), ops.end()), ops.end());
  return ops;
}

void keep_lower(std::vector<RowTimes>& of, const std::vector<RowTimes>& again) {
  for (RowTimes& r : of)
    for (const RowTimes& a : again)
      for (std::size_t phase = 0; r.op == a.op && phase < phase_count; ++phase) r.time[phase] = std::min(r.time[phase], a.time[phase]);
}

ChoiceRow measure_choice(const std::string& scene, const Problem<double>& problem, const Damping<double>& damping, const std::vector<const OperatorRow*>& rows, double budget) {
  constexpr int most_again = 5;
  const Structure& s = *problem.structure;
  ChoiceRow row{scene, s.dofs(), s.rows, count(s), phase_times(problem, damping, rows, budget), 1};
  for (int k = 0; k < most_again; ++k) {
    std::vector<const OperatorRow*> again;
    for (const std::string& op : doubtful(row)) again.push_back(&find_operator(op));
    if (again.empty()) break;
    keep_lower(row.times, phase_times(problem, damping, again, budget));
  }
  return row;
}

double worst_ratio(const std::vector<ChoiceRow>& rows) {
  double worst = NAN;
  for (const ChoiceRow& row : rows)
    for (const Reuse& reuse : reuses())
      for (const double times : reuse_counts) {
        const Demand use = reuse.times(times);
        const Pick p = pick(row.times, use, chosen_row(row.quantities, use));
        if (use.certified || p.best.empty()) continue;
        const double ratio = p.chosen.empty() ? INFINITY : p.ratio();
        worst = std::isnan(worst) ? ratio : std::max(worst, ratio);
      }
  return worst;
}

std::string choices_text(const std::vector<ChoiceRow>& rows) {
  std::string s;
  for (const Reuse& reuse : reuses()) {
    std::vector<std::vector<std::string>> table{{reuse.name, "dofs", "rows", "1", "10", "1000", "explicit from", "predicted"}};
    for (const ChoiceRow& row : rows) {
      std::vector<std::string> line{row.scene, std::to_string(row.dofs), std::to_string(row.rows)};
      for (const double times : reuse_counts) {
        const Demand use = reuse.times(times);
        line.push_back(pick_cell(pick(row.times, use, chosen_row(row.quantities, use))));
      }
      line.push_back(times_text(measured_crossover(row.times, reuse)));
      Demand use = reuse.times(1);
      line.push_back(use.dampings == reuse.times(2).dampings ? times_text(crossover(row.quantities, use)) : "");
      table.push_back(line);
    }
    s += markdown_table(table) + "\n";
  }
  return s + format("Chosen over best: %.2f at most, where no error bound is asked for; promised: %.2f.\n", worst_ratio(rows), promised_ratio);
}

}  // namespace delassus::bench
