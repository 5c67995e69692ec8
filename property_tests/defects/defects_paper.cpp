// Defects the paper prints: its algorithms transcribed, with one line as printed and all others corrected, and Algorithm 4
// with every line as printed. In double they are computed in Quad and rounded once: the line is wrong, not the rounding.
#include <array>
#include <type_traits>
#include <utility>

#include "algorithms/factors/block_diagonal.h"
#include "algorithms/kit/test_scalars.h"
#include "property_tests/defects/defects.h"
#include "property_tests/defects/printed_algorithms.h"
#include "reference/definition.h"

namespace delassus::laws {
namespace {

using paper::Lines;

template <class T> class AsPrinted final : public Operator<T> {
  using W = std::conditional_t<ScalarTraits<T>::exact, T, Quad>;

 public:
  explicit AsPrinted(Lines lines) : lines_(lines) {}

 protected:
  void do_analyze() override { weights_.analyze(*this->structure()); }
  Report do_update(const Problem<T>& p, const Damping<T>& d) override {
    problem_ = wide(p);
    return do_update_damping(d);
  }
  Report do_update_damping(const Damping<T>& d) override {
    Damping<W> damping = wide(d);
    weighted_ = weights_.assign_inverse(damping);
    for (const Index r : weights_.off()) damping.diagonal[static_cast<std::size_t>(r)] = W(0);
    R_inverse_ = reference::damping_matrix(*this->structure(), damping);
    R_ = MatrixX<W>::Zero(this->size(), this->size());
    if (weighted_.ok()) fill_R();
    return weighted_;
  }
  Report do_apply(ConstRef<T> f, Ref<T> a, T*) const override {
    return columns(f, a, [&](paper::Transcription<W>& t, const VectorX<W>& x) {
      VectorX<W> on = x;
      weights_.switch_off(on.data());
      VectorX<W> y = t.apply(on);
      if (y.size() == 0) return y;
      y += R_inverse_ * on;
      weights_.switch_off(y.data());
      return y;
    });
  }
  Report do_solve(ConstRef<T> a, Ref<T> f, T*) const override {
    if (!weighted_.ok()) return weighted_;
    return columns(a, f, [](paper::Transcription<W>& t, const VectorX<W>& x) { return t.solve(x); });
  }
  [[nodiscard]] Index do_workspace(Index) const override { return 0; }
  [[nodiscard]] Index do_bytes() const override { return 0; }

 private:
  /// Numbers in W.
  template <class X> static auto wide(const X& x) {
    if constexpr (std::is_same_v<T, W>) return x;
    else return x.template cast<W>();
  }
  void fill_R() {
    Index e = 0;
    const auto fill = [&](Index row, Index rows) {
      const W* const block = weights_.dense(e++);
      for (Index r = 0; r < rows; ++r)
        for (Index c = 0; c < rows; ++c)
          if (block || r == c) R_(row + r, row + c) = block ? block[c * rows + r] : weights_.diagonal(row + r);
    };
    for (const auto& c : this->structure()->link_constraints) fill(c.row, c.rows);
    for (const auto& c : this->structure()->joint_constraints) fill(c.row, c.rows);
  }
  /// A vanishing pivot and a line that is not defined are lost_pivot.
  template <class F> Report columns(ConstRef<T> in, Ref<T> out, F f) const {
    paper::Transcription<W> t(problem_, R_, lines_);
    for (Index k = 0; k < in.cols(); ++k) {
      VectorX<W> x(in.rows());
      for (Index r = 0; r < x.size(); ++r) x[r] = scalar_cast<W>(in(r, k));
      const VectorX<W> y = f(t, x);
      if (y.size() == 0) return {Status::lost_pivot};
      for (Index r = 0; r < y.size(); ++r) out(r, k) = scalar_cast<T>(y[r]);
    }
    return {};
  }

  Lines lines_;
  Problem<W> problem_;
  BlockDiagonal<W> weights_;
  Report weighted_;
  MatrixX<W> R_, R_inverse_;
};

template <Lines L, class T> std::unique_ptr<Operator<T>> make() { return std::make_unique<AsPrinted<T>>(L); }

constexpr std::string_view corrected = "paper_corrected";

template <Lines L> DefectRow row(std::string_view name, std::string what, std::string_view base, bool applies, bool solves) {
  OperatorRow op = find_operator("lcaba");
  op.name = name;
  op.applies = applies;
  op.solves = solves;
  op.apply_error = op.solve_error = ErrorClass::componentwise;
  op.makers = {};
  std::get<Maker<double>>(op.makers) = make<L, double>;
  std::get<Maker<Rational>>(op.makers) = make<L, Rational>;
  return {name, std::move(what), base, op, nullptr, true};
}

template <std::size_t... K> void add_lines(std::vector<DefectRow>& out, std::index_sequence<K...>) {
  using paper::lines;
  (out.push_back(row<paper::only(lines[K].id)>(lines[K].name,
                                               std::string(lines[K].where) + ": " + lines[K].printed + " for " + lines[K].correct,
                                               corrected, paper::of_apply(lines[K].id), !paper::of_apply(lines[K].id))),
   ...);
}

}  // namespace

std::vector<DefectRow> paper_defects() {
  std::vector<DefectRow> all{row<0>(corrected, "Algorithms 1 to 4, merged, every line corrected", {}, true, true),
                             row<paper::algorithm_4>("paper_algorithm_4", "Algorithm 4 with every line as printed", corrected, false, true)};
  add_lines(all, std::make_index_sequence<std::size(paper::lines)>());
  return all;
}

}  // namespace delassus::laws
