#include "updating/prediction/prediction_draws.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle {
namespace {

/// The symmetric square root of what is positive in a matrix, in units of `scale`: an elastic modulus and a thickness
/// have variances twenty-five orders of magnitude apart.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& scale) {
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(inverse.asDiagonal() * matrix * inverse.asDiagonal());
  return scale.asDiagonal() * solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         solver.eigenvectors().transpose();
}

Eigen::VectorXd normals(RandomStream& stream, Eigen::Index count) {
  Eigen::VectorXd z(count);
  for (Eigen::Index i = 0; i < count; ++i) z(i) = standard_normal_quantile(stream.uniform());
  return z;
}

double chi_squared(RandomStream& stream, double freedom) {
  return boost::math::quantile(boost::math::chi_squared(freedom), stream.uniform());
}

/// sqrt(nu / chi2_nu) of each variable, all at one probability; 1 where nothing is determined.
Eigen::VectorXd blown_deviations(RandomStream& stream, const Eigen::VectorXd& freedom) {
  const double probability = stream.uniform();
  return freedom.unaryExpr([&](double nu) {
    if (!(nu > 0.0)) return 1.0;
    return std::sqrt(nu / boost::math::quantile(boost::math::chi_squared(nu), probability));
  });
}

/// Inverse of a Wishart matrix with scale I / freedom, by Bartlett's decomposition.
Eigen::MatrixXd inverse_wishart(RandomStream& stream, Eigen::Index size, double freedom) {
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    factor(i, i) = std::sqrt(chi_squared(stream, freedom - static_cast<double>(i)));
    for (Eigen::Index j = 0; j < i; ++j) factor(i, j) = standard_normal_quantile(stream.uniform());
  }
  const Eigen::MatrixXd inverse = factor.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(size, size));
  return freedom * (inverse.transpose() * inverse);
}

}  // namespace

/// Mean degrees of freedom of the variances that the specimens determine.
double PredictiveDraws::joint_freedom() const {
  const Eigen::VectorXd freedom = population_.estimate.evidence.freedom.diagonal();
  const auto determined = (freedom.array() > 0.0).count();
  return determined > 0 ? freedom.sum() / static_cast<double>(determined) : 0.0;
}

bool PredictiveDraws::has_joint_region() const {
  return population_.specimens == 0 || joint_freedom() > static_cast<double>(population_.estimate.mean.size());
}

PredictiveDraws::PredictiveDraws(const Model& model, const ParameterSpace& space, const PredictedPopulation& population,
                                 const PredictionSettings& settings, const RunContext& context)
    : model_(model), space_(space), population_(population), settings_(settings), context_(context) {
  if (!settings.model_error) return;
  const ModelError& error = settings.model_error->estimate;
  error_root_ = root_of(error.covariance, (error.std.array() > 0.0).select(error.std, 1.0));
}

/// The error of the tested outputs in one draw; its estimate where estimates are taken as exact.
Eigen::VectorXd PredictiveDraws::shared_error(Kind kind, Eigen::Index draw) const {
  const ModelError& error = settings_.model_error->estimate;
  if (kind == Kind::population) return error.shift;
  const StreamKey key{
      .seed = context_.seed, .purpose = StreamPurpose::prediction, .iteration = 8 + static_cast<std::uint32_t>(kind)};
  RandomStream stream(key, static_cast<std::uint32_t>(draw));
  return error.shift + error_root_ * normals(stream, error.shift.size());
}

/// @param draws  of each row of the outputs
void PredictiveDraws::add_model_error(Kind kind, const std::vector<Eigen::Index>& draws,
                                      Eigen::MatrixXd& outputs) const {
  const PredictedError& error = *settings_.model_error;
  const StreamKey key{.seed = context_.seed,
                      .purpose = StreamPurpose::prediction_noise,
                      .iteration = 8 + static_cast<std::uint32_t>(kind)};
  for (Eigen::Index row = 0; row < outputs.rows(); ++row) {
    const Eigen::Index draw = draws[static_cast<std::size_t>(row)];
    const Eigen::VectorXd shared = shared_error(kind, draw);
    for (std::size_t k = 0; k < error.tested.size(); ++k) {
      if (error.tested[k] >= 0) outputs(row, static_cast<Eigen::Index>(k)) += shared(error.tested[k]);
    }
    if (kind == Kind::population) continue;
    RandomStream stream(key, static_cast<std::uint32_t>(draw));
    outputs.row(row) += normals(stream, outputs.cols()).cwiseProduct(error.own_std).transpose();
  }
}

