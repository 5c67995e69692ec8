#include "property_tests/unit/operators/wrong_damping.h"

#include <cmath>
#include <limits>

#include "property_tests/laws/verdict.h"

namespace delassus {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN(), eps = 0x1p-53;

// Two bodies; rows 0–2 link them, 3–4 belong to a joint, 5 to one body.
template <class T> Problem<T> problem() {
  auto s = std::make_shared<Structure>();
  s->add_body(ground, 6);
  s->add_body(0, 2);
  s->add_link_constraint(3, {0, 1});
  s->add_joint_constraint(2, 1);
  s->add_link_constraint(1, {1});
  Problem<double> p{std::shared_ptr<const Structure>(s)};
  for (auto& H : p.H) H.setIdentity();
  for (std::size_t c = 0; c < p.S.size(); ++c) p.S[c][static_cast<Index>(c % 6)] = 1;
  for (std::size_t r = 0; r < p.K.size(); ++r) p.K[r][static_cast<Index>(r % 6)] = 1;
  p.joint_K = {1, 0, 0, 1};
  if constexpr (std::is_same_v<T, double>) return p;
  else return p.cast<T>();
}

MatrixX<double> square(std::initializer_list<double> entries) {
  const auto n = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(entries.size()))));
  return Eigen::Map<const MatrixX<double>>(entries.begin(), n, n).transpose();
}

struct Block {
  Index row;
  MatrixX<double> R_inverse;
};
/// 1 on the diagonal, 0 within the blocks.
Damping<double> with_block(std::initializer_list<Block> blocks) {
  Damping<double> d = Damping<double>::uniform(6, 1);
  for (const Block& b : blocks) {
    std::fill_n(d.diagonal.begin() + b.row, b.R_inverse.rows(), 0.0);
    d.blocks.push_back({b.row, b.R_inverse});
  }
  return d;
}
Damping<double> with_entry(Damping<double> d, Index row, double value) {
  d.diagonal[static_cast<std::size_t>(row)] = value;
  return d;
}

struct Wrong {
  const char* what;
  Damping<double> damping;
  Index row;
};

std::vector<Wrong> wrong_ones() {
  const MatrixX<double> good = square({2, 1, 1, 2}), three = square({2, 1, 0, 1, 2, 1, 0, 1, 2});
  std::vector<Wrong> all;
  for (const Index row : {0, 2, 4, 5})
    for (const double value : {-0.5, -std::numeric_limits<double>::denorm_min(), nan, -inf})
      all.push_back({"a diagonal entry", with_entry(with_block({}), row, value), row});
  all.push_back({"of two entries the first", with_entry(with_entry(with_block({}), 1, nan), 4, -1), 1});
  all.push_back({"an entry beside a block", with_entry(with_block({{3, good}}), 5, -1), 5});
  all.push_back({"an entry before a block", with_entry(with_block({{3, square({-1, 0, 0, 1})}}), 0, -1), 0});
  for (const Index row : {0, 1, 3}) {
    const auto block = [&](const char* what, const MatrixX<double>& B) { all.push_back({what, with_block({{row, B}}), row}); };
    block("an asymmetric block", square({2, 1, 1 + 0x1p-40, 2}));
    block("a block with a triangle alone", square({2, 1, 0, 2}));
    block("an indefinite block", square({1, 2, 2, 1}));
    block("a block indefinite by little", square({1, 1, 1, 1 - 0x1p-40}));
    block("a negative block", square({-1, 0, 0, -1}));
    block("zeros with something beside them", square({0, 1, 1, 0}));
    for (const double x : {nan, inf, -inf}) {
      block("a block with a diagonal entry not finite", square({2, 0, 0, x}));
      block("a block with an entry not finite below", square({2, 0, x, 2}));
      block("a block with an entry not finite above", square({2, x, 0, 2}));
    }
    for (const Index beside : {row, row + 1}) all.push_back({"a row damped twice", with_entry(with_block({{row, good}}), beside, 0.5), beside});
  }
  all.push_back({"a block of one negative number", with_block({{5, square({-1})}}), 5});
  all.push_back({"the last of three blocks", with_block({{0, three}, {3, good}, {5, square({-1})}}), 5});
  all.push_back({"the middle of three blocks", with_block({{0, three}, {3, square({1, 2, 2, 1})}, {5, square({1})}}), 3});
  MatrixX<double> far = three;
  far(2, 0) = 0.5;
  all.push_back({"a block asymmetric in its corner", with_block({{0, far}}), 0});
  return all;
}

