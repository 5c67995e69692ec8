#include "simulation/problem_file.h"

#include <cmath>
#include <fstream>
#include <sstream>

#include "algorithms/errors/message.h"
#include "algorithms/kit/ldlt.h"
#include "simulation/contact_operator.h"

namespace delassus::simulation {
namespace {

struct Token {
  std::string_view text;
  int line;
};

class Reader {
 public:
  Reader(const std::string& text, const std::string& file) : file_(file) {
    int line = 1;
    for (std::size_t k = 0; k < text.size();) {
      if (std::isspace(static_cast<unsigned char>(text[k])) != 0) {
        line += text[k++] == '\n';
        continue;
      }
      std::size_t end = k;
      while (end < text.size() && std::isspace(static_cast<unsigned char>(text[end])) == 0) ++end;
      tokens_.push_back({std::string_view(text).substr(k, end - k), line});
      k = end;
    }
  }

  [[noreturn]] void refuse(const std::string& element, const std::string& problem, const std::string& accepted) const {
    throw ModelError(file_, element + in_line(next_ < tokens_.size() ? tokens_[next_].line : tokens_.empty() ? 1 : tokens_.back().line), problem, accepted);
  }
  [[nodiscard]] std::size_t left() const { return tokens_.size() - next_; }
  [[nodiscard]] bool at(std::string_view word) const { return left() > 0 && tokens_[next_].text == word; }
  void skip() { ++next_; }
  [[nodiscard]] std::size_t before(std::string_view word) const {  // tokens left in front of it
    std::size_t k = next_;
    while (k < tokens_.size() && tokens_[k].text != word) ++k;
    return k - next_;
  }

