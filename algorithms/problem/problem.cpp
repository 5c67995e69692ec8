// The numbers of a problem: sizes, and the same in another scalar.
#include <utility>

#include "algorithms/kit/counted.h"
#include "algorithms/kit/instantiate.h"
#include "algorithms/kit/quad.h"
#include "algorithms/problem/problem.h"

namespace delassus {
namespace {
template <class U, class T> U convert(const T& x) {
  if constexpr (ScalarTraits<U>::exact) require(is_finite(x), "cast: an exact scalar holds finite numbers only");
  return scalar_cast<U>(x);
}

template <class U, class T> std::vector<U> convert(const std::vector<T>& x) {
  std::vector<U> y;
  y.reserve(x.size());
  for (const T& v : x) y.push_back(convert<U>(v));
  return y;
}

template <class U, class T, int R, int C> Eigen::Matrix<U, R, C> convert(const Eigen::Matrix<T, R, C>& x) {
  Eigen::Matrix<U, R, C> y(x.rows(), x.cols());
  for (Index j = 0; j < x.cols(); ++j)
    for (Index i = 0; i < x.rows(); ++i) y(i, j) = convert<U>(x(i, j));
  return y;
}

template <class U, class T, int R, int C>
std::vector<Eigen::Matrix<U, R, C>> convert(const std::vector<Eigen::Matrix<T, R, C>>& x) {
  std::vector<Eigen::Matrix<U, R, C>> y;
  y.reserve(x.size());
  for (const auto& v : x) y.push_back(convert<U>(v));
  return y;
}

}  // namespace

template <class T> Problem<T>::Problem(std::shared_ptr<const Structure> s) : structure(std::move(s)) {
  require(structure != nullptr, "Problem: no structure");
  S.assign(structure->dofs(), Vector6<T>::Constant(T(0)));
  armature.assign(structure->dofs(), T(0));
  H.assign(structure->bodies(), Matrix6<T>::Constant(T(0)));
  K.assign(structure->K_rows, Vector6<T>::Constant(T(0)));
  joint_K.assign(structure->joint_K_size, T(0));
}

template <class T> void Problem<T>::check_sizes() const {
  require(structure != nullptr, "Problem: no structure");
  const auto fits = [](const auto& array, Index n) { return static_cast<Index>(array.size()) == n; };
  require(fits(S, structure->dofs()), "Problem: S needs one column per degree of freedom");
  require(fits(armature, structure->dofs()), "Problem: armature needs one entry per degree of freedom");
  require(fits(H, structure->bodies()), "Problem: H needs one matrix per body");
  require(fits(K, structure->K_rows), "Problem: K needs Structure::K_rows rows");
  require(fits(joint_K, structure->joint_K_size), "Problem: joint_K needs Structure::joint_K_size entries");
}

template <class T> template <class U> Problem<U> Problem<T>::cast() const {
  Problem<U> p;
  p.structure = structure;
  p.S = convert<U>(S);
  p.armature = convert<U>(armature);
  p.H = convert<U>(H);
  p.K = convert<U>(K);
  p.joint_K = convert<U>(joint_K);
  return p;
}

template <class T> template <class U> Damping<U> Damping<T>::cast() const {
  Damping<U> d;
  d.diagonal.reserve(diagonal.size());
  for (const T& x : diagonal) d.diagonal.push_back(ScalarTraits<T>::is_infinite(x) ? ScalarTraits<U>::infinity() : convert<U>(x));
  d.blocks.reserve(blocks.size());
  for (const Block& b : blocks) d.blocks.push_back({b.row, convert<U>(b.R_inverse)});
  return d;
}

#define DELASSUS_CAST(T, U)                        \
  template Problem<U> Problem<T>::cast<U>() const; \
  template Damping<U> Damping<T>::cast<U>() const;
#define DELASSUS_CAST_FROM_DOUBLE(U) DELASSUS_CAST(double, U)
DELASSUS_FOR_EACH_SCALAR(DELASSUS_CAST_FROM_DOUBLE)
#ifdef DELASSUS_EXACT
template struct Problem<Rational>;
template struct Problem<PrimeField>;
DELASSUS_CAST(double, Stochastic)
DELASSUS_CAST(Quad, double)
DELASSUS_CAST(Rational, double)
DELASSUS_CAST(Quad, Rational)
DELASSUS_CAST(Rational, Quad)
#else
template struct Problem<double>;
template struct Problem<float>;
template struct Problem<Quad>;  // kinematics of the models that are checked, and counted
template struct Problem<Counted>;
DELASSUS_CAST(float, double)
#endif
#undef DELASSUS_CAST_FROM_DOUBLE
#undef DELASSUS_CAST

}  // namespace delassus
