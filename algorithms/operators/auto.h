// auto: the rows that choose() names, explicit or matrix-free, behind one operator.
//
// What     A f by one row of the table and A⁻¹ a by another, or both by one that keeps a matrix, chosen once in analyze from the
//          structure and from what is expected at one configuration: Demand, of the constructor; without one, `expected` products
//          and certified solves of one column each. Not a row of the table: it computes nothing.
// Formula  that of the chosen rows, bit for bit: nothing is computed here.
// Singular as the chosen rows: what is wrong with products is said by update and by apply, what is wrong with solves by solve.
// Cost     choose.h (`delassus bench --choose` against the fastest row), and one more check of
//          shapes per call. Two rows: update and memory are the sum of both.
// Workspace  that of the more demanding of both.
// Error    certified, apply componentwise and solve refined: rows of the table whose error class is another are not chosen. Uncertified
//          solves are `amplified`, the weakest class among those chosen then.
#pragma once

#include "algorithms/operators/choose.h"
#include "algorithms/operators/operators.h"

namespace delassus {

template <class T> class Auto : public Operator<T> {
 public:
  static constexpr double expected = 100;
  explicit Auto(const Demand& use = {.products = expected, .solves = expected, .certified = true}) : use_(use) {}

  /// Of the last analyze.
  [[nodiscard]] const Choice& chosen() const { return choice_; }
  [[nodiscard]] const std::vector<Index>& dependent_rows() const override;

 protected:
  void do_analyze() override;
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_rows(const Problem<T>& problem, const Damping<T>& damping) override;
  Report do_update_damping(const Damping<T>& damping) override;
  Report do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const override;
  Report do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const override;
  Report do_solve_to(ConstRef<T> a, Ref<T> f, Accuracy wanted, T* workspace) const override;
  Report do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy wanted, Start start, T* workspace) const override;
  [[nodiscard]] Index do_workspace(Index columns) const override;
  [[nodiscard]] Index do_kkt_workspace() const override;
  [[nodiscard]] Index do_bytes() const override;

 private:
  template <class Take> Report both(const Take& take);
  Demand use_;
  Choice choice_;
  std::unique_ptr<Operator<T>> first_, second_;             // second_: of solves, where they have a row of their own
  const Operator<T>*product_ = nullptr, *solve_ = nullptr;  // nullptr: not asked for
};

}  // namespace delassus
