#include "updating/estimate/normal_draws.hpp"

#include <Eigen/Core>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/covariance_axes.hpp"

namespace mottle::updating {
namespace {

double chi_squared(RandomStream& stream, double degrees_of_freedom) {
  return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), stream.uniform());
}

/// sqrt(nu / chi2_nu) of each variable, all at one probability; 1 where nothing is determined.
Eigen::VectorXd blown_deviations(RandomStream& stream, const Eigen::VectorXd& degrees_of_freedom) {
  const double probability = stream.uniform();
  return degrees_of_freedom.unaryExpr([&](double nu) {
    if (!(nu > 0.0)) return 1.0;
    return std::sqrt(nu / boost::math::quantile(boost::math::chi_squared(nu), probability));
  });
}

/// Inverse of a Wishart matrix with scale I / freedom, by Bartlett's decomposition.
Eigen::MatrixXd inverse_wishart(RandomStream& stream, Eigen::Index size, double degrees_of_freedom) {
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    factor(i, i) = std::sqrt(chi_squared(stream, degrees_of_freedom - static_cast<double>(i)));
    for (Eigen::Index j = 0; j < i; ++j) factor(i, j) = standard_normal_quantile(stream.uniform());
  }
  const Eigen::MatrixXd inverse = factor.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(size, size));
  return degrees_of_freedom * (inverse.transpose() * inverse);
}

RandomStream stream_of(const SpecimenDrawing& drawing, Eigen::Index draw) {
  const StreamKey key{.seed = drawing.seed,
                      .purpose = StreamPurpose::prediction,
                      .iteration = static_cast<std::uint32_t>(drawing.kind)};
  return {key, static_cast<std::uint32_t>(draw)};
}

Eigen::VectorXd scale_of(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd standard_deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  return (standard_deviation.array() > 0.0).select(standard_deviation, 1.0);
}

}  // namespace

Eigen::MatrixXd scaled_root(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& scale) {
  return CovarianceAxes(matrix, scale).symmetric_root();
}

Eigen::VectorXd standard_normals(RandomStream& stream, Eigen::Index count) {
  Eigen::VectorXd z(count);
  for (Eigen::Index i = 0; i < count; ++i) z(i) = standard_normal_quantile(stream.uniform());
  return z;
}

double joint_degrees_of_freedom(const PopulationEvidence& evidence) {
  const Eigen::VectorXd degrees_of_freedom = evidence.degrees_of_freedom.diagonal();
  const auto determined = (degrees_of_freedom.array() > 0.0).count();
  return determined > 0 ? degrees_of_freedom.sum() / static_cast<double>(determined) : 0.0;
}

Eigen::MatrixXd draw_exact(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                           const SpecimenDrawing& drawing) {
  const Eigen::MatrixXd root = scaled_root(covariance, scale_of(covariance));
  Eigen::MatrixXd points(drawing.draws, mean.size());
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    RandomStream stream = stream_of(drawing, s);
    points.row(s) = (mean + root * standard_normals(stream, mean.size())).transpose();
  }
  return points;
}

Eigen::MatrixXd draw_uncertain(const PopulationOnScales& population, const SpecimenDrawing& drawing) {
  const PopulationEvidence& evidence = population.evidence;
  const Eigen::Index q = population.mean.size();
  const Eigen::MatrixXd& total = evidence.total;
  const Eigen::VectorXd scale = scale_of(total);
  const Eigen::MatrixXd total_root = scaled_root(total, scale);
  Eigen::MatrixXd mean_covariance = evidence.mean_covariance;
  // What the model's error makes of it is drawn with the error itself, since the predicted outputs have it too.
  if (drawing.has_model_error && evidence.mean_shared.size() > 0) mean_covariance -= evidence.mean_shared;
  const Eigen::MatrixXd mean_root = scaled_root(mean_covariance, scale);
  Eigen::MatrixXd points(drawing.draws, q);
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    RandomStream stream = stream_of(drawing, s);
    // What the population may be: factors on total and on the mean's covariance.
    Eigen::MatrixXd blown;
    Eigen::MatrixXd blown_mean;
    if (drawing.kind == SpecimenDrawing::Kind::outputs) {
      const Eigen::VectorXd factor = blown_deviations(stream, evidence.degrees_of_freedom.diagonal());
      blown = factor.asDiagonal() * total * factor.asDiagonal();
      blown_mean = factor.asDiagonal() * mean_root;
    } else {
      const Eigen::MatrixXd wishart = inverse_wishart(stream, q, joint_degrees_of_freedom(evidence));
      blown = total_root * wishart * total_root.transpose();
      blown_mean = scaled_root(mean_root * wishart * mean_root.transpose(), scale);
    }
    const Eigen::VectorXd mean = population.mean + blown_mean * standard_normals(stream, q);
    points.row(s) = (mean + scaled_root(blown - evidence.noise, scale) * standard_normals(stream, q)).transpose();
    if (drawing.mean_shift.size() > 0) points.row(s) += drawing.mean_shift.row(s);
  }
  return points;
}

}  // namespace mottle::updating
