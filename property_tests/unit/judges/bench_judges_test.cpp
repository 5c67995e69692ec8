// The benches themselves: operators that take a known time and do known work, laws known to be broken, growth that is not linear.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "algorithms/kit/test_scalars.h"
#include "bench/cell.h"
#include "bench/page/choosing.h"
#include "bench/phase_times.h"
#include "bench/page/drawing.h"
#include "bench/scaling/growth.h"
#include "bench/page/page.h"
#include "bench/report.h"
#include "bench/scaling/scaling.h"
#include "bench/verify.h"
#include "generators/build.h"
#include "generators/families.h"

namespace delassus::bench::bench_judges_test {
namespace {

/// Adds as often as told, and takes as long; answers solve with a status.
constexpr int of_update = 5, of_new_damping = 7, of_apply = 11, of_solve = 13;
template <class T, Status answer = Status::ok> class Worker final : public Operator<T> {
  static Report work(int additions) {
    if constexpr (std::is_same_v<T, double>) {
      const double end = thread_seconds() + 20e-6 * additions;
      while (thread_seconds() < end) {}
    }
    T sum(0);
    for (int k = 0; k < additions; ++k) sum += T(1);
    return {};
  }
  void do_analyze() override {}
  Report do_update(const Problem<T>&, const Damping<T>&) override { return work(of_update); }
  Report do_update_damping(const Damping<T>&) override { return work(of_new_damping); }
  Report do_apply(ConstRef<T> f, Ref<T> a, T*) const override { return a = f, work(of_apply); }
  Report do_solve(ConstRef<T> a, Ref<T> f, T*) const override {
    f = a;
    return work(of_solve), Report{answer};
  }
  [[nodiscard]] Index do_workspace(Index) const override { return 17; }
  [[nodiscard]] Index do_bytes() const override { return 4000; }
};

template <template <class> class Op> OperatorRow row_of(bool applies, bool solves) {
  OperatorRow row = find_operator("dense_cholesky");
  row.name = "worker";
  row.applies = applies;
  row.solves = solves;
  row.makers = {[] { return std::unique_ptr<Operator<double>>(new Op<double>); }, nullptr, nullptr,
                [] { return std::unique_ptr<Operator<Counted>>(new Op<Counted>); }, nullptr, nullptr};
  return row;
}
template <class T> using Right = Worker<T>;
template <class T> using WithoutAnswer = Worker<T, Status::not_converged>;

SceneResult scene(const std::string& name) {
  SceneResult s;
  s.name = name;
  return s;
}

generators::Built one_body() { return generators::build(generators::find_family("chain").make(1, 1)); }

TEST(Cell, CountsWhatEachPhaseDoes) {
  const auto built = one_body();
  const auto count = [&](bool applies, bool solves) { return count_operations(row_of<Right>(applies, solves), built.problem, built.damping); };
  const Operations both = count(true, true), apply = count(true, false), solve = count(false, true);
  EXPECT_EQ(both.update, of_update);
  EXPECT_EQ(both.new_damping, of_new_damping);
  EXPECT_EQ(both.apply, of_apply);
  EXPECT_EQ(both.solve, of_solve);
  EXPECT_EQ(apply.solve, -1);
  EXPECT_EQ(solve.apply, -1);
  OperatorRow uncounted = row_of<Right>(true, true);
  std::get<Maker<Counted>>(uncounted.makers) = nullptr;
  EXPECT_EQ(count_operations(uncounted, built.problem, built.damping).update, -1);
}

TEST(Cell, TimesEachPhaseApart) {
  const auto built = one_body();
  const Cell cell = measure(row_of<Right>(true, true), built.problem, built.damping, {0.02, 0.1});
  const auto expect = [](const Timing& t, int additions) {
    EXPECT_GE(t.lowest, 20 * additions) << "of one call, not of one divided by their number";
    EXPECT_LT(t.lowest, 20 * (additions + 1.5)) << "or this machine never had 0.3 ms in one piece";
    EXPECT_GE(t.median, t.lowest);
  };
  expect(cell.time.update, of_update);
  expect(cell.time.new_damping, of_new_damping);
  expect(cell.time.apply, of_apply);
  expect(cell.time.solve, of_solve);
  EXPECT_TRUE(cell.time.analyze.measured());
  EXPECT_LT(cell.time.analyze.lowest, 20 * of_update);
  EXPECT_GE(cell.bytes, 4000);
  EXPECT_EQ(cell.workspace_bytes, 17 * 8);
  EXPECT_EQ(cell.operations.update, of_update);
  EXPECT_EQ(cell.solve_status, "ok");
  const Cell no_apply = measure(row_of<Right>(false, true), built.problem, built.damping, {0.001, 0.1});
  EXPECT_FALSE(no_apply.time.apply.measured());
  const Cell slow = measure(row_of<Right>(true, true), built.problem, built.damping, {0.001, 1e-4});
  EXPECT_EQ(slow.operations.update, -1) << "too slow to be counted";
}

TEST(Stopwatch, OneLongCallIsNotTheTime) {
  int calls = 0;
  const auto busy_once = [&] {
    const double end = thread_seconds() + (++calls == 1 ? 20e-3 : 10e-6);
    while (thread_seconds() < end) {}
  };
  const Timing t = stopwatch(busy_once, 0.005);
  EXPECT_GE(t.lowest, 10);
  EXPECT_LT(t.lowest, 10000);
  EXPECT_GE(t.batches, 3);
}

TEST(Cell, SaysWhereThereIsNoAnswer) {
  const auto built = one_body();
  const Cell cell = measure(row_of<WithoutAnswer>(false, true), built.problem, built.damping, {0.001, 0.1});
  EXPECT_EQ(cell.solve_status, "not_converged");
  EXPECT_EQ(cell.update_status, "ok");
  Results r;
  r.scenes.push_back(scene("scene"));
  r.scenes[0].cells.push_back(cell);
  EXPECT_NE(text_table(r).find("not_converged"), std::string::npos);
}

std::vector<std::int64_t> counted(double order, std::int64_t constant) {
  std::vector<std::int64_t> f;
  for (double n = 10; n < 2000; n *= 2) f.push_back(constant + std::llround(40 * std::pow(n, order)));
  return f;
}

TEST(Growth, OnlyLinearGrowthPasses) {
  EXPECT_TRUE(grows_linearly(counted(1, 0)));
  EXPECT_TRUE(grows_linearly(counted(1, 12345)));
  EXPECT_TRUE(grows_linearly(counted(1.009, 0)));
  for (const double order : {0.98, 1.02, 1.1, 1.5, 2.0, 3.0}) {
    EXPECT_FALSE(grows_linearly(counted(order, 100))) << order;
    for (const double p : orders(counted(order, 100))) EXPECT_NEAR(p, order, 0.01);
  }
  std::vector<std::int64_t> f = counted(1, 7);
  f.back() += f.back() / 50;
  EXPECT_FALSE(grows_linearly(f)) << "the last size alone";
  f = counted(1, 7);
  f.front() -= 9;
  EXPECT_FALSE(grows_linearly(f)) << "the first size alone";
  EXPECT_FALSE(grows_linearly({-1, -1, -1, -1}));
  EXPECT_FALSE(grows_linearly({0, 0, 0, 0}));
  EXPECT_FALSE(grows_linearly({5, 5, 5, 5}));
  EXPECT_FALSE(grows_linearly({10, 20}));
  EXPECT_TRUE(no_work({0, 0, 0}));
  EXPECT_FALSE(no_work({0, 0, 1}) || no_work({-1, -1, -1}) || no_work({}));
}

/// c₀ + c₁ s + c₂ s log₂ s + c₃ s² + c₄ s³ at 4, 8, 16, …
std::vector<double> sums(double c0, double c1, double c2, double c3, double c4, int sizes = 9) {
  std::vector<double> f;
  for (double s = 4; sizes-- > 0; s *= 2) f.push_back(c0 + c1 * s + c2 * s * std::log2(s) + c3 * s * s + c4 * s * s * s);
  return f;
}
const std::vector<int> powers{0, 1, 1, 2, 3};

TEST(Scaling, TheLeadingPowerIsMeasuredExactly) {
  const auto order = [](const std::vector<double>& f, const std::vector<double>& declared) { return order_of(powers, f, declared); };
  const Order constant = order(sums(7, 0, 0, 0, 0), sums(1, 0, 0, 0, 0)), linear = order(sums(900, 7, 0, 0, 0), sums(0, 1, 0, 0, 0)), log = order(sums(900, 70, 7, 0, 0), sums(0, 5, 1, 0, 0)),
              square = order(sums(900, 70, 700, 7, 0), sums(0, 1, 0, 1, 0)), cube = order(sums(900, 7000, 700, 70, 7), sums(0, 0, 0, 0, 1));
  EXPECT_DOUBLE_EQ(constant.measured, 0);
  EXPECT_DOUBLE_EQ(linear.measured, 1);
  EXPECT_DOUBLE_EQ(log.measured, 1);
  EXPECT_DOUBLE_EQ(square.measured, 2);
  EXPECT_DOUBLE_EQ(cube.measured, 3);
  EXPECT_EQ(linear.logarithms, 0);
  EXPECT_EQ(log.logarithms, 1);
  EXPECT_EQ(square.logarithms, 0);
  for (const Order& o : {constant, linear, log, square, cube}) EXPECT_TRUE(o.agree()) << o.measured << " " << o.declared;
}

TEST(Scaling, WhatIsMoreOrLessThanDeclaredIsNot) {
  EXPECT_FALSE(order_of(powers, sums(900, 70, 0, 0.01, 0), sums(0, 1, 0, 0, 0)).agree()) << "a hundredth of an operation more per pair";
  EXPECT_FALSE(order_of(powers, sums(900, 7, 7, 0, 0), sums(0, 1, 0, 0, 0)).agree()) << "a logarithm more";
  EXPECT_FALSE(order_of(powers, sums(900, 70, 0, 0, 0), sums(0, 1, 0, 1, 0)).agree()) << "declared too high";
  EXPECT_FALSE(order_of(powers, sums(900, 70, 0, 0, 0), sums(0, 1, 1, 0, 0)).agree()) << "a logarithm too many";
  EXPECT_FALSE(order_of(powers, sums(900, 70, 0, 7, 0, 3), sums(0, 1, 0, 1, 0)).agree()) << "sizes are too few";
  EXPECT_TRUE((Order{1.019, 1, 0}.agree()));
  EXPECT_FALSE((Order{1.021, 1, 0}.agree()) || (Order{0.979, 1, 0}.agree()) || Order{}.agree());
}

TEST(Scaling, AFitHasToArriveAtTheLastSize) {
  std::vector<double> sizes, as_declared, more;
  std::vector<std::vector<double>> terms;
  for (double s = 4; s < 40; s += 4) {
    const double irregular = s * s + std::fmod(7 * s, 5) * s;
    sizes.push_back(s), terms.push_back({s, irregular});
    as_declared.push_back(100 * s + 3 * irregular), more.push_back(100 * s + 3 * irregular + 0.05 * s * s * s);
  }
  EXPECT_NEAR(order_by_fit(sizes, as_declared, terms).measured, order_by_fit(sizes, as_declared, terms).declared, 1e-9);
  EXPECT_FALSE(order_by_fit(sizes, more, terms).agree());
  EXPECT_FALSE(order_by_fit({4, 8, 12}, {1, 2, 3}, {terms[0], terms[1], terms[2]}).agree()) << "sizes are too few";
}

TEST(Scaling, EveryOperatorDeclaresItsOrders) {
  for (const OperatorRow& row : operators()) EXPECT_NO_THROW(static_cast<void>(declared_orders(row.name))) << row.name;
  EXPECT_THROW(static_cast<void>(declared_orders("nosuch")), std::logic_error);
}

LawResult law(const char* name, double ratio, bool passed, const char* skipped = "") { return {name, ratio, passed, skipped, "", false}; }

/// Two scenes and two operators: three laws hold, two are broken, one of them without a ratio, two were not checked.
Results some_results() {
  Results r;
  for (const char* op : {"first", "second"}) r.operators.emplace_back().name = op;
  for (const char* name : {"a", "b"}) {
    r.laws.push_back({name, "identity", "bound"});
    r.scenes.push_back(scene(std::string("scene_") + name));
    for (const char* op : {"first", "second"}) {
      Cell cell;
      cell.op = op;
      r.scenes.back().cells.push_back(cell);
    }
  }
  r.scenes[0].cells[0].laws = {law("a", 29.5, true), law("b", 30.5, false)};
  r.scenes[0].cells[1].laws = {law("a", HUGE_VAL, false), law("b", 2, true)};
  r.scenes[1].cells[0].laws = {law("a", 1, true), law("b", 0, true, "has no solve")};
  r.scenes[1].cells[1].laws = {law("a", 0, true, "has no solve")};
  return r;
}

TEST(Results, BrokenLawsAreCountedAndShown) {
  const Results r = some_results();
  EXPECT_EQ(r.checked(), 5);
  EXPECT_EQ(r.failed(), 2);
  EXPECT_EQ(r.left_out(), 0) << "what does not apply is not left out";
  EXPECT_EQ(exit_code(r), 1);
  EXPECT_EQ(r.scenes[0].cells[0].worst()->law, "b");
  EXPECT_TRUE(std::isinf(r.scenes[0].cells[1].worst()->ratio)) << "no ratio is the worst";
  EXPECT_EQ(r.scenes[1].cells[1].worst(), nullptr);
  const nlohmann::json j = r;
  EXPECT_EQ(j["failed"], 2);
  EXPECT_EQ(j["checked"], 5);
  EXPECT_EQ(j["scenes"][0]["operators"][0]["laws"][1]["passed"], false);
  EXPECT_EQ(j["scenes"][0]["operators"][1]["laws"][0]["ratio"], "infinity");
  const std::string text = text_table(r);
  const auto times = [](const std::string& of, const std::string& word) {
    int n = 0;
    for (std::size_t at = 0; (at = of.find(word, at)) != std::string::npos; at += word.size()) ++n;
    return n;
  };
  EXPECT_EQ(times(text, "FAILED  scene_a"), 2);
  EXPECT_EQ(times(text, "1 FAILED, worst"), 2);
  EXPECT_EQ(times(text, "hold, worst"), 1);
  EXPECT_EQ(times(text, "not checked"), 1);
  const std::string html = page(r);
  EXPECT_NE(html.find("✗ 2</span>"), std::string::npos);
  EXPECT_EQ(html.find("all hold"), std::string::npos);
  EXPECT_EQ(times(html, "Laws that failed"), 1);
  EXPECT_EQ(times(html, "<li><code>first · scene_a · b</code>"), 1);
  EXPECT_EQ(times(html, "<li><code>second · scene_a · a</code>"), 1);
}

TEST(Results, WhatWasLeftOutIsSaidWithItsCommand) {
  Results r = some_results();
  for (SceneResult& s : r.scenes)
    for (Cell& c : s.cells) std::erase_if(c.laws, [](const LawResult& l) { return !l.passed; });
  EXPECT_EQ(page(r).find("all hold"), std::string::npos) << "nothing was held against a definition";
  Results judged = r;
  for (SceneResult& s : judged.scenes)
    for (Cell& c : s.cells) c.laws.push_back({"x = definition", 3, true, "", "", false});
  EXPECT_NE(page(judged).find("all hold"), std::string::npos);
  r.scenes[0].cells[1].laws.push_back({"x = definition", 3, true, "", "", false});
  r.scenes[0].cells[1].laws.push_back({"c", 0, true, "no time left", "", true});
  EXPECT_EQ(r.left_out(), 1);
  EXPECT_EQ(r.checked(), 4);
  const std::string html = page(r);
  EXPECT_EQ(html.find("all hold"), std::string::npos);
  EXPECT_NE(html.find("1 laws left out: <code>delassus check scene_a --op second</code>"), std::string::npos);
  EXPECT_NE(html.find("<b>scene_a</b>: held by laws of identical bits alone, too large for the bounds of the others or without an answer: first;"), std::string::npos);
  EXPECT_NE(text_table(r).find("1 left out"), std::string::npos);
  r.scenes[0].cells[1].laws.pop_back();
  r.interrupted = true;
  EXPECT_EQ(page(r).find("all hold"), std::string::npos);
}

TEST(Verify, TheDefaultAndTheDefinitionsComeFirst) {
  const std::vector<const OperatorRow*> ops{&find_operator("dense_cholesky"), &find_operator("ladder")};
  const auto held = [&](const Deadline& deadline) {
    std::vector<SceneResult> results{scene("swimmer:1")};
    for (const OperatorRow* op : ops) results[0].cells.emplace_back().op = std::string(op->name);
    verify({open_scene("swimmer:1")}, ops, deadline, results, [](const SceneResult&) {});
    return results[0].cells;
  };
  const auto all = held({600}), late = held({0}), none = held({600, [n = 0]() mutable { return n++ > 0; }});
  EXPECT_EQ(all[0].left_out() + all[1].left_out(), 0);
  EXPECT_EQ(late[1].left_out(), 0) << "the default is held whatever it takes";
  EXPECT_EQ(late[1].checked(), all[1].checked());
  EXPECT_EQ(late[0].left_out(), all[0].checked() - late[0].checked()) << "what applies and what does not are told apart";
  for (const LawResult& l : late[0].laws) EXPECT_EQ(l.skipped.empty(), l.law.find("= definition") != std::string::npos && l.law.rfind("exact", 0) != 0) << l.law;
  EXPECT_EQ(held({0, {}, false})[1].checked(), 1) << "in a quick run the definition alone";
  EXPECT_EQ(none[1].left_out(), all[1].checked());
  EXPECT_EQ(none[1].checked(), 0);
}

TEST(Cell, ATimeWithoutAnAnswerIsNone) {
  Cell c;
  c.update_status = c.solve_status = "ok";
  EXPECT_TRUE(c.answered(&Phases::update) && c.answered(&Phases::solve));
  c.solve_status = "not_converged";
  EXPECT_TRUE(c.answered(&Phases::update) && c.answered(&Phases::apply));
  EXPECT_FALSE(c.answered(&Phases::solve));
  c.update_status = "lost_pivot";
  for (const auto phase : {&Phases::update, &Phases::new_damping, &Phases::apply, &Phases::solve}) EXPECT_FALSE(c.answered(phase));
  EXPECT_TRUE(c.answered(&Phases::analyze));
  Results r;
  r.operators.emplace_back().name = "op";
  r.scenes.push_back(scene("s"));
  c.time.solve = {1, 1, 3};
  r.scenes[0].cells.push_back(c);
  EXPECT_EQ(overview_section(r).find("class=\"fast\""), std::string::npos) << "no answer is not the fastest";
  EXPECT_NE(overview_section(r).find("lost_<wbr>pivot"), std::string::npos);
}

TEST(Choosing, WhatWasLuckyIsTimedAgain) {
  Structure chain;
  for (Index i = 0; i < 30; ++i) chain.add_body(i - 1, 1);
  chain.add_link_constraint(3, {29});
  ChoiceRow row{"chain", 30, 3, count(chain), {}, 1};
  const std::string chosen(choose(row.quantities, {.products = 1}).product);
  const auto timed = [](const std::string& op, double product) {
    RowTimes r{op, false, false, {}};
    r.time.fill(NAN);
    r.time[static_cast<std::size_t>(Phase::update)] = 0, r.time[static_cast<std::size_t>(Phase::product)] = product;
    return r;
  };
  row.times = {timed(chosen, 1.2), timed("lucky", 1), timed("slow", 2)};
  EXPECT_EQ(doubtful(row), (std::vector<std::string>{chosen, "lucky"}));
  keep_lower(row.times, {timed(chosen, 1.3), timed("lucky", 0.9), timed("slow", NAN)});
  EXPECT_EQ(row.times[0].time[static_cast<std::size_t>(Phase::product)], 1.2) << "of both the lower time";
  EXPECT_EQ(row.times[1].time[static_cast<std::size_t>(Phase::product)], 0.9);
  EXPECT_EQ(row.times[2].time[static_cast<std::size_t>(Phase::product)], 2) << "what was not answered again stays";
  EXPECT_FALSE(doubtful(row).empty());
  keep_lower(row.times, {timed(chosen, 0.95)});
  EXPECT_EQ(doubtful(row), std::vector<std::string>{});
}

TEST(Choosing, TheCheapestWithAnAnswerIsNamed) {
  SceneResult s = scene("s");
  s.rows = 6;
  std::vector<OperatorInfo> operators(4);
  const auto cell = [&](std::size_t i, const char* name, double update, double damping, double solve, const char* status, const char* error) {
    operators[i].name = name;
    operators[i].solve_error = error;
    Cell c;
    c.op = name;
    c.update_status = "ok";
    c.solve_status = status;
    c.time.update = {update, update, 1};
    c.time.new_damping = {damping, damping, 1};
    c.time.solve = {solve, solve, 1};
    s.cells.push_back(c);
  };
  cell(0, "dense", 10, 9, 1, "ok", "normwise");
  cell(1, "sweeps", 3, 2, 2, "ok", "amplified");
  cell(2, "ladder", 4, 3, 4, "ok", "refined");
  cell(3, "broken", 0.1, 0.1, 0.1, "not_converged", "refined");
  const auto& use = use_cases();
  const auto chosen = [&](std::size_t k) { return choose(s, use[k], operators); };
  EXPECT_EQ(chosen(0).best, "sweeps");
  EXPECT_EQ(chosen(0).second, "ladder");
  EXPECT_DOUBLE_EQ(chosen(0).lead, 8.0 / 5);
  EXPECT_EQ(chosen(1).best, "dense");
  EXPECT_DOUBLE_EQ(chosen(1).by_default, 404.0 / 110);
  EXPECT_EQ(chosen(2).best, "sweeps");
  EXPECT_EQ(chosen(3).best, "ladder") << "what did not converge has no error bound";
  EXPECT_EQ(chosen(3).second, "");
  EXPECT_EQ(chosen(6).best, "");
}

TEST(Picture, ALinkWithoutShapesReachesWhereItIsHeld) {
  Scene s;
  Body body;
  body.name = "bar";
  body.mass = 1;
  s.model.add(body);
  s.q = neutral(s.model);
  const auto links = [&] {
    const std::string svg = draw(s);
    int n = 0;
    for (std::size_t at = 0; (at = svg.find("class=\"link\"", at)) != std::string::npos; ++at) ++n;
    return n;
  };
  EXPECT_EQ(links(), 0);
  Constraint& held = s.model.constraints.emplace_back();
  held.a = {0, {}};
  held.a.placement.translation = {1, 0, 0};
  EXPECT_EQ(links(), 1);
}

TEST(Results, LawsThatHoldAreNotFailed) {
  Results r = some_results();
  for (SceneResult& s : r.scenes)
    for (Cell& c : s.cells) std::erase_if(c.laws, [](const LawResult& l) { return !l.passed; });
  EXPECT_EQ(r.checked(), 3);
  EXPECT_EQ(r.failed(), 0);
  EXPECT_EQ(exit_code(r), 0);
  EXPECT_EQ(text_table(r).find("FAILED"), std::string::npos);
  EXPECT_EQ(page(r).find("Laws that failed"), std::string::npos);
}

}  // namespace
}  // namespace delassus::bench::bench_judges_test
