// Spatial (6-D) vectors, said once for the whole library:
//   motion a = (ω̇; v̇) and force f = (moment; force), ANGULAR PART FIRST, world axes, SI units, radians,
//   about the reference point of the tree they belong to.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace delassus {

using Index = Eigen::Index;

template <class T> using Vector3 = Eigen::Matrix<T, 3, 1>;
template <class T> using Matrix3 = Eigen::Matrix<T, 3, 3>;
template <class T> using Vector6 = Eigen::Matrix<T, 6, 1>;
template <class T> using Matrix6 = Eigen::Matrix<T, 6, 6>;
// A program and the library share members of these types, whatever flags each was compiled with.
static_assert(alignof(Matrix6<double>) == 16 && EIGEN_DEFAULT_ALIGN_BYTES == 64,
              "compile with -DEIGEN_MAX_ALIGN_BYTES=64 -DEIGEN_MAX_STATIC_ALIGN_BYTES=16, as delassus is (its CMake targets do)");
template <class T> using VectorX = Eigen::Matrix<T, Eigen::Dynamic, 1>;
template <class T> using MatrixX = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

/// Columns of m numbers with unit inner stride.
template <class T> using ConstRef = const Eigen::Ref<const MatrixX<T>, 0, Eigen::OuterStride<>>&;
template <class T> using Ref = Eigen::Ref<MatrixX<T>, 0, Eigen::OuterStride<>>;

/// A rigid placement: x_a = rotation · x_b + translation, the pose of frame b in frame a ("X_ab").
template <class T> struct Pose {
  Matrix3<T> rotation = Matrix3<T>::Identity();
  Vector3<T> translation = Vector3<T>::Zero();

  /// X_ac = X_ab X_bc.
  [[nodiscard]] Pose operator*(const Pose& c) const {
    return {rotation * c.rotation, rotation * c.translation + translation};
  }
  [[nodiscard]] Vector3<T> operator*(const Vector3<T>& x) const { return rotation * x + translation; }
  [[nodiscard]] Pose inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }
};

/// The 3×3 matrix of x ↦ p × x.
template <class T> [[nodiscard]] Matrix3<T> cross_matrix(const Vector3<T>& p) {
  Matrix3<T> m;
  m << T(0), -p[2], p[1], p[2], T(0), -p[0], -p[1], p[0], T(0);
  return m;
}

/// Motion of a rotation about the unit `axis` through the point p (from the reference point): (axis; p × axis).
template <class T> [[nodiscard]] Vector6<T> rotation_axis(const Vector3<T>& axis, const Vector3<T>& p) {
  Vector6<T> s;
  s << axis, p.cross(axis);
  return s;
}

/// Motion of a translation along `axis`: (0; axis).
template <class T> [[nodiscard]] Vector6<T> translation_axis(const Vector3<T>& axis) {
  Vector6<T> s;
  s << Vector3<T>::Zero(), axis;
  return s;
}

/// Spatial inertia about the reference point of a body of mass m [kg], centre of mass c [m] from the reference point
/// and rotational inertia I_c [kg m²] about c, world axes: [I_c + m ĉĉᵀ, mĉ; mĉᵀ, m1].
template <class T> [[nodiscard]] Matrix6<T> spatial_inertia(const T& m, const Vector3<T>& c, const Matrix3<T>& I_c) {
  const Matrix3<T> mc = m * cross_matrix(c);
  Matrix6<T> H;
  H.template topLeftCorner<3, 3>() = I_c - mc * cross_matrix(c);
  H.template topRightCorner<3, 3>() = mc;
  H.template bottomLeftCorner<3, 3>() = -mc;
  H.template bottomRightCorner<3, 3>() = m * Matrix3<T>::Identity();
  return H;
}

}  // namespace delassus
