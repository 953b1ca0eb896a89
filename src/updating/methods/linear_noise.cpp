#include "updating/methods/linear_noise.hpp"

#include <cmath>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/updating/methods/deterministic.hpp"
#include "updating/methods/least_squares.hpp"

namespace mottle::updating {

Linearised LinearNoise::best(const PosteriorPeak& peak, const Eigen::VectorXd& levels) const {
  constexpr int k_steps = 8;
  constexpr int k_halvings = 4;
  constexpr double k_rest = 1e-10;
  const Eigen::VectorXd start = peak.scores.head(problem_.space.count());
  Linearised at{start, peak.outputs, peak.sensitivity * problem_.space.prior().standard_normal_derivatives(start)};
  for (int step = 0; step < k_steps; ++step) {
    const Eigen::VectorXd move = given(at, levels).scores - at.scores;
    double length = 1.0;
    for (int halving = 0; halving < k_halvings; ++halving, length *= 0.5) {
      const Eigen::VectorXd next = at.scores + length * move;
      const std::optional<Eigen::VectorXd> outputs = outputs_at(next);
      if (!outputs || !(cost(next, *outputs, levels) < cost(at.scores, at.outputs, levels))) continue;
      at = linearised(next, *outputs);
      break;
    }
    if (!(length * move.norm() > k_rest) || length < std::exp2(-k_halvings + 0.5)) break;
  }
  return at;
}

LinearPosterior LinearNoise::given(const Linearised& at, const Eigen::VectorXd& levels) const {
  const Eigen::VectorXd roots = precision_roots(levels);
  const Eigen::VectorXd apart = likelihood_.mean() - at.outputs + at.slopes * at.scores;
  const SingularValues svd(roots.asDiagonal() * at.slopes, Eigen::ComputeThinU | Eigen::ComputeFullV);
  const Eigen::ArrayXd s = svd.values().array();
  const Eigen::VectorXd along = svd.left().transpose() * roots.cwiseProduct(apart);
  LinearPosterior found;
  found.axes = svd.right();
  found.deviations = Eigen::VectorXd::Ones(found.axes.cols());
  found.deviations.head(s.size()) = (1.0 + s.square()).rsqrt();
  found.scores = found.axes.leftCols(s.size()) * (s / (1.0 + s.square()) * along.array()).matrix();
  found.squares = roots.cwiseProduct(apart - at.slopes * found.scores).squaredNorm() + found.scores.squaredNorm();
  found.log_determinant = (1.0 + s.square()).log().sum();
  for (const double root : roots) found.log_determinant -= root > 0.0 ? 2.0 * std::log(root) : 0.0;
  return found;
}

double LinearNoise::log_density(const Linearised& at, const Eigen::VectorXd& levels) const {
  const LinearPosterior found = given(at, levels);
  const Eigen::VectorXd variances = noise_.variances(levels);
  double sum = found.squares + found.log_determinant;
  for (Eigen::Index k = 0; k < variances.size(); ++k) {
    const double count = likelihood_.count()(k);
    if (count > 1.0) sum += (count - 1.0) * std::log(variances(k)) + likelihood_.scatter()(k) / variances(k);
  }
  return -0.5 * sum;
}

Eigen::VectorXd LinearNoise::variables(const Eigen::VectorXd& scores) const {
  return problem_.space.prior().from_standard_normal(scores.transpose()).row(0).transpose();
}

std::optional<Eigen::VectorXd> LinearNoise::outputs_at(const Eigen::VectorXd& scores) const {
  const Eigen::VectorXd x = variables(scores);
  if (!are_possible(problem_.space, x.transpose()).front()) return std::nullopt;
  std::optional<Eigen::VectorXd> outputs = evaluate_one(problem_, x, context_, evaluations_);
  return outputs && outputs->allFinite() ? outputs : std::nullopt;
}

Linearised LinearNoise::linearised(const Eigen::VectorXd& scores, const Eigen::VectorXd& outputs) const {
  const Eigen::VectorXd prior_std = problem_.space.prior().covariance().diagonal().cwiseSqrt();
  const Eigen::MatrixXd of_variables = model_jacobian(problem_, variables(scores), prior_std, context_, evaluations_);
  return {scores, outputs, of_variables * problem_.space.prior().standard_normal_derivatives(scores)};
}

/// Of the tests' means, 0 of what is not measured.
Eigen::VectorXd LinearNoise::precision_roots(const Eigen::VectorXd& levels) const {
  const Eigen::VectorXd variance = likelihood_.variance_of_mean(noise_.variances(levels));
  return (likelihood_.count().array() > 0.0).select(variance.cwiseInverse().cwiseSqrt(), 0.0);
}

double LinearNoise::cost(const Eigen::VectorXd& scores, const Eigen::VectorXd& outputs,
                         const Eigen::VectorXd& levels) const {
  return precision_roots(levels).cwiseProduct(likelihood_.mean() - outputs).squaredNorm() + scores.squaredNorm();
}

}  // namespace mottle::updating
