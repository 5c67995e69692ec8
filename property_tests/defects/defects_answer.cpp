// Defects of the answer: inaccurate, not linear, dependent on what it must not depend on, refused or allowed wrongly.
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "algorithms/kit/test_scalars.h"
#include "property_tests/defects/defects_wrong.h"

namespace delassus::laws {
namespace {

/// Changes when bodies are renumbered.
int numbering(const Structure& s) {
  Index n = 0, weight = 1;
  for (const auto& e : s.link_constraints)
    for (const auto& l : e.links) n += weight++ * l.body;
  for (const auto& e : s.joint_constraints) n += weight++ * e.body;
  return static_cast<int>(n);
}

std::vector<DefectRow> value_defects() {
  constexpr Place in = Place::answer;
  return {
      defect<in>("one_part_in_1e10", "(1 + 1e-10) A", [](auto a) { a.y *= scalar_of<decltype(a)>(1 + 0x1p-33); }),
      defect<in>("single_precision", "the answer rounded to float", [](auto a) {
        using T = scalar_of<decltype(a)>;
        if constexpr (!ScalarTraits<T>::exact)
          for (Index k = 0; k < a.y.cols(); ++k)
            for (Index r = 0; r < a.y.rows(); ++r) a.y(r, k) = T(static_cast<double>(static_cast<float>(static_cast<double>(a.y(r, k)))));
      }),
      defect<in>("negated", "−A", [](auto a) { a.y = -a.y; }),
      defect<in>("paper_equation_3", "equation (3): Λ⁻¹λ = −g, the inverse with the wrong sign", [](auto a) { if (a.solve) a.y = -a.y; }),
      defect<in>("ends_swapped", "the first and the last row exchanged", [](auto a) { a.y.row(0).swap(a.y.row(a.y.rows() - 1)); }),
      defect<in>("transposed", "A + N, N(first, last) = 1/16: not symmetric", [](auto a) {
        if (a.y.rows() > 1) a.y.row(0) += a.x.row(a.y.rows() - 1) * scalar_of<decltype(a)>(0x1p-4);
      }),
      defect<in>("indefinite", "A − 1e6", [](auto a) { a.y -= a.x * scalar_of<decltype(a)>(0x1p20); }),
      defect<in>("not_linear", "A x + |x₁|", [](auto a) {
        using T = scalar_of<decltype(a)>;
        for (Index k = 0; k < a.y.cols(); ++k) a.y(0, k) += a.x(0, k) < T(0) ? T(-a.x(0, k)) : T(a.x(0, k));
      }),
      defect<in>("depends_on_numbering", "another answer with another numbering of the bodies",
                 [](auto a) { a.y *= scalar_of<decltype(a)>(1 + 0x1p-20 * numbering(a.s)); }),
      defect<in>("row_9", "row 9 of more than 8 is wrong: padding", [](auto a) {
        if (a.y.rows() > 8) a.y.row(8) *= scalar_of<decltype(a)>(1 + 0x1p-20);
      }),
      defect<in>("column_9", "columns from the ninth on are wrong: the tail of the lanes", [](auto a) {
        if (a.y.cols() > 8) a.y.rightCols(a.y.cols() - 8) *= scalar_of<decltype(a)>(2);
      }),
      defect<in>("columns_like_the_first", "every column like the first", [](auto a) {
        for (Index k = 1; k < a.y.cols(); ++k) a.y.col(k) = a.y.col(0);
      }),
      defect<in>("last_column_of_three", "of three or more columns the last stays zero", [](auto a) {
        if (a.y.cols() > 2) a.y.col(a.y.cols() - 1).setZero();
      }),
  };
}

std::vector<DefectRow> conduct_defects() {
  constexpr Place in = Place::answer;
  return {
      defect<in>("previous_answer", "of equal shapes, every second call returns the answer before it", [](auto a) {
        auto memory = a.memory.leftCols(std::min<Index>(a.y.cols(), 16));
        if (a.calls % 2 == 1) a.y.leftCols(memory.cols()) = memory;
        else memory = a.y.leftCols(memory.cols());
      }),
      defect<in>("last_bit", "the last bit depends on the number of calls: something is not initialised", [](auto a) {
        using T = scalar_of<decltype(a)>;
        a.y(0, 0) *= T(1) + T(a.calls) * T(ScalarTraits<T>::exact ? 0.0 : 0x1p-52);
      }),
      defect<in>("shared_scratch", "the answer passes through memory that all threads share", [](auto a) {
        using T = scalar_of<decltype(a)>;
        if constexpr (std::is_same_v<T, double>) {
          static double shared = 0;
          static std::mutex guard;  // a race of meaning, not of memory
          for (Index r = 0; r < a.y.rows(); ++r) {
            { const std::lock_guard lock(guard); shared = a.y(r, 0); }
            std::this_thread::yield();
            { const std::lock_guard lock(guard); a.y(r, 0) = shared; }
          }
        }
      }, "two threads must meet"),
      defect<in>("allocates", "apply and solve allocate", [](auto a) {
        void* volatile block = std::malloc(static_cast<std::size_t>(8 + a.y.rows()));
        std::free(block);
      }, "the test program of the search does not count allocations"),
      defect<in>("reads_the_workspace", "adds what the workspace held", [](auto a) { a.y(0, 0) += a.workspace[0]; }),
      defect<in>("writes_its_input", "overwrites the right-hand side",
                 [](auto a) { const_cast<scalar_of<decltype(a)>*>(a.x.data())[0] *= scalar_of<decltype(a)>(3); }),
      defect<in>("never_converges", "solve ends with not_converged", [](auto a) {
        if (!a.solve) return;
        a.y.setZero();
        a.report.status = Status::not_converged;
      }),
      defect<in>("gives_up_silently", "solve of more than five rows is zero, status ok",
                 [](auto a) { if (a.solve && a.y.rows() > 5) a.y.setZero(); }),
      defect<in>("fails_without_reason", "lost_pivot for three rows and more, in double only", [](auto a) {
        if (std::is_same_v<scalar_of<decltype(a)>, double> && a.y.rows() > 2) a.report.status = Status::lost_pivot;
      }),
      defect<in>("throws", "an exception for seven rows and more, in double only", [](auto a) {
        if (std::is_same_v<scalar_of<decltype(a)>, double> && a.y.rows() > 6) throw std::runtime_error("six rows at most");
      }),
  };
}

/// lcaba with corrections from a residual A f − a in its own arithmetic, added, or subtracted.
template <class T, bool subtracted> class WrongRefinement final : public Operator<T> {
 protected:
  void do_analyze() override {
    direct_->analyze(this->structure());
    forward_->analyze(this->structure());
  }
  Report do_update(const Problem<T>& p, const Damping<T>& d) override {
    const Report r = forward_->update(p, d);
    const Report s = direct_->update(p, d);
    return r.ok() ? s : r;
  }
  Report do_update_damping(const Damping<T>& d) override {
    static_cast<void>(forward_->update_damping(d));
    return direct_->update_damping(d);
  }
  Report do_solve(ConstRef<T> a, Ref<T> f, T*) const override {
    Workspace<T>& w = scratch<T>(std::max(direct_->workspace(1), forward_->workspace(1)));
    for (Index k = 0; k < a.cols(); ++k) {
      if (const Report r = direct_->solve(a.col(k), f.col(k), w); !r.ok()) return r;
      MatrixX<T> residual(a.rows(), 1), correction(a.rows(), 1);
      static_cast<void>(forward_->apply(f.col(k), residual, w));
      residual = a.col(k) - residual;
      static_cast<void>(direct_->solve(residual, correction, w));
      f.col(k) += subtracted ? MatrixX<T>(-correction) : correction;
    }
    return {};
  }
  [[nodiscard]] Index do_workspace(Index) const override { return 1; }
  [[nodiscard]] Index do_bytes() const override { return 0; }

 private:
  std::unique_ptr<Operator<T>> direct_ = find_operator("lcaba").make<T>(), forward_ = find_operator("aba_sweep").make<T>();
};

/// lcaba_refined that does not hear of an accuracy or a number of steps.
template <class T> class Headlong final : public Operator<T> {
 protected:
  void do_analyze() override { op_->analyze(this->structure()); }
  Report do_update(const Problem<T>& p, const Damping<T>& d) override { return op_->update(p, d); }
  Report do_update_damping(const Damping<T>& d) override { return op_->update_damping(d); }
  Report do_solve(ConstRef<T> a, Ref<T> f, T* work) const override {
    Workspace<T> w(work, do_workspace(a.cols()));
    return op_->solve(a, f, w);
  }
  [[nodiscard]] Index do_workspace(Index columns) const override { return op_->workspace(columns); }
  [[nodiscard]] Index do_bytes() const override { return op_->bytes(); }

 private:
  std::unique_ptr<Operator<T>> op_ = find_operator("lcaba_refined").make<T>();
};

template <class Op, class T> std::unique_ptr<Operator<T>> make() { return std::make_unique<Op>(); }

std::vector<DefectRow> refinement_defects() {
  OperatorRow subtracted = find_operator("lcaba_refined"), left_out = subtracted, headlong = subtracted, narrow = subtracted;
  subtracted.name = "refinement_sign";
  subtracted.makers = {make<WrongRefinement<double, true>, double>, nullptr, nullptr, nullptr, make<WrongRefinement<Rational, true>, Rational>, nullptr};
  narrow.name = "refinement_in_double";
  narrow.makers = {make<WrongRefinement<double, false>, double>, nullptr, nullptr, nullptr, nullptr, nullptr};
  left_out.name = "refinement_left_out";
  left_out.makers = find_operator("lcaba").makers;
  headlong.name = "steps_ignored";
  headlong.makers = {make<Headlong<double>, double>, nullptr, nullptr, nullptr, make<Headlong<Rational>, Rational>, nullptr};
  return {{headlong.name, "as many steps as it likes", "lcaba_refined", headlong},
          {subtracted.name, "the correction is subtracted", "lcaba_refined", subtracted, nullptr, true},
          {narrow.name, "one correction, its residual in double", "lcaba_refined", narrow, nullptr, true},
          {left_out.name, "the direct formula under the error class of the refined one", "lcaba_refined", left_out}};
}

}  // namespace

std::vector<DefectRow> answer_defects() {
  std::vector<DefectRow> all = value_defects();
  for (auto part : {conduct_defects, refinement_defects})
    for (DefectRow& d : part()) all.push_back(std::move(d));
  return all;
}

}  // namespace delassus::laws
