// The worked example of docs/adding_an_operator.md: an operator, its row, and every law held against it.
#include <iostream>

#include "algorithms/kit/test_scalars.h"
#include "algorithms/operators/aba_sweep.h"
#include "property_tests/unit/allocations.h"
#include "property_tests/laws/laws.h"

using namespace delassus;

// [operator]
// swept_columns: A as a dense matrix, one articulated-body sweep per column; apply is a product.
// Formula A e_j = J M⁻¹ Jᵀ e_j + R⁻¹ e_j.  Cost O(m (n + m)) per update, 2 m² per apply.  Error componentwise.
template <class T> class SweptColumns : public Operator<T> {
 protected:
  void do_analyze() override {
    const Index m = this->structure()->rows;
    sweep_.analyze(this->structure());
    identity_ = MatrixX<T>::Identity(m, m);
    A_ = MatrixX<T>::Zero(m, m);
    work_ = std::make_unique<Workspace<T>>(sweep_.workspace(m));  // everything is allocated here
  }
  Report do_update(const Problem<T>& problem, const Damping<T>& damping) override {
    const Report report = sweep_.update(problem, damping);
    return report.ok() ? sweep_.apply(identity_, A_, *work_) : report;
  }
  Report do_update_damping(const Damping<T>& damping) override {
    const Report report = sweep_.update_damping(damping);
    return report.ok() ? sweep_.apply(identity_, A_, *work_) : report;
  }
  Report do_apply(ConstRef<T> f, Ref<T> a, T*) const override {
    for (Index c = 0; c < f.cols(); ++c) {
      a.col(c).setZero();
      for (Index k = 0; k < f.rows(); ++k) a.col(c) += A_.col(k) * f(k, c);
    }
    return {};
  }
  [[nodiscard]] Index do_workspace(Index) const override { return 0; }
  [[nodiscard]] Index do_bytes() const override { return sweep_.bytes() + 2 * A_.size() * static_cast<Index>(sizeof(T)); }

 private:
  AbaSweep<T> sweep_;
  MatrixX<T> identity_, A_;
  std::unique_ptr<Workspace<T>> work_;
};
// [operator]

// [row]
template <class T> std::unique_ptr<Operator<T>> make() { return std::make_unique<SweptColumns<T>>(); }

const OperatorRow row = {
    .name = "swept_columns", .summary = "A as a dense matrix, one sweep per column", .formula = "A e_j, j = 1 … m",
    .source = "docs/adding_an_operator.md", .cost = "O(m (n + m))", .applies = true, .solves = false,
    .zero_damping = false, .terminates_exactly = true, .apply_error = ErrorClass::componentwise,
    .solve_error = ErrorClass::componentwise,
    .makers = {make<double>, nullptr, nullptr, nullptr, make<Rational>, nullptr}};
// [row]

int main() {
  laws::count_allocations();
  int checked = 0, failed = 0;
  for (const char* family : {"chain", "generic", "humanoid", "redundant", "massless", "no_rows"})
    for (const laws::Outcome& o : laws::check(row, laws::make_case(family, generators::find_family(family).exact_size, 1))) {
      if (o.skipped) continue;
      ++checked;
      if (!o.failed()) continue;
      ++failed;
      std::cout << o.law << " [" << o.label << "] ratio " << o.verdict.ratio << ' ' << o.verdict.note << '\n';
    }
  std::cout << checked << " laws checked, " << failed << " failed\n";
  return failed == 0 && checked > 0 ? 0 : 1;
}
