#include "algorithms/kit/test_scalars.h"
#include "property_tests/laws/verdict.h"

#include <bit>
#include <limits>

namespace delassus::laws {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// |error| / (eps · bound) of one entry, as the head of the file defines it.
double ratio_of(const Quad& error, const Quad& bound, double eps) {
  const Quad size = abs(error);
  if (!isfinite(size) || !isfinite(bound) || bound < Quad(0)) return infinite;
  if (size == Quad(0)) return 0;
  if (bound == Quad(0) || eps == 0) return infinite;
  return static_cast<double>(size / (Quad(eps) * bound));
}

std::string entry(Index row, Index column) {
  return "differs in row " + std::to_string(row) + ", column " + std::to_string(column);
}

template <class T> Verdict shapes_differ(const MatrixX<T>& x, const MatrixX<T>& y) {
  return failure("shapes " + std::to_string(x.rows()) + "x" + std::to_string(x.cols()) + " and " +
                     std::to_string(y.rows()) + "x" + std::to_string(y.cols()), "equality");
}

}  // namespace

Verdict judge(const MatrixX<Quad>& error, const MatrixX<Quad>& bound, double eps, std::string_view name) {
  Verdict v{0, name, -1, {}};
  if (bound.rows() != error.rows() || (bound.cols() != error.cols() && bound.cols() != 1)) return shapes_differ(error, bound);
  for (Index c = 0; c < error.cols(); ++c)
    for (Index r = 0; r < error.rows(); ++r) {
      const double ratio = ratio_of(error(r, c), bound(r, bound.cols() == 1 ? 0 : c), eps);
      if (ratio > v.ratio) v = {ratio, name, r, {}};
    }
  return v;
}

template <class T> Verdict judge_equal(const MatrixX<T>& x, const MatrixX<T>& y) {
  if (x.rows() != y.rows() || x.cols() != y.cols()) return shapes_differ(x, y);
  for (Index c = 0; c < x.cols(); ++c)
    for (Index r = 0; r < x.rows(); ++r)
      if (!(x(r, c) == y(r, c))) return {infinite, "equality", r, entry(r, c)};
  return {0, "equality", -1, {}};
}
template Verdict judge_equal(const MatrixX<double>&, const MatrixX<double>&);
template Verdict judge_equal(const MatrixX<Quad>&, const MatrixX<Quad>&);
template Verdict judge_equal(const MatrixX<Rational>&, const MatrixX<Rational>&);

Verdict judge_bits(const MatrixX<double>& x, const MatrixX<double>& y) {
  if (x.rows() != y.rows() || x.cols() != y.cols()) return shapes_differ(x, y);
  for (Index c = 0; c < x.cols(); ++c)
    for (Index r = 0; r < x.rows(); ++r) {
      if (std::isnan(x(r, c)) && std::isnan(y(r, c))) continue;
      if (std::bit_cast<std::uint64_t>(x(r, c)) != std::bit_cast<std::uint64_t>(y(r, c)))
        return {infinite, "identical bits", r, entry(r, c)};
    }
  return {0, "identical bits", -1, {}};
}

Verdict failure(std::string note, std::string_view bound) { return {infinite, bound, -1, std::move(note)}; }

Verdict worst(const Verdict& a, const Verdict& b) { return b.ratio > a.ratio ? b : a; }

}  // namespace delassus::laws