struct Right {
  const char* what;
  Damping<double> damping;
};

std::vector<Right> right_ones() {
  const double tiny = std::numeric_limits<double>::denorm_min(), huge = std::numeric_limits<double>::max();
  return {{"all ones", with_block({})},
          {"hard rows", Damping<double>::uniform(6, 0)},
          {"minus zero", Damping<double>::uniform(6, -0.0)},
          {"the smallest number", with_entry(with_block({}), 1, tiny)},
          {"the largest number", with_entry(with_block({}), 1, huge)},
          {"rows that are off", with_entry(with_entry(with_block({}), 0, inf), 4, inf)},
          {"a row of a block that is off", with_entry(with_block({{1, square({2, 1, 1, 2})}}), 1, inf)},
          {"a singular block", with_block({{1, square({1, 1, 1, 1})}})},
          {"a block of zeros", with_block({{3, square({0, 0, 0, 0})}})},
          {"a block singular but for rounding", with_block({{1, square({1, 1, 1, 1 - eps})}})},
          {"three blocks", with_block({{0, square({2, 1, 0, 1, 2, 1, 0, 1, 2})}, {3, square({2, 1, 1, 2})}, {5, square({1})}})}};
}

/// Operator and what it is asked with.
struct Asked {
  const OperatorRow& row;
  Problem<double> p = problem<double>();
  std::unique_ptr<Operator<double>> op = row.make<double>();
  MatrixX<double> x = MatrixX<double>::Ones(6, 1);
  Workspace<double> w;
  explicit Asked(const OperatorRow& r) : row(r), w((op->analyze(p.structure), op->workspace())) {}

  std::vector<Report> ask(MatrixX<double>& y) {
    std::vector<Report> said;
    y.setConstant(6, 1, 0.25);
    if (row.applies) said.push_back(op->apply(x, y, w));
    if (row.solves) said.push_back(op->solve(x, y, w));
    if (row.solves) said.push_back(op->solve(x, y, Accuracy::fastest(), w));
    return said;
  }
};

std::string taken(const Report& r, const Wrong& wrong, const char* when) {
  if (r.status == Status::bad_damping && r.where == wrong.row && r.at_row()) return {};
  return std::string(when) + " with " + wrong.what + " at " + std::to_string(wrong.row) + " is " + std::string(name(r.status)) + " at " + std::to_string(r.where);
}

std::string refused_everywhere(Asked& a, const Wrong& wrong, const Report& updated, const char* when) {
  MatrixX<double> y;
  if (std::string words = taken(updated, wrong, when); !words.empty()) return words;
  for (const Report& r : a.ask(y)) {
    if (std::string words = taken(r, wrong, "an answer"); !words.empty()) return words;
    if (y.array().isNaN().count() != y.size()) return "answers numbers with " + std::string(wrong.what);
  }
  return {};
}

bool same_bits(const MatrixX<double>& x, const MatrixX<double>& y) { return laws::judge_bits(x, y).passed(); }

}  // namespace

std::string wrong_damping_taken(const OperatorRow& row) {
  Asked fresh(row), used(row);
  MatrixX<double> expected, y;
  const Damping<double> good = with_block({{0, square({2, 1, 0, 1, 2, 1, 0, 1, 2})}});
  static_cast<void>(fresh.op->update(fresh.p, good));
  static_cast<void>(fresh.ask(expected));
  const std::string name = std::string(row.name) + ": ";
  for (const Wrong& wrong : wrong_ones()) {
    std::string words = refused_everywhere(used, wrong, used.op->update(used.p, wrong.damping), "update");
    if (words.empty() && !used.op->update_damping(good).ok()) words = "does not recover from " + std::string(wrong.what);
    static_cast<void>(used.ask(y));
    if (words.empty() && !same_bits(y, expected)) words = "answers otherwise after " + std::string(wrong.what);
    if (words.empty()) words = refused_everywhere(used, wrong, used.op->update_damping(wrong.damping), "update_damping");
    static_cast<void>(used.op->update_damping(good));
    static_cast<void>(used.ask(y));
    if (words.empty() && !same_bits(y, expected)) words = "answers otherwise after a new damping, " + std::string(wrong.what);
    if (!words.empty()) return name + words;
  }
  for (const Right& right : right_ones()) {
    if (used.op->update(used.p, right.damping).status == Status::bad_damping) return name + "refuses " + right.what;
    if (used.op->update_damping(right.damping).status == Status::bad_damping) return name + "refuses a new damping, " + right.what;
  }
  return {};
}

}  // namespace delassus