  double number(const char* what, bool may_be_infinite = false) {
    if (left() == 0) refuse(what, "the file ends here", "a number");
    const std::string_view text = tokens_[next_].text;
    if (may_be_infinite && (text == "inf" || text == "-inf")) {
      skip();
      return text == "inf" ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
    }
    const auto value = finite_number(text);
    if (!value) {
      const NotANumber wrong = not_a_number(text);
      refuse(what, in_quotes(text) + " " + wrong.problem, wrong.advice);
    }
    skip();
    return *value;
  }
  Index count(const char* what, Index least, Index most) {
    const double x = number(what);
    if (!(x >= static_cast<double>(least) && x <= static_cast<double>(most)) || x != std::floor(x)) {
      --next_;
      refuse(what, number_text(x), "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
    }
    return static_cast<Index>(x);
  }
  std::vector<Index> counts(const char* what, Index n, Index least, Index most) {
    std::vector<Index> all;
    for (Index k = 0; k < n; ++k) all.push_back(count(what, least, most));
    return all;
  }
  VectorX<double> numbers(const char* what, Index n, bool may_be_infinite = false) {
    VectorX<double> x(n);
    for (double& v : x) v = number(what, may_be_infinite);
    return x;
  }
  MatrixX<double> matrix(const char* what);

 private:
  static constexpr Index most_rows = 20000;
  MatrixX<double> blocks(const char* what, Index rows, Index columns);
  std::string file_;
  std::vector<Token> tokens_;
  std::size_t next_ = 0;
};

MatrixX<double> Reader::matrix(const char* what) {
  const Index storage = count(what, 0, 1), rows = count(what, 0, most_rows), columns = count(what, 0, most_rows);
  if (storage == 1) return blocks(what, rows, columns);
  if (count(what, 0, most_rows) != rows || count(what, 0, most_rows) != columns) refuse(what, "gives its size twice, and not the same", std::to_string(rows) + " " + std::to_string(columns));
  if (static_cast<std::size_t>(rows * columns) > left()) refuse(what, "has " + std::to_string(left()) + " numbers left for " + std::to_string(rows) + " × " + std::to_string(columns), "a file that is whole");
  MatrixX<double> A(rows, columns);
  for (Index k = 0; k < A.size(); ++k) A.data()[k] = number(what);
  return A;
}

MatrixX<double> Reader::blocks(const char* what, Index rows, Index columns) {
  const Index n = count(what, 0, most_rows * 100), block_rows = count(what, 0, rows), block_columns = count(what, 0, columns);
  const auto row_end = counts(what, block_rows, 1, rows), column_end = counts(what, block_columns, 1, columns);
  const Index firsts = count(what, 1, block_rows + 1), places = count(what, 0, most_rows * 100);
  const auto first = counts(what, firsts, 0, n);
  const auto place = counts(what, places, 0, std::max<Index>(block_columns, 1) - 1);
  MatrixX<double> A = MatrixX<double>::Zero(rows, columns);
  const auto begin = [](const std::vector<Index>& end, Index k) { return k == 0 ? 0 : end[static_cast<std::size_t>(k - 1)]; };
  for (Index r = 0; r + 1 < firsts; ++r)
    for (Index b = first[static_cast<std::size_t>(r)]; b < first[static_cast<std::size_t>(r + 1)]; ++b) {
      if (count(what, 0, n) != b || b >= places) refuse(what, "blocks are out of order", "block " + std::to_string(b));
      const Index c = place[static_cast<std::size_t>(b)], r0 = begin(row_end, r), c0 = begin(column_end, c);
      const Index height = row_end[static_cast<std::size_t>(r)] - r0, width = column_end[static_cast<std::size_t>(c)] - c0;
      if (height < 1 || width < 1) refuse(what, "block " + std::to_string(b) + " has no entries", "ends of blocks that ascend");
      for (Index j = 0; j < width; ++j)
        for (Index i = 0; i < height; ++i) A(r0 + i, c0 + j) = number(what);
    }
  return A;
}

void symmetrise(ProblemFile& f, const Reader& in, double most) {
  MatrixX<double>& W = f.problem.G;
  const double size = W.size() > 0 ? W.cwiseAbs().maxCoeff() : 0;
  f.asymmetry = size > 0 ? (W - W.transpose()).cwiseAbs().maxCoeff() / size : 0;
  if (f.asymmetry > most)
    in.refuse("W", "is asymmetric by " + number_text(f.asymmetry) + " of its largest entry", "at most " + number_text(most) + "; solvers need a symmetric matrix");
  for (Index c = 0; c < W.cols(); ++c)
    for (Index r = 0; r < c; ++r)
      if (W(r, c) != W(c, r)) W(r, c) = W(c, r) = W(r, c) / 2 + W(c, r) / 2;
}

// The section `delassus 1`.
void read_own(Reader& in, ProblemFile& f) {
  in.skip();
  if (in.count("delassus", 1, 1) != 1) return;
  ContactProblem<double>& p = f.problem;
  const Index m = in.count("rows", 0, 20000);
  p.resize(m);
  p.law = in.count("law (0 exact, 1 relaxed)", 0, 1) == 0 ? FrictionLaw::exact : FrictionLaw::relaxed;
  const Index groups = in.count("groups", 0, m);
  for (Index k = 0; k < groups; ++k) {
    const auto cone = static_cast<Cone>(in.count("cone (0 free, 1 half line, 2 box, 3 Coulomb)", 0, 3));
    const Index row = in.count("row", 0, m);
    p.groups.push_back({cone, row, in.count("rows of a group", 1, m)});
  }
  const auto list = [&](const char* what, std::vector<double>& v) {
    for (double& x : v) x = in.number(what, true);
  };
  p.G = in.matrix("G");
  p.free_velocity = in.numbers("free velocity", m);
  p.target = in.numbers("target", m);
  list("R⁻¹", p.R_inverse);
  list("friction", p.friction);
  list("low", p.low);
  list("high", p.high);
  p.warm_start = in.numbers("warm start", in.count("warm start", 0, m));
  if (in.left() > 0) in.refuse("the end", "more text follows", "nothing");
  f.own = true;
  f.asymmetry = 0;
}

void contacts(ContactProblem<double>& p, Index d, const VectorX<double>& mu) {
  for (const double x : mu) append_contact(p, x, d - 1);
}

void write_matrix(std::ostream& out, const MatrixX<double>& A) {
  out << "0\n" << A.rows() << ' ' << A.cols() << '\n' << A.rows() << ' ' << A.cols() << '\n';
  for (Index c = 0; c < A.cols(); ++c) {
    for (Index r = 0; r < A.rows(); ++r) out << (r == 0 ? "" : " ") << number_text(A(r, c));
    out << '\n';
  }
}
template <class V> void write_line(std::ostream& out, const V& x) {
  bool first = true;
  for (const double v : x) {
    out << (first ? "" : " ") << number_text(v);
    first = false;
  }
  out << '\n';
}

// The number of rows of every contact, or 0 where the format cannot say what the problem is.
Index expressible(const ContactProblem<double>& p) {
  const Index d = p.groups.empty() ? 0 : p.groups[0].rows;
  if (d < 2 || d > 3 || p.law != FrictionLaw::exact) return 0;
  for (const ConeRows& c : p.groups)
    if (c.cone != Cone::coulomb || c.rows != d || p.is_off(c) || p.friction[static_cast<std::size_t>(c.row + 1)] != p.friction[static_cast<std::size_t>(c.row + d - 1)]) return 0;
  return d;
}

}  // namespace

ProblemFile read_contact_problem(const std::string& text, const std::string& file, double most_asymmetry) {
  Reader in(text, file);
  ProblemFile f;
  const Index d = in.count("dimension", 2, 3), n = in.count("number of contacts", 0, 6000), m = d * n;
  MatrixX<double> first = in.matrix("W");
  const auto rest = static_cast<Index>(in.before("delassus"));
  f.problem.resize(m);
  f.global = rest != first.rows() + n && rest != first.rows() + n + 1;
  if (!f.global) {
    if (first.rows() != m || first.cols() != m) in.refuse("W", "is " + std::to_string(first.rows()) + " × " + std::to_string(first.cols()), std::to_string(m) + " × " + std::to_string(m));
    f.problem.G = std::move(first);
    f.problem.free_velocity = in.numbers("q", m);
  } else {
    const MatrixX<double> H = in.matrix("H");
    if (first.rows() != first.cols() || H.rows() != first.rows() || H.cols() != m)
      in.refuse("H", "is " + std::to_string(H.rows()) + " × " + std::to_string(H.cols()), std::to_string(first.rows()) + " × " + std::to_string(m) + ", and M square");
    const VectorX<double> q = in.numbers("q", first.rows()), b = in.numbers("b", m);
    const Index v = first.rows();
    if (!first.isApprox(first.transpose(), 1e-12) || ldlt_factor(first.data(), v, v) >= 0) in.refuse("M", "is not symmetric positive definite", "a mass matrix");
    MatrixX<double> solved(v, m + 1);  // M⁻¹ (H q)
    solved << H, q;
    for (Index c = 0; c <= m; ++c) ldlt_solve(first.data(), v, v, solved.data() + c * v);
    f.problem.G = H.transpose() * solved.leftCols(m);
    f.problem.free_velocity = H.transpose() * solved.col(m) + b;
  }
  contacts(f.problem, d, in.numbers("friction coefficients", n));
  symmetrise(f, in, most_asymmetry);
  if (in.left() > 0 && !in.at("delassus")) f.mark = in.count("the mark behind the coefficients", 0, 1);
  if (in.at("delassus")) read_own(in, f);
  else if (in.left() > 0) in.refuse("the end", std::to_string(in.left()) + " more numbers follow", "nothing");
  try {
    f.problem.validate();
  } catch (const ModelError& e) {
    throw ModelError(file + ": " + e.what());
  }
  return f;
}

ProblemFile load_contact_problem(const std::string& path, double most_asymmetry) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  if (!in) throw ModelError(path, "file", "cannot be read", "a contact problem as text");
  return read_contact_problem(text.str(), path, most_asymmetry);
}

ContactProblem<double> as_given_matrix(const ContactProblem<double>& p) {
  if (!p.mechanism) return p;
  ContactProblem<double> q = p;
  ContactProblem<double> on = p;  // G of rows that are off is part of the problem too
  for (double& r : on.R_inverse)
    if (std::isinf(r)) r = 0;
  ContactOperator<double> op;
  op.analyze(on);
  if (!op.update(on).ok()) throw ModelError("contact problem", "mechanism", "its mass matrix is singular", "a positive definite one");
  q.mechanism = nullptr;
  q.G = op.matrix();
  for (Index c = 0; c < q.G.cols(); ++c)
    for (Index r = 0; r < c; ++r) q.G(r, c) = q.G(c, r);
  return q;
}

std::string contact_problem_text(const ContactProblem<double>& given) {
  given.validate();
  const ContactProblem<double> p = as_given_matrix(given);
  std::ostringstream out;
  const Index d = expressible(p), m = p.rows();
  out << (d > 0 ? d : 3) << '\n' << (d > 0 ? m / d : 0) << '\n';
  MatrixX<double> W = d > 0 ? p.G : MatrixX<double>(0, 0);
  for (Index r = 0; r < W.rows(); ++r) W(r, r) += p.R_inverse[static_cast<std::size_t>(r)];
  write_matrix(out, W);
  if (d > 0) {
    write_line(out, VectorX<double>(p.free_velocity - p.target));
    std::vector<double> mu;
    for (const ConeRows& c : p.groups) mu.push_back(p.friction[static_cast<std::size_t>(c.row + 1)]);
    write_line(out, mu);
  }
  out << "delassus 1\n" << m << ' ' << (p.law == FrictionLaw::exact ? 0 : 1) << ' ' << p.groups.size() << '\n';
  for (const ConeRows& c : p.groups) out << static_cast<int>(c.cone) << ' ' << c.row << ' ' << c.rows << '\n';
  write_matrix(out, p.G);
  write_line(out, p.free_velocity);
  write_line(out, p.target);
  for (const std::vector<double>* const v : {&p.R_inverse, &p.friction, &p.low, &p.high}) write_line(out, *v);
  out << p.warm_start.size() << '\n';
  write_line(out, p.warm_start);
  return out.str();
}

}  // namespace delassus::simulation
