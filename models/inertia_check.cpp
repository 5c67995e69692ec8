#include "models/inertia_check.h"

#include <Eigen/Eigenvalues>

#include "algorithms/errors/message.h"

namespace delassus {

void judge_inertia(Findings& findings, const std::string& file, const std::string& element, double mass,
                   const Matrix3<double>& inertia) {
  const double scale = inertia.cwiseAbs().maxCoeff();
  if (scale == 0) {
    if (mass > 0)
      findings.warn("point mass", file, element, "mass " + number_text(mass) + " kg and no inertia", "taken as a point mass");
    return;
  }
  if (mass == 0) findings.warn("inertia without mass", file, element, "an inertia, and mass 0 kg", "the inertia is kept; give the mass");
  const Vector3<double> l = scale * Eigen::SelfAdjointEigenSolver<Matrix3<double>>(inertia / scale, Eigen::EigenvaluesOnly).eigenvalues();
  const double rounding = 30 * 0x1p-53 * 3 * scale, excess = l[2] - l[1] - l[0];
  const std::string moments = "principal moments (" + numbers_text(l) + ") kg m^2";
  if (l[0] < -rounding)
    findings.warn("negative principal moment", file, element,
                  moments + ": the smallest is negative, by " + number_text(-l[0] / l.cwiseAbs().maxCoeff()) + " of the largest", "a body's moments are 0 or more; M is judged on its own");
  else if (l[0] <= rounding)
    findings.warn("thin rod", file, element, moments + ": the smallest is zero", "taken as a thin rod");
  else if (excess > rounding)
    findings.warn("triangle inequality", file, element,
                  moments + " break the triangle inequality: the largest exceeds the sum of the others by " + number_text(excess) +
                      " kg m^2, " + number_text(excess / l[2]) + " of it",
                  "no body of positive density is like that; M is positive definite all the same");
}

}  // namespace delassus
