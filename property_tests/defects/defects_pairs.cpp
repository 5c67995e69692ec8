// Defects of the pair (ν, λ), and of rows that come and go.
#include "algorithms/kit/test_scalars.h"
#include "property_tests/defects/defects_wrong.h"

namespace delassus::laws {
namespace {

/// lcaba_refined, and ν off by one part in 1e8 behind a bound that does not know.
template <class T> class Overconfident final : public Operator<T> {
 protected:
  void do_analyze() override { op_->analyze(this->structure()); }
  Report do_update(const Problem<T>& p, const Damping<T>& d) override { return op_->update(p, d); }
  Report do_update_damping(const Damping<T>& d) override { return op_->update_damping(d); }
  Report do_solve_to(ConstRef<T> a, Ref<T> f, Accuracy wanted, T* work) const override {
    Workspace<T> w(work, do_workspace(a.cols()));
    return op_->solve(a, f, wanted, w);
  }
  Report do_solve(ConstRef<T> a, Ref<T> f, T* work) const override { return do_solve_to(a, f, Accuracy::full(), work); }
  Report do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy wanted, Start start, T* work) const override {
    Workspace<T> w(work, op_->kkt_workspace());
    const Index n = this->structure()->dofs(), m = this->size();
    Eigen::Map<VectorX<T>> motion(nu, n), force(lambda, m);
    const Report r = op_->solve_kkt(Eigen::Map<const VectorX<T>>(r1, n), Eigen::Map<const VectorX<T>>(r2, m), motion, force, wanted, w, start);
    motion *= T(1 + 0x1p-27);
    return r;
  }
  [[nodiscard]] Index do_workspace(Index columns) const override { return op_->workspace(columns); }
  [[nodiscard]] Index do_kkt_workspace() const override { return op_->kkt_workspace(); }
  [[nodiscard]] Index do_bytes() const override { return op_->bytes(); }

 private:
  std::unique_ptr<Operator<T>> op_ = find_operator("lcaba_refined").make<T>();
};

DefectRow overconfident() {
  OperatorRow op = find_operator("lcaba_refined");
  op.name = "overconfident";
  op.applies = false;
  op.makers = {[]() -> std::unique_ptr<Operator<double>> { return std::make_unique<Overconfident<double>>(); }, nullptr, nullptr, nullptr, nullptr, nullptr};
  return {op.name, "ν off by one part in 1e8, and a bound that does not say so", "lcaba_refined", op};
}

}  // namespace

std::vector<DefectRow> pair_defects() {
  return {
      defect<Place::damping>("off_is_huge", "R⁻¹ = ∞ read as a large number", [](auto d) {
        using T = scalar_of<decltype(d)>;
        for (T& x : d.d.diagonal)
          if (ScalarTraits<T>::is_infinite(x)) x = T(0x1p100);
      }),
      defect<Place::damping>("off_is_hard", "R⁻¹ = ∞ read as 0", [](auto d) {
        using T = scalar_of<decltype(d)>;
        for (T& x : d.d.diagonal)
          if (ScalarTraits<T>::is_infinite(x)) x = T(0);
      }),
      defect<Place::rows>("moved_rows_stale", "update_rows keeps the K of before", [](auto& p, const auto& before, auto&, const auto&) { p.K = before.K; }),
      defect<Place::rows>("moved_joint_rows_stale", "update_rows keeps the 𝒦 of before", [](auto& p, const auto& before, auto&, const auto&) { p.joint_K = before.joint_K; }),
      defect<Place::rows>("rows_stay_off", "update_rows keeps the R⁻¹ of before", [](auto&, const auto&, auto& d, const auto& before) { d = before; }),
      defect<Place::pair>("r1_forgotten", "solve_kkt takes r₁ = 0", [](auto x) {
        if (x.before) x.r1.setZero();
      }),
      defect<Place::pair>("r1_sign", "solve_kkt takes −r₁", [](auto x) {
        if (x.before) x.r1 = -x.r1;
      }),
      defect<Place::pair>("motion_sign", "solve_kkt gives −ν", [](auto x) {
        if (!x.before) x.nu = -x.nu;
      }),
      defect<Place::pair>("force_sign", "solve_kkt gives −λ: the other convention", [](auto x) {
        if (!x.before) x.lambda = -x.lambda;
      }),
      defect<Place::pair>("last_motion", "solve_kkt leaves the last ν out", [](auto x) {
        if (!x.before && x.nu.size() > 0) x.nu[x.nu.size() - 1] = 0;
      }),
      overconfident(),
  };
}

}  // namespace delassus::laws
