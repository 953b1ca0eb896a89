#include "updating/methods/scatter_curvature.hpp"

#include <Eigen/Core>
#include <cmath>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/methods/least_change.hpp"

namespace mottle::updating {
namespace {

/// The least change of the parameters that explains a change of the outputs, weighed by the tests' noise where it is
/// known, by their scatter else [parameter x output].
Eigen::MatrixXd explaining_gain(const UpdatingProblem& problem, const TestMoments& tests,
                                const Eigen::MatrixXd& sensitivity, const Eigen::VectorXd& prior_std) {
  const Eigen::VectorXd& noise = problem.tests.repeatability_std;
  const Eigen::VectorXd scale = (noise.array() > 0.0).select(noise, tests.covariance.diagonal().cwiseSqrt());
  const Eigen::VectorXd whitening = scale.cwiseMax(1e-12 * tests.mean.cwiseAbs()).cwiseMax(1e-300).cwiseInverse();
  return least_change_gain(whitening.asDiagonal() * sensitivity, prior_std).matrix * whitening.asDiagonal();
}

}  // namespace

Eigen::VectorXd means_of_scattered(const UpdatingProblem& problem, const Eigen::VectorXd& point,
                                   const Eigen::MatrixXd& sensitivity, const RunContext& context,
                                   std::int64_t& evaluations) {
  const Eigen::VectorXd prior_std = prior_on_scales(problem.space).covariance.diagonal().cwiseSqrt();
  const TestMoments tests = test_moments(problem.tests);
  const Eigen::MatrixXd gain = explaining_gain(problem, tests, sensitivity, prior_std);
  const Eigen::VectorXd from = outputs_on_scales(problem, point.transpose(), context, evaluations).row(0);
  const Eigen::VectorXd centre = point + gain * (tests.mean - from);
  Eigen::MatrixXd own = tests.covariance;
  own.diagonal() -= problem.tests.repeatability_std.cwiseAbs2();
  const auto n = static_cast<double>(problem.tests.values.rows());
  const Eigen::MatrixXd scatter = (n - 1.0) / n * gain * own * gain.transpose();
  const Eigen::VectorXd unit = prior_std.cwiseInverse();
  const SymmetricEigen axes(unit.asDiagonal() * scatter * unit.asDiagonal());
  const Eigen::Index q = point.size();
  Eigen::MatrixXd points = centre.transpose().replicate(2 * q + 1, 1);
  for (Eigen::Index i = 0; i < q; ++i) {
    const double standard_deviation = std::sqrt(std::abs(axes.eigenvalues()(i)));
    const Eigen::RowVectorXd step = standard_deviation * prior_std.cwiseProduct(axes.eigenvectors().col(i)).transpose();
    points.row(1 + 2 * i) += step;
    points.row(2 + 2 * i) -= step;
  }
  const Eigen::MatrixXd outputs = outputs_on_scales(problem, points, context, evaluations);
  Eigen::VectorXd means = outputs.row(0);
  for (Eigen::Index i = 0; i < q; ++i) {
    const double sign = axes.eigenvalues()(i) < 0.0 ? -0.5 : 0.5;
    means += sign * (outputs.row(1 + 2 * i) + outputs.row(2 + 2 * i) - 2.0 * outputs.row(0)).transpose();
  }
  return means;
}

}  // namespace mottle::updating
