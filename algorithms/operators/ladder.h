// ladder: ask for an accuracy, pay only for it. The default inverse.
//
// What     f = A⁻¹ a to a wanted accuracy, by the first of these rungs that reaches it:
//            R⁻¹ > 0                  lcaba_refined     without a refinement step where its first answer is good enough
//                                     lcaba_qr          where that stagnates or loses a pivot
//                                     proximal
//                                     kkt_elimination   up to max_dense_rows rows
//            a row is hard (R⁻¹ = 0)  kkt_elimination   up to first_dense_rows rows: a bound, and the dependent rows by name
//                                     proximal          no bound: judged by the last correction
//                                     kkt_elimination   up to max_dense_rows rows
// How      update factors the first rung only, which keeps the numbers: lcaba_refined, or where a number on the diagonal of R⁻¹ is
//          zero kkt_elimination, if that comes first there; another rung is made, analysed and factored
//          when a solve first climbs to it, or an update finds that no earlier one can be used (a lock lets one thread do it, the
//          others wait), and brings its own workspace. Report::rung names who answered, rungs_tried and iterations what it took;
//          Accuracy::steps counts over all rungs.
// Singular when no rung answers, `inconsistent` of any rung is the report, whatever iterate another one has. Otherwise that of the
//          best answer, not_converged: the smallest bound, or where nobody has one the smallest last correction; or of the
//          first rung that says why there is none. dependent_rows() are those of kkt_elimination, which it may factor first.
// Cost     that of the rungs climbed, memory too: O(n + m) until somebody climbs to kkt_elimination. Nothing allocates but the
//          first climb to a rung, and the first damping with blocks.
// Error    refined.
#pragma once

#include <atomic>
#include <deque>
#include <mutex>

#include "algorithms/operators/column_by_column.h"
#include "algorithms/operators/kkt_elimination.h"
#include "algorithms/operators/lcaba_refined.h"
#include "algorithms/operators/operators.h"

namespace delassus {

template <class T> class Ladder : public ColumnByColumn<T> {
 public:
  static constexpr Index max_dense_rows = 1000, first_dense_rows = 150;
  [[nodiscard]] const std::vector<Index>& dependent_rows() const override;
  /// On the first rung; the columns it has no answer to climb one by one.
  bool solve_together(ConstRef<T> a, Ref<T> f, Accuracy wanted, typename ColumnByColumn<T>::Reports& reports, T* workspace) const override;

 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report do_update_rows(const Problem<T>& problem, const Damping<T>& damping) override;
  Report solve_column(const T* a, T* f, Accuracy wanted, T* workspace) const override;
  Report do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy wanted, Start start, T* workspace) const override;
  [[nodiscard]] Index do_workspace(Index columns) const override;
  [[nodiscard]] Index do_kkt_workspace() const override;
  [[nodiscard]] Index do_bytes() const override;

 private:
  enum class State : std::uint8_t { stale, stale_damping, current };
  struct Rung {
    explicit Rung(const OperatorRow& r) : row(&r) {}
    const OperatorRow* row;
    std::unique_ptr<Operator<T>> op;  // nullptr: nobody has climbed here
    std::atomic<State> state = State::stale;
    Report updated = {};
    std::vector<std::unique_ptr<Workspace<T>>> idle;  // not of the first rung, which takes the caller's
    std::size_t lent = 0;                             // workspaces made: as many as there were threads here at once
  };
  class Lent;  // a workspace of a rung, given back at the end
  void keep(const Damping<T>& damping);
  /// One rung takes the numbers, the others when they are needed.
  Report taken(const Problem<T>& problem, const Damping<T>& damping, bool same_motions);
  /// Without a look at blocks.
  [[nodiscard]] bool surely_hard() const;
  void make(Rung& rung) const;
  void make_blocks();
  [[nodiscard]] bool in_wide(Index row) const;
  /// The best report of the rungs, asked one after the other: ask(rung, accuracy, is_first) solves, keep() takes its answer.
  template <class Ask, class Keep> Report climb(Accuracy wanted, const Ask& ask, const Keep& keep_answer) const;
  Report first_usable();
  /// Brings a rung up to the numbers of the last update.
  Report prepare(Rung& rung) const;

  [[nodiscard]] const std::vector<Rung*>& order() const { return hard_ ? of_hard_rows_ : of_soft_rows_; }

  mutable std::deque<Rung> rungs_;
  std::vector<Rung*> of_soft_rows_, of_hard_rows_;
  Rung* dense_ = nullptr;              // kkt_elimination, or none
  bool hard_ = false;                  // R⁻¹ has no inverse
  const LcabaRefined<T>* first_ = nullptr;
  mutable const KktElimination<T>* last_ = nullptr;  // the operator of dense_, when it is made
  const Rung* holder_ = nullptr;       // has the numbers of the last update
  mutable std::mutex preparing_, lending_;
  mutable Problem<T> problem_;         // what the holder was given; current when another was factored since
  mutable bool problem_is_current_ = false;
  Damping<T> plain_, blocks_;          // what was given: without blocks, or with one block per constraint of several rows
  const Damping<T>* damping_ = nullptr;
};

}  // namespace delassus
