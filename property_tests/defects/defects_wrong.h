// What most defects are made of: dense_cholesky behind functions that spoil what goes in or comes out.
#pragma once

#include <algorithm>
#include <type_traits>

#include "algorithms/kit/test_scalars.h"
#include "property_tests/defects/defects.h"

namespace delassus::laws {

/// The numbers an update is about to see.
template <class T> struct Numbers {
  Problem<T>& p;
  const Structure& s;        ///< of the caller's problem
  const Problem<T>& first;   ///< the numbers of the first update since analyze
  int updates;               ///< updates before this one
  Report& report;            ///< when it is not ok, the update ends with it

  /// Calls f(row) for the rows of K of link number `link` of every link constraint that has so many.
  template <class F> void rows_of_link(std::size_t link, F f) const {
    for (const auto& e : s.link_constraints)
      for (Index r = 0; link < e.links.size() && r < e.rows; ++r) f(p.K[static_cast<std::size_t>(e.links[link].first + r)]);
  }
  /// Calls f(first, n) for the n degrees of freedom of every joint.
  template <class F> void joints(F f) const {
    for (Index i = 0; i < s.bodies(); ++i) f(s.first_dof[static_cast<std::size_t>(i)], s.dofs(i));
  }
  /// Calls f(first entry of the row, n) for every joint-level row.
  template <class F> void joint_rows(F f) const {
    for (const auto& j : s.joint_constraints)
      for (Index r = 0; r < j.rows; ++r) f(p.joint_K.begin() + j.first + r * s.dofs(j.body), s.dofs(j.body));
  }
};

/// The damping an update or update_damping is about to see.
template <class T> struct Damped {
  Damping<T>& d;
  const Damping<T>& before;  ///< that of the phase before
  bool alone;                ///< update_damping
};

/// An answer just found.
template <class T> struct Answer {
  bool solve;
  ConstRef<T> x;
  Ref<T>& y;
  Report& report;
  const Structure& s;
  const T* workspace;
  MatrixX<T>& memory;        ///< kept from call to call, m × 16
  int calls;                 ///< before this one
};

/// The right-hand sides of a solve_kkt before it, and the pair after it.
template <class T> struct PairOf {
  bool before;
  VectorX<T>&r1, &r2, &nu, &lambda;
};

/// What a defect does; a function left out does nothing.
template <class T> struct Change {
  void (*structure)(Structure&) = nullptr;
  void (*numbers)(Numbers<T>) = nullptr;
  void (*damping)(Damped<T>) = nullptr;
  void (*answer)(Answer<T>) = nullptr;
  void (*rows)(Problem<T>& p, const Problem<T>& before, Damping<T>& d, const Damping<T>& damping_before) = nullptr;  ///< of update_rows
  void (*pair)(PairOf<T>) = nullptr;
};
enum class Place : std::uint8_t { structure, numbers, damping, answer, rows, pair };

/// Scratch memory of inner operators, one per thread: apply and solve are const.
template <class T> Workspace<T>& scratch(Index scalars) {
  static thread_local std::unique_ptr<Workspace<T>> w;
  if (!w || w->size() < scalars) w = std::make_unique<Workspace<T>>(scalars);
  return *w;
}

/// An operator with a change. Allocates in analyze only (but for copies of damping blocks).
template <class T> class Wrong final : public Operator<T> {
 public:
  explicit Wrong(Change<T> change) : change_(change), inner_(find_operator("dense_cholesky").make<T>()) {}

 protected:
  void do_analyze() override {
    auto s = std::make_shared<Structure>(*this->structure());
    if (change_.structure) change_.structure(*s);
    inner_->analyze(s);
    numbers_ = first_ = Problem<T>(std::move(s));
    damping_ = before_ = Damping<T>::uniform(this->size(), T(0));
    memory_ = MatrixX<T>::Zero(this->size(), 16);
    updates_ = calls_ = 0;
    scratch<T>(std::max(inner_->workspace(16), inner_->kkt_workspace()));
  }
  Report do_update(const Problem<T>& p, const Damping<T>& d) override {
    copy(p, numbers_);
    if (updates_ == 0) copy(p, first_);
    Report r;
    if (change_.numbers) change_.numbers({numbers_, *this->structure(), first_, updates_, r});
    ++updates_;
    return r.ok() ? inner_->update(numbers_, changed(d, false)) : r;
  }
  Report do_update_rows(const Problem<T>& p, const Damping<T>& d) override {
    if (!change_.rows) return do_update(p, d);
    Problem<T> seen = p;
    Damping<T> damped = d;
    change_.rows(seen, numbers_, damped, damping_);
    copy(seen, numbers_);
    damping_ = damped;
    return inner_->update(numbers_, damped);
  }
  Report do_update_damping(const Damping<T>& d) override { return inner_->update_damping(changed(d, true)); }
  Report do_apply(ConstRef<T> f, Ref<T> a, T* workspace) const override { return answer(false, f, a, workspace); }
  Report do_solve(ConstRef<T> a, Ref<T> f, T* workspace) const override { return answer(true, a, f, workspace); }
  Report do_solve_kkt(const T* r1, const T* r2, T* nu, T* lambda, Accuracy wanted, Start, T*) const override {
    using Map = Eigen::Map<const VectorX<T>>;
    Workspace<T>& w = scratch<T>(inner_->kkt_workspace());
    const Index n = this->structure()->dofs(), m = this->size();
    if (!change_.pair)
      return inner_->solve_kkt(Map(r1, n), Map(r2, m), Eigen::Map<VectorX<T>>(nu, n), Eigen::Map<VectorX<T>>(lambda, m), wanted, w);
    VectorX<T> right1 = Map(r1, n), right2 = Map(r2, m), motion = VectorX<T>::Constant(n, T(0)), force = VectorX<T>::Constant(m, T(0));
    change_.pair({true, right1, right2, motion, force});
    const Report r = inner_->solve_kkt(right1, right2, motion, force, wanted, w);
    change_.pair({false, right1, right2, motion, force});
    std::copy_n(motion.data(), n, nu);
    std::copy_n(force.data(), m, lambda);
    return r;
  }
  [[nodiscard]] Index do_workspace(Index) const override { return 1; }
  [[nodiscard]] Index do_bytes() const override { return inner_->bytes(); }

 private:
  static void copy(const Problem<T>& from, Problem<T>& to) {
    to.S = from.S;
    to.H = from.H;
    to.K = from.K;
    to.armature = from.armature;
    to.joint_K = from.joint_K;
  }
  const Damping<T>& changed(const Damping<T>& d, bool alone) {
    if (!change_.damping && !change_.rows) return d;
    damping_ = d;
    if (!change_.damping) return damping_;
    change_.damping({damping_, before_, alone});
    before_ = d;
    return damping_;
  }
  Report answer(bool solve, ConstRef<T> x, Ref<T> y, const T* workspace) const {
    Workspace<T>& w = scratch<T>(inner_->workspace(x.cols()));
    Report r = solve ? inner_->solve(x, y, w) : inner_->apply(x, y, w);
    if (r.ok() && change_.answer) change_.answer({solve, x, y, r, *this->structure(), workspace, memory_, calls_++});
    return r;
  }

  Change<T> change_;
  std::unique_ptr<Operator<T>> inner_;
  Problem<T> numbers_, first_;
  Damping<T> damping_, before_;
  mutable MatrixX<T> memory_;
  mutable int calls_ = 0;
  int updates_ = 0;
};

template <Place P, class F, class T> std::unique_ptr<Operator<T>> make_wrong() {
  Change<T> change;
  if constexpr (P == Place::structure) change.structure = F{};
  if constexpr (P == Place::numbers) change.numbers = F{};
  if constexpr (P == Place::damping) change.damping = F{};
  if constexpr (P == Place::answer) change.answer = F{};
  if constexpr (P == Place::rows) change.rows = F{};
  if constexpr (P == Place::pair) change.pair = F{};
  return std::make_unique<Wrong<T>>(change);
}

/// A row of the table from a lambda that captures nothing: [](auto n) for numbers, damping and answer.
template <Place P, class F> DefectRow defect(std::string_view name, std::string what, F, const char* unseen = nullptr) {
  OperatorRow op = find_operator("dense_cholesky");
  op.name = name;
  op.makers = {make_wrong<P, F, double>, make_wrong<P, F, float>, make_wrong<P, F, Quad>, nullptr, make_wrong<P, F, Rational>, nullptr};
  return {name, std::move(what), "dense_cholesky", op, unseen, P == Place::damping || P == Place::rows || P == Place::pair};
}

/// T of Numbers<T>, Damped<T>, Answer<T>.
template <class> struct ScalarOf;
template <template <class> class C, class T> struct ScalarOf<C<T>> { using type = T; };
template <class X> using scalar_of = typename ScalarOf<std::remove_cvref_t<X>>::type;

/// The vector product p × v.
template <class T> [[nodiscard]] Eigen::Matrix<T, 3, 1> cross_x(const Eigen::Matrix<T, 3, 1>& v) {  // p = (1, 0, 0)
  return {T(0), T(-v[2]), v[1]};
}

}  // namespace delassus::laws