Eigen::MatrixXd PredictiveDraws::points(Kind kind) const {
  const PopulationOnScales& estimate = population_.estimate;
  const PopulationEvidence& evidence = estimate.evidence;
  const Eigen::Index q = estimate.mean.size();
  const bool is_exact = kind == Kind::population || population_.specimens == 0;
  const Eigen::MatrixXd& total = is_exact ? estimate.covariance : evidence.total;
  const Eigen::VectorXd deviation = total.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd scale = (deviation.array() > 0.0).select(deviation, 1.0);
  const Eigen::MatrixXd total_root = root_of(total, scale);
  Eigen::MatrixXd mean_covariance = evidence.mean_covariance;
  // What the model's error makes of it is drawn with the error itself, since the predicted outputs have it too.
  if (settings_.model_error && evidence.mean_shared.size() > 0) mean_covariance -= evidence.mean_shared;
  const Eigen::MatrixXd mean_root = is_exact ? Eigen::MatrixXd() : root_of(mean_covariance, scale);
  Eigen::MatrixXd points(settings_.draws, q);
  for (Eigen::Index s = 0; s < settings_.draws; ++s) {
    const StreamKey key{
        .seed = context_.seed, .purpose = StreamPurpose::prediction, .iteration = static_cast<std::uint32_t>(kind)};
    RandomStream stream(key, static_cast<std::uint32_t>(s));
    if (is_exact) {
      points.row(s) = (estimate.mean + total_root * normals(stream, q)).transpose();
      continue;
    }
    // What the population may be: factors on total and on the mean's covariance.
    Eigen::MatrixXd blown;
    Eigen::MatrixXd blown_mean;
    if (kind == Kind::outputs) {
      const Eigen::VectorXd factor = blown_deviations(stream, evidence.freedom.diagonal());
      blown = factor.asDiagonal() * total * factor.asDiagonal();
      blown_mean = factor.asDiagonal() * mean_root;
    } else {
      const Eigen::MatrixXd wishart = inverse_wishart(stream, q, joint_freedom());
      blown = total_root * wishart * total_root.transpose();
      blown_mean = root_of(mean_root * wishart * mean_root.transpose(), scale);
    }
    const Eigen::VectorXd mean = estimate.mean + blown_mean * normals(stream, q);
    points.row(s) = (mean + root_of(blown - evidence.noise, scale) * normals(stream, q)).transpose();
    if (settings_.model_error) {
      const ModelError& error = settings_.model_error->estimate;
      points.row(s) += (error.gain * (shared_error(kind, s) - error.shift)).transpose();
    }
  }
  return points;
}

Eigen::MatrixXd PredictiveDraws::draw(Kind kind, Prediction& prediction) const {
  const Eigen::MatrixXd t = points(kind);
  const Eigen::MatrixXd x = population_.scales.empty() ? t : to_variables(population_.scales, t);
  std::vector<Eigen::Index> possible;
  for (Eigen::Index s = 0; s < x.rows(); ++s) {
    if (x.row(s).allFinite() && space_.is_possible(x.row(s))) possible.push_back(s);
  }
  Eigen::MatrixXd outputs = model_.evaluate(x(possible, Eigen::all), context_).outputs;
  prediction.model_evaluations += outputs.rows();
  if (settings_.model_error) add_model_error(kind, possible, outputs);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index s = 0; s < outputs.rows(); ++s) {
    if (outputs.row(s).allFinite()) kept.push_back(s);
  }
  prediction.impossible += settings_.draws - static_cast<Eigen::Index>(kept.size());
  if (2 * static_cast<Eigen::Index>(kept.size()) < settings_.draws) {
    throw ModelFailure(
        fmt::format("predict: {} of {} draws of new specimens are physically impossible or fail in the "
                    "model; the population is too wide",
                    settings_.draws - static_cast<Eigen::Index>(kept.size()), settings_.draws));
  }
  outputs = outputs(kept, Eigen::all).eval();
  if (kind == Kind::population) return outputs;
  const StreamKey key{
      .seed = context_.seed, .purpose = StreamPurpose::prediction_noise, .iteration = static_cast<std::uint32_t>(kind)};
  for (Eigen::Index s = 0; s < outputs.rows(); ++s) {
    RandomStream stream(key, static_cast<std::uint32_t>(s));
    outputs.row(s) += normals(stream, outputs.cols()).cwiseProduct(settings_.noise_std).transpose();
  }
  return outputs;
}

}  // namespace mottle
