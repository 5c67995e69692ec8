// Tests of the tests: a right operator made wrong in one respect at a time. Every defect must be caught, every law must
// catch one, and the untouched operator must pass them all.
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <set>
#include <utility>

#include "property_tests/allocations.h"
#include "property_tests/laws.h"

namespace {

using namespace delassus;

enum class Defect : int {
  none, relative_error, transposed_rows, negated, not_linear, numbering, joint_sign, no_armature, forgets_last_constraint,
  parallel_columns, first_update_stays, stale_damping, allocates, reads_workspace, no_empty_size, softens_hard_rows,
  swallows_nan, never_converges, ends
};

constexpr const char* names[] = {
    "none", "relative error 1e-10", "two rows swapped", "negated", "adds |x|", "depends on numbering",
    "joint rows of the wrong sign", "forgets armature", "forgets the last constraint", "all columns like the first",
    "second update ignored", "update_damping ignored", "allocates", "reads the workspace", "refuses empty sizes",
    "hard rows softened silently", "NaN of the problem becomes zero", "never converges"};

/// dense_cholesky with a defect.
template <class T> class Wrong final : public Operator<T> {
 public:
  explicit Wrong(Defect defect) : defect_(defect), inner_(find_operator("dense_cholesky").make<T>()) {}

 protected:
  void do_analyze() override {
    inner_->analyze(this->structure());
    updates_ = 0;
    work_ = std::make_unique<Workspace<T>>(inner_->workspace(columns_));
    changed_ = Problem<T>(this->structure());
    soft_ = Damping<T>::uniform(this->structure()->rows, T(0));
    in_ = MatrixX<T>::Zero(this->structure()->rows, columns_);
  }
  Report do_update(const Problem<T>& p, const Damping<T>& d) override {
    if (defect_ == Defect::first_update_stays && updates_++ > 0) return {};
    if (defect_ == Defect::no_empty_size && d.diagonal.empty()) return {Status::lost_pivot};
    changed_.S = p.S;
    changed_.H = p.H;
    changed_.K = p.K;
    changed_.armature = p.armature;
    changed_.joint_K = p.joint_K;
    if (defect_ == Defect::joint_sign)
      for (T& k : changed_.joint_K) k = -k;
    if (defect_ == Defect::no_armature)
      for (T& a : changed_.armature) a = T(0);
    if (defect_ == Defect::forgets_last_constraint && !changed_.K.empty()) changed_.K.back().setZero();
    if (defect_ == Defect::swallows_nan)
      for (auto& k : changed_.K) k = (k.array() == k.array()).select(k, T(0));
    return inner_->update(changed_, softened(d));
  }
  Report do_update_damping(const Damping<T>& d) override {
    return defect_ == Defect::stale_damping ? Report{} : inner_->update_damping(softened(d));
  }
  Report do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const override { return wrong(f, a, workspace, true); }
  Report do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const override { return wrong(a, f, workspace, false); }
  [[nodiscard]] Index do_workspace(Index) const override { return 1; }
  [[nodiscard]] Index do_bytes() const override { return 0; }

 private:
  const Damping<T>& softened(const Damping<T>& d) {
    if (defect_ != Defect::softens_hard_rows || !d.blocks.empty()) return d;
    for (std::size_t r = 0; r < d.diagonal.size(); ++r)
      soft_.diagonal[r] = d.diagonal[r] == T(0) ? T(0x1p-20) : d.diagonal[r];
    return soft_;
  }

  Report wrong(ConstRef<T> x, Ref<T> y, T* workspace, bool apply) const {
    if (defect_ == Defect::never_converges && !apply) {
      y.setZero();
      return {Status::not_converged};
    }
    auto in = in_.leftCols(x.cols());
    in = x;
    const Report r = apply ? inner_->apply(in, y, *work_) : inner_->solve(in, y, *work_);
    if (r.ok() && y.size() > 0) spoil(x, y, workspace);
    return defect_ == Defect::softens_hard_rows || r.ok() ? r : Report{r.status, r.where};
  }

  void spoil(ConstRef<T> x, Ref<T> y, const T* workspace) const {
    const Index last = y.rows() - 1;
    switch (defect_) {
      case Defect::relative_error: y *= T(1 + 0x1p-33); break;
      case Defect::transposed_rows: y.row(0).swap(y.row(last)); break;
      case Defect::negated: y = -y; break;
      case Defect::not_linear:
        for (Index k = 0; k < y.cols(); ++k) {
          using std::abs;
          y(0, k) += abs(T(x(0, k)));
        }
        break;
      case Defect::numbering: y *= T(1 + 0x1p-20 * number()); break;
      case Defect::parallel_columns:
        for (Index k = 1; k < y.cols(); ++k) y.col(k) = y.col(0);
        break;
      case Defect::allocates: {
        void* volatile block = malloc(static_cast<std::size_t>(8 + y.rows()));
        free(block);
        break;
      }
      case Defect::reads_workspace: y(0, 0) += workspace[0]; break;
      default: break;
    }
  }

  /// Changes when bodies are renumbered.
  [[nodiscard]] int number() const {
    Index n = 0, weight = 1;
    for (const auto& e : this->structure()->link_constraints)
      for (const auto& l : e.links) n += weight++ * l.body;
    for (const auto& e : this->structure()->joint_constraints) n += weight++ * e.body;
    return static_cast<int>(n);
  }

  static constexpr Index columns_ = 16;
  Defect defect_;
  std::unique_ptr<Operator<T>> inner_;
  int updates_ = 0;
  std::unique_ptr<Workspace<T>> work_;
  mutable MatrixX<T> in_;
  Problem<T> changed_;
  Damping<T> soft_;
};

template <Defect D, class T> std::unique_ptr<Operator<T>> make() { return std::make_unique<Wrong<T>>(D); }

template <Defect D> OperatorRow row() {
  OperatorRow r = find_operator("dense_cholesky");
  r.name = names[static_cast<int>(D)];
  r.zero_damping = r.zero_damping && D != Defect::softens_hard_rows;
  r.makers = {};
  std::get<Maker<double>>(r.makers) = make<D, double>;
  std::get<Maker<Rational>>(r.makers) = make<D, Rational>;
  return r;
}

template <int... D> std::vector<OperatorRow> rows(std::integer_sequence<int, D...>) {
  return {row<static_cast<Defect>(D)>()...};
}

std::vector<laws::Case> cases() {
  std::vector<laws::Case> all;
  for (const char* family : {"generic", "humanoid", "massless", "no_rows"})
    for (std::uint64_t seed = 1; seed <= 2; ++seed)
      all.push_back(laws::make_case(family, generators::find_family(family).exact_size, seed));
  return all;
}

/// Prints the matrix defect × law and returns the number of laws and defects that went uncaught.
int uncaught() {
  const std::vector<OperatorRow> all = rows(std::make_integer_sequence<int, static_cast<int>(Defect::ends)>{});
  const std::vector<laws::Case> on = cases();
  std::set<std::string_view> sharp;
  int missed = 0;
  for (const OperatorRow& op : all) {
    std::set<std::string_view> by;
    for (const laws::Case& c : on)
      for (const laws::Outcome& o : laws::check(op, c)) {
        if (o.failed()) by.insert(o.law);
        if (o.failed() && op.name == "none") std::cout << "right operator fails " << o.law << " [" << o.label << "] " << o.verdict.ratio << ' ' << o.verdict.note << '\n';
      }
    std::cout << op.name << ": " << (by.empty() ? "caught by nothing" : "caught by");
    for (const std::string_view law : by) std::cout << " | " << law;
    std::cout << '\n';
    const bool right = op.name == names[0];
    missed += by.empty() == right ? 0 : 1;
    if (!right) sharp.insert(by.begin(), by.end());
  }
  for (const laws::LawRow& law : laws::laws()) {
    if (sharp.count(law.name) || (law.name == "no allocation" && !laws::allocation_count)) continue;
    std::cout << "law that catches nothing: " << law.name << '\n';
    ++missed;
  }
  return missed;
}

}  // namespace

int main() {
  laws::count_allocations();
  const int missed = uncaught();
  std::cout << (missed == 0 ? "every defect is caught, every law catches one\n" : "FAILED\n");
  return missed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
