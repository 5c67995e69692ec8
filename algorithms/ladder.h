// ladder: ask for an accuracy, pay only for it. The default inverse.
//
// What     f = A⁻¹ a to a wanted accuracy, by the first of these rungs whose certificate reaches it:
//            lcaba_refined     without a refinement step where its first answer is good enough
//            lcaba_qr          where that stagnates or loses a pivot
//            proximal          where a row is hard (R⁻¹ = 0); no certificate: judged by the last correction
//            kkt_elimination   at last, for up to max_dense_rows rows
// How      update factors the first rung only, which keeps the numbers; another rung is factored when a solve first climbs to
//          it (a lock lets one thread do it, the others wait). Report::rung names who answered, rungs_tried
//          and iterations what it took; Accuracy::steps counts over all rungs.
// Singular when no rung answers, the report is that of the answer with the smallest bound, not_converged, or of the first
//          rung that says why there is none.
// Cost     that of the rungs climbed; memory that of all of them.
// Error    refined.
#pragma once

#include <atomic>
#include <deque>
#include <mutex>

#include "algorithms/lcaba_refined.h"

namespace delassus {

template <class T> class Ladder : public ColumnByColumn<T> {
 public:
  static constexpr Index max_dense_rows = 1000;

 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report solve_column(const T* a, T* f, Accuracy wanted, T* workspace) const override;
  [[nodiscard]] Index do_workspace(Index columns) const override;
  [[nodiscard]] Index do_bytes() const override;

 private:
  enum class State : std::uint8_t { stale, stale_damping, current };
  struct Rung {
    Rung(const OperatorRow& r, std::unique_ptr<Operator<T>> o) : row(&r), op(std::move(o)) {}
    const OperatorRow* row;
    std::unique_ptr<Operator<T>> op;
    std::atomic<State> state = State::stale;
    Report updated = {};
  };
  void keep(const Damping<T>& damping);
  [[nodiscard]] bool in_wide(Index row) const;
  Report first_usable();
  /// Brings a rung up to the numbers of the last update.
  Report prepare(Rung& rung) const;

  mutable std::deque<Rung> rungs_;
  Index workspace_ = 0;                // the most a rung needs
  const LcabaRefined<T>* first_ = nullptr;
  mutable std::mutex preparing_;
  mutable Problem<T> problem_;         // what the first rung was given; current when another was factored since
  mutable bool problem_is_current_ = false;
  Damping<T> plain_, blocks_;          // what was given: without blocks, or with one block per constraint of several rows
  const Damping<T>* damping_ = nullptr;
};

}  // namespace delassus
