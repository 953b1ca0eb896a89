#include "linear_units.hpp"

#include <Eigen/QR>
#include <cmath>

namespace mottle {

Eigen::MatrixXd mean_jacobian(const SpecimenFits& fits) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(fits.jacobians[0].rows(), fits.jacobians[0].cols());
  for (const Eigen::MatrixXd& g : fits.jacobians) sum += g;
  return sum / static_cast<double>(fits.jacobians.size());
}

Eigen::MatrixXd absorbed_errors(const Eigen::MatrixXd& sensitivity, const Eigen::MatrixXd& directions,
                                const Eigen::VectorXd& variance) {
  constexpr double k_least = 1e-12;
  const Eigen::VectorXd root =
      variance.cwiseMax(k_least * variance.maxCoeff()).cwiseMax(1e-280).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd moved = root.asDiagonal() * (sensitivity * directions);
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver(moved);
  return directions * solver.pseudoInverse() * root.asDiagonal();
}

std::vector<RandomEffectsUnit> linear_units(const Eigen::Ref<const Eigen::MatrixXd>& values,
                                            const Eigen::VectorXd& shift, const Eigen::MatrixXd& absorbed,
                                            const SpecimenFits& fits, const NoiseModel& noise,
                                            const Eigen::VectorXd& origin, const Eigen::MatrixXd& map) {
  const Eigen::MatrixXd middle = mean_jacobian(fits);
  std::vector<RandomEffectsUnit> units(static_cast<std::size_t>(values.rows()));
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    RandomEffectsUnit& unit = units[static_cast<std::size_t>(s)];
    std::vector<Eigen::Index> rows;
    for (Eigen::Index k = 0; k < values.cols(); ++k) {
      if (std::isnan(values(s, k))) continue;
      rows.push_back(k);
      unit.factor.push_back(noise.factor[static_cast<std::size_t>(k)]);
    }
    const Eigen::MatrixXd g = fits.jacobians[static_cast<std::size_t>(s)](rows, Eigen::all);
    unit.design = g * map;
    if (shift.size() > 0) {
      unit.shared = Eigen::MatrixXd::Identity(shift.size(), shift.size())(rows, Eigen::all);
      unit.shared += (g - middle(rows, Eigen::all)) * absorbed;
    }
    const Eigen::VectorXd z = values.row(s)(rows);
    const Eigen::VectorXd y = fits.outputs.row(s)(rows);
    const Eigen::VectorXd point = fits.points.row(s);
    unit.response = z - y + g * (point - origin);
    unit.noise = noise.base(rows);
    // What no parameters can reproduce counts as noise of that specimen: its linear model must not be carried far.
    constexpr double k_far = 5.0;  // standard deviations of the noise
    if (fits.converged[static_cast<std::size_t>(s)]) continue;
    const Eigen::VectorXd own = shift.size() > 0 ? Eigen::VectorXd(z - shift(rows)) : z;
    const Eigen::ArrayXd misfit = (own - y).array().square();
    unit.noise.array() += (misfit > k_far * k_far * unit.noise.array()).select(misfit, 0.0);
  }
  return units;
}

}  // namespace mottle
