#include "mottle/updating/prediction/prediction.hpp"

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/covariance_axes.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/moments/quantiles.hpp"
#include "updating/prediction/prediction_draws.hpp"

namespace mottle::updating {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

Eigen::VectorXd squared_distances(const Prediction& prediction, const Eigen::Ref<const Eigen::MatrixXd>& values) {
  // Outputs without scatter of their own count with a millionth of their correlation: a region has no flat sides.
  constexpr double k_min = 1e-9;
  const CovarianceAxes axes(prediction.covariance);
  Eigen::VectorXd distances(values.rows());
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    const Eigen::VectorXd apart = values.row(s).transpose() - prediction.mean;
    distances(s) = apart.allFinite() ? axes.whitened(apart, k_min).squaredNorm() : k_nan;
  }
  return distances;
}

Prediction predict(const Model& model, const ParameterSpace& space, const Estimate& estimate,
                   const PredictionSettings& settings, const RunContext& context) {
  Prediction prediction;
  const PredictiveDraws maker(model, space, estimate, settings, context);
  const Eigen::MatrixXd plain = maker.draw(PredictiveDraws::Kind::population, prediction);
  prediction.mean = sample_mean(plain);
  prediction.covariance = sample_covariance(plain);
  prediction.covariance.diagonal() += settings.noise_std.cwiseAbs2();
  if (settings.model_error) prediction.covariance.diagonal() += settings.model_error->own_std.cwiseAbs2();
  prediction.draws = maker.draw(PredictiveDraws::Kind::outputs, prediction);
  prediction.interval.resize(prediction.mean.size(), 2);
  for (Eigen::Index k = 0; k < prediction.mean.size(); ++k) {
    const auto draws = prediction.draws.col(k);
    prediction.interval.row(k) =
        equal_tails({draws.begin(), draws.end()}, 1.0 - settings.level, QuantileRule::midpoints);
  }
  prediction.joint_critical = k_nan;
  if (estimate.has_joint_region()) {
    const Eigen::MatrixXd joint = maker.draw(PredictiveDraws::Kind::joint, prediction);
    const Eigen::VectorXd distances = squared_distances(prediction, joint);
    prediction.joint_critical =
        quantile({distances.begin(), distances.end()}, 1.0 - settings.level, QuantileRule::midpoints);
  }
  return prediction;
}

}  // namespace mottle::updating
