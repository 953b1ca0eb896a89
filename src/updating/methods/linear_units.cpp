#include "updating/methods/linear_units.hpp"

#include <Eigen/Core>

#include "mottle/linalg/dense/decompositions.hpp"
#include "updating/fits/measured_outputs.hpp"

namespace mottle::updating {

Eigen::MatrixXd mean_jacobian(const std::vector<Eigen::MatrixXd>& jacobians) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(jacobians[0].rows(), jacobians[0].cols());
  for (const Eigen::MatrixXd& g : jacobians) sum += g;
  return sum / static_cast<double>(jacobians.size());
}

Eigen::MatrixXd absorbed_errors(const Eigen::MatrixXd& sensitivity, const Eigen::MatrixXd& directions,
                                const Eigen::VectorXd& variance) {
  constexpr double k_min = 1e-12;
  const Eigen::VectorXd root =
      variance.cwiseMax(k_min * variance.maxCoeff()).cwiseMax(1e-280).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd moved = root.asDiagonal() * (sensitivity * directions);
  const LeastNormSolver solver(moved);
  return directions * solver.pseudo_inverse() * root.asDiagonal();
}

std::vector<RandomEffectsUnit> linear_units(const Eigen::Ref<const Eigen::MatrixXd>& values,
                                            const Eigen::VectorXd& shift, const Eigen::MatrixXd& sensitivity,
                                            const Eigen::MatrixXd& absorbed, const SpecimenFits& fits,
                                            const NoiseModel& noise, const Eigen::VectorXd& origin,
                                            const Eigen::MatrixXd& map) {
  std::vector<RandomEffectsUnit> units(static_cast<std::size_t>(values.rows()));
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    RandomEffectsUnit& unit = units[static_cast<std::size_t>(s)];
    const std::vector<Eigen::Index> rows = measured_outputs(values, s);
    for (const Eigen::Index k : rows) unit.factor.push_back(noise.factor[static_cast<std::size_t>(k)]);
    const Eigen::MatrixXd g = fits.jacobians[static_cast<std::size_t>(s)](rows, Eigen::all);
    unit.design = g * map;
    if (shift.size() > 0) {
      unit.shared = Eigen::MatrixXd::Identity(shift.size(), shift.size())(rows, Eigen::all);
      unit.shared += (g - sensitivity(rows, Eigen::all)) * absorbed;
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

}  // namespace mottle::updating
