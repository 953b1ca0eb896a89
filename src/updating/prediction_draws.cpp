#include "prediction_draws.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/stats/standard_normal.hpp"

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

Eigen::MatrixXd PredictiveDraws::points(Kind kind) const {
  const Eigen::Index q = population_.mean.size();
  const auto n = static_cast<double>(population_.specimens);
  const Eigen::MatrixXd total = population_.covariance + population_.noise_share;
  const Eigen::VectorXd deviation = total.diagonal().cwiseSqrt();
  const Eigen::VectorXd scale = (deviation.array() > 0.0).select(deviation, 1.0);
  const Eigen::MatrixXd total_root = root_of(total, scale);
  const Eigen::MatrixXd plain_root = root_of(population_.covariance, scale);
  const bool is_exact = kind == Kind::population || population_.specimens == 0;
  Eigen::MatrixXd points(settings_.draws, q);
  for (Eigen::Index s = 0; s < settings_.draws; ++s) {
    const StreamKey key{
        .seed = context_.seed, .purpose = StreamPurpose::prediction, .iteration = static_cast<std::uint32_t>(kind)};
    RandomStream stream(key, static_cast<std::uint32_t>(s));
    if (is_exact) {
      points.row(s) = (population_.mean + plain_root * normals(stream, q)).transpose();
      continue;
    }
    Eigen::MatrixXd drawn;
    if (kind == Kind::outputs) {
      drawn = (n - 1.0) / chi_squared(stream, n - 1.0) * total;
    } else {
      drawn = total_root * inverse_wishart(stream, q, n - 1.0) * total_root.transpose();
    }
    const Eigen::VectorXd mean = population_.mean + root_of(drawn, scale) * normals(stream, q) / std::sqrt(n);
    points.row(s) = (mean + root_of(drawn - population_.noise_share, scale) * normals(stream, q)).transpose();
  }
  return points;
}

Eigen::MatrixXd PredictiveDraws::draw(Kind kind, Prediction& prediction) const {
  const Eigen::MatrixXd x = to_variables(space_.scales(), points(kind));
  std::vector<Eigen::Index> possible;
  for (Eigen::Index s = 0; s < x.rows(); ++s) {
    if (x.row(s).allFinite() && space_.is_possible(x.row(s))) possible.push_back(s);
  }
  Eigen::MatrixXd outputs = model_.evaluate(x(possible, Eigen::all), context_).outputs;
  prediction.model_evaluations += outputs.rows();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index s = 0; s < outputs.rows(); ++s) {
    if (outputs.row(s).allFinite()) kept.push_back(s);
  }
  prediction.impossible += settings_.draws - static_cast<Eigen::Index>(kept.size());
  if (2 * static_cast<Eigen::Index>(kept.size()) < settings_.draws) {
    throw SystemFailure(
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
