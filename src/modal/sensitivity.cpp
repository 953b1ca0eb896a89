#include "mottle/modal/sensitivity.hpp"

#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"

namespace mottle {
namespace {

/// Eigenvalues no further apart than this are one to rounding: their shapes, and derivatives along these, are
/// arbitrary.
double repeated_gap(const ModeSet& modes) {
  constexpr double k_repeated = 1e-10;
  return k_repeated * modes.eigenvalues.cwiseAbs().maxCoeff();
}

}  // namespace

Eigen::VectorXd eigenvalue_sensitivity(const ModeSet& modes, const Eigen::Ref<const Eigen::MatrixXd>& dK,
                                       const Eigen::Ref<const Eigen::MatrixXd>& dM) {
  const double repeated = repeated_gap(modes);
  Eigen::VectorXd derivative(modes.eigenvalues.size());
  for (Eigen::Index r = 0; r < derivative.size(); ++r) {
    const auto shape = modes.shapes.col(r);
    derivative(r) = shape.dot(dK * shape) - modes.eigenvalues(r) * shape.dot(dM * shape);
    const auto equals = ((modes.eigenvalues.array() - modes.eigenvalues(r)).abs() <= repeated).count();
    if (equals > 1) derivative(r) = std::numeric_limits<double>::quiet_NaN();  // one of them is r itself
  }
  return derivative;
}

Eigen::MatrixXd shape_sensitivity(const ModeSet& modes, const Eigen::Ref<const Eigen::MatrixXd>& dK,
                                  const Eigen::Ref<const Eigen::MatrixXd>& dM) {
  require(modes.shapes.cols() == modes.shapes.rows(), "{} modes of {}: the expansion needs all of them",
          modes.shapes.cols(), modes.shapes.rows());
  const Eigen::MatrixXd modal_dK = modes.shapes.transpose() * dK * modes.shapes;
  const Eigen::MatrixXd modal_dM = modes.shapes.transpose() * dM * modes.shapes;
  const double repeated = repeated_gap(modes);
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(modes.shapes.cols(), modes.shapes.cols());
  for (Eigen::Index r = 0; r < weights.cols(); ++r) {
    const double lambda = modes.eigenvalues(r);
    for (Eigen::Index s = 0; s < weights.rows(); ++s) {
      const double gap = lambda - modes.eigenvalues(s);
      if (s == r) {
        weights(s, r) = -0.5 * modal_dM(r, r);
      } else if (std::abs(gap) <= repeated) {
        weights.col(r).setConstant(std::numeric_limits<double>::quiet_NaN());
        break;
      } else {
        weights(s, r) = (modal_dK(s, r) - lambda * modal_dM(s, r)) / gap;
      }
    }
  }
  return modes.shapes * weights;
}

}  // namespace mottle
