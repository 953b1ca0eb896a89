#include "mottle/updating/prediction.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/stats/descriptive.hpp"
#include "mottle/stats/standard_normal.hpp"
#include "prediction_draws.hpp"

namespace mottle {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

/// Moments on the scales of a population whose variables have the given moments: exact for identity and log, to first
/// order for a logit.
void to_scales(const std::vector<NormalScale>& scales, Eigen::VectorXd& mean, Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd x = mean;
  const Eigen::MatrixXd c = covariance;
  const auto kind = [&](Eigen::Index i) { return scales[static_cast<std::size_t>(i)].kind; };
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      const bool has_logs = kind(i) == NormalScale::Kind::log && kind(j) == NormalScale::Kind::log;
      const auto slope = [&](Eigen::Index k) {
        const NormalScale& scale = scales[static_cast<std::size_t>(k)];
        return scale.slope(scale.from_variable(x(k)));
      };
      covariance(i, j) = has_logs ? std::log1p(c(i, j) / (x(i) * x(j))) : c(i, j) / (slope(i) * slope(j));
    }
    mean(i) = scales[static_cast<std::size_t>(i)].from_variable(x(i));
    if (kind(i) == NormalScale::Kind::log) mean(i) -= 0.5 * covariance(i, i);
  }
}

/// (G' R^-1 G)^-1 over the directions that G sees; zero without noise.
Eigen::MatrixXd share_of_noise(const Eigen::MatrixXd& sensitivity, const Eigen::MatrixXd& noise,
                               const Eigen::VectorXd& scale) {
  const Eigen::Index q = scale.size();
  if (noise.size() == 0 || sensitivity.size() == 0 || noise.isZero(0.0)) return Eigen::MatrixXd::Zero(q, q);
  const double least = 1e-12 * noise.diagonal().maxCoeff();
  const Eigen::VectorXd weight = noise.diagonal().cwiseMax(least).cwiseInverse();
  const Eigen::MatrixXd g = sensitivity * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(g.transpose() * weight.asDiagonal() * g);
  constexpr double k_seen = 1e-8;
  const double largest = solver.eigenvalues().maxCoeff();
  const Eigen::VectorXd inverse =
      solver.eigenvalues().unaryExpr([&](double value) { return value > k_seen * largest ? 1.0 / value : 0.0; });
  const Eigen::MatrixXd turned = scale.asDiagonal() * solver.eigenvectors();
  return turned * inverse.asDiagonal() * turned.transpose();
}

double quantile_of(Eigen::VectorXd values, double probability) {
  std::sort(values.begin(), values.end());
  const double place =
      std::clamp(probability * static_cast<double>(values.size()) - 0.5, 0.0, static_cast<double>(values.size() - 1));
  const auto below = static_cast<Eigen::Index>(place);
  const Eigen::Index above = std::min(below + 1, values.size() - 1);
  return values(below) + (place - static_cast<double>(below)) * (values(above) - values(below));
}

}  // namespace

PredictedPopulation predicted_population(const ParameterSpace& space, const UpdatingResult& result,
                                         Eigen::Index specimens) {
  PredictedPopulation population{result.mean, result.covariance, {}, result.is_population ? specimens : 0};
  const std::vector<NormalScale> scales = space.scales();
  Eigen::VectorXd slope(result.mean.size());
  for (Eigen::Index i = 0; i < slope.size(); ++i) {
    const NormalScale& scale = scales[static_cast<std::size_t>(i)];
    slope(i) = scale.slope(scale.from_variable(result.mean(i)));
  }
  const Eigen::VectorXd prior_std = space.prior().covariance().diagonal().cwiseSqrt();
  const Eigen::MatrixXd share = share_of_noise(result.sensitivity, result.noise_covariance, prior_std);
  population.noise_share = slope.cwiseInverse().asDiagonal() * share * slope.cwiseInverse().asDiagonal();
  if (!result.is_population) population.noise_share.setZero();
  to_scales(scales, population.mean, population.covariance);
  return population;
}

Eigen::VectorXd squared_distances(const Prediction& prediction, const Eigen::Ref<const Eigen::MatrixXd>& values) {
  // Outputs without scatter of their own count with a millionth of their correlation: a region has no flat sides.
  constexpr double k_least = 1e-9;
  const Eigen::VectorXd deviation = prediction.covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::MatrixXd correlation =
      deviation.cwiseInverse().asDiagonal() * prediction.covariance * deviation.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(correlation);
  const Eigen::VectorXd root = solver.eigenvalues().unaryExpr(
      [&](double value) { return value > k_least ? 1.0 / std::sqrt(value) : 1.0 / std::sqrt(k_least); });
  Eigen::VectorXd distances(values.rows());
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    const Eigen::VectorXd apart = (values.row(s).transpose() - prediction.mean).cwiseQuotient(deviation);
    distances(s) =
        apart.allFinite() ? (root.asDiagonal() * (solver.eigenvectors().transpose() * apart)).squaredNorm() : k_nan;
  }
  return distances;
}

Prediction predict(const Model& model, const ParameterSpace& space, const PredictedPopulation& population,
                   const PredictionSettings& settings, const RunContext& context) {
  Prediction prediction;
  const PredictiveDraws maker(model, space, population, settings, context);
  const Eigen::MatrixXd plain = maker.draw(PredictiveDraws::Kind::population, prediction);
  prediction.mean = sample_mean(plain);
  prediction.covariance = sample_covariance(plain);
  prediction.covariance.diagonal() += settings.noise_std.cwiseAbs2();
  prediction.draws = maker.draw(PredictiveDraws::Kind::outputs, prediction);
  prediction.interval.resize(prediction.mean.size(), 2);
  for (Eigen::Index k = 0; k < prediction.mean.size(); ++k) {
    prediction.interval(k, 0) = quantile_of(prediction.draws.col(k), 0.5 * settings.level);
    prediction.interval(k, 1) = quantile_of(prediction.draws.col(k), 1.0 - 0.5 * settings.level);
  }
  prediction.joint_critical = k_nan;
  if (population.specimens == 0 || population.specimens - 1 > population.mean.size()) {
    const Eigen::MatrixXd joint = maker.draw(PredictiveDraws::Kind::joint, prediction);
    prediction.joint_critical = quantile_of(squared_distances(prediction, joint), 1.0 - settings.level);
  }
  return prediction;
}

}  // namespace mottle
