#include "updating/methods/distance_fit.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::updating {
namespace {

/// 1 where a variable may follow the falling gradient, 0 where a limit holds it.
Eigen::ArrayXd free_variables(const Eigen::VectorXd& at, const Eigen::VectorXd& gradient, const Eigen::VectorXd& lower,
                              const Eigen::VectorXd& upper) {
  return Eigen::ArrayXd::NullaryExpr(at.size(), [&](Eigen::Index k) {
    const bool is_held = (at(k) <= lower(k) && gradient(k) > 0.0) || (at(k) >= upper(k) && gradient(k) < 0.0);
    return is_held ? 0.0 : 1.0;
  });
}

/// Gives noise mean 0, covariance I and no correlation with the points, which have these moments. What chance leaves of
/// them would move the nearest population, most where noise hides much of the scatter.
void balance(const Eigen::MatrixXd& points, Eigen::MatrixXd& noise) {
  const auto count = static_cast<double>(noise.rows());
  noise.rowwise() -= noise.colwise().mean();
  noise -= points * (points.transpose() * noise / count);
  const Eigen::MatrixXd covariance = noise.transpose() * noise / count;
  // More outputs than that would leave hardly any chance in the noise.
  const bool has_room = 4 * (points.cols() + noise.cols() + 1) <= noise.rows();
  const CholeskyFactor factor(covariance);
  if (has_room && factor.is_positive_definite()) {
    noise = factor.solve_lower(noise.transpose()).transpose();
  } else {
    noise *= covariance.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse().asDiagonal();
  }
}

/// BFGS's change of the inverse Hessian; left as it is where the curvature is not positive.
void learn(const Eigen::VectorXd& step, const Eigen::VectorXd& change, Eigen::MatrixXd& inverse) {
  constexpr double k_flat = 1e-12;
  const double curvature = step.dot(change);
  if (!(curvature > k_flat * step.norm() * change.norm())) return;
  const Eigen::VectorXd moved = inverse * change;
  const double factor = (1.0 + change.dot(moved) / curvature) / curvature;
  inverse += factor * step * step.transpose() - (step * moved.transpose() + moved * step.transpose()) / curvature;
}

}  // namespace

Eigen::VectorXd minimise_within(const std::function<ValueAndGradient(const Eigen::VectorXd&)>& function,
                                const Eigen::VectorXd& start, const Eigen::VectorXd& lower,
                                const Eigen::VectorXd& upper, double tolerance, int iterations) {
  constexpr double k_sufficient = 1e-4;
  constexpr int k_halvings = 30;
  constexpr double k_longest = 1.0;
  Eigen::VectorXd at = start.cwiseMax(lower).cwiseMin(upper);
  ValueAndGradient here = function(at);
  const Eigen::Index size = at.size();
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(size, size);
  Eigen::ArrayXd free = free_variables(at, here.gradient, lower, upper);
  for (int iteration = 0; iteration < iterations; ++iteration) {
    Eigen::VectorXd direction = -free * (inverse * (free * here.gradient.array()).matrix()).array();
    if (!(direction.dot(here.gradient) < 0.0)) direction = -free * here.gradient.array();
    const double longest = direction.cwiseAbs().maxCoeff();
    if (longest <= tolerance) break;
    if (longest > k_longest) direction *= k_longest / longest;
    Eigen::VectorXd next;
    ValueAndGradient there;
    bool has_fallen = false;
    double length = 1.0;
    for (int halving = 0; halving < k_halvings && !has_fallen; ++halving, length *= 0.5) {
      next = (at + length * direction).cwiseMax(lower).cwiseMin(upper);
      there = function(next);
      has_fallen = there.value <= here.value + k_sufficient * here.gradient.dot(next - at);
    }
    if (!has_fallen) {
      if (inverse.isIdentity(0.0)) break;
      inverse.setIdentity();  // what was learnt across a kink misleads
      continue;
    }
    const Eigen::VectorXd step = next - at;
    learn(step, there.gradient - here.gradient, inverse);
    at = next;
    here = there;
    const Eigen::ArrayXd now = free_variables(at, here.gradient, lower, upper);
    if ((now != free).any()) inverse.setIdentity();
    free = now;
    if (step.cwiseAbs().maxCoeff() <= tolerance) break;
  }
  return at;
}

MovingCloud::MovingCloud(const PopulationCoordinates& coordinates, const CloudTransport& transport,
                         Eigen::Index samples, std::uint64_t seed)
    : coordinates_(coordinates), transport_(transport), base_(transport.thinned(samples)) {
  const StreamKey key{.seed = seed, .purpose = StreamPurpose::abc_noise};
  noise_ = uniform_design(SamplingDesign::latin_hypercube, base_.residual.rows(), base_.residual.cols(), key)
               .unaryExpr(&standard_normal_quantile);
  balance(base_.points, noise_);
}

Eigen::MatrixXd MovingCloud::at(const Eigen::Ref<const Eigen::VectorXd>& coordinates) const {
  const SampledPopulation population = coordinates_.at(coordinates);
  return transport_.outputs(population, base_) + noise_ * population.noise_std.asDiagonal();
}

std::vector<Eigen::MatrixXd> MovingCloud::slopes(const Eigen::Ref<const Eigen::VectorXd>& coordinates) const {
  constexpr double k_step = 1e-4;
  std::vector<Eigen::MatrixXd> slopes;
  for (Eigen::Index k = 0; k < coordinates.size(); ++k) {
    Eigen::VectorXd ahead = coordinates;
    Eigen::VectorXd behind = coordinates;
    ahead(k) += k_step;
    behind(k) -= k_step;
    slopes.emplace_back((at(ahead) - at(behind)) / (2.0 * k_step));
  }
  return slopes;
}

Eigen::VectorXd nearest_population(const PopulationCoordinates& coordinates, const MovingCloud& cloud,
                                   const SampleComparison& comparison, const Eigen::MatrixXd& tests,
                                   const Eigen::VectorXd& start, const Eigen::VectorXd& lower,
                                   const Eigen::VectorXd& upper, bool tries_wider) {
  constexpr double k_tolerance = 1e-5;
  constexpr int k_iterations = 100;
  constexpr double k_wider = 1.0;
  constexpr double k_better = 1e-6;
  const double pull = 0.1 / static_cast<double>(tests.rows());
  const auto penalised = [&](const Eigen::VectorXd& at) {
    const Eigen::MatrixXd outputs = cloud.at(at);
    const DistanceGradient gradient(comparison, outputs, cloud.slopes(at));
    const Eigen::VectorXd z = coordinates.fisher_z(at);
    ValueAndGradient found{comparison.distance(outputs, tests) + 0.5 * pull * z.squaredNorm(),
                           gradient.of_tests(tests) + gradient.of_cloud()};
    found.gradient.segment(2 * coordinates.parameters(), z.size()) += pull * z;
    return found;
  };
  Eigen::VectorXd first = minimise_within(penalised, start, lower, upper, k_tolerance, k_iterations);
  if (!tries_wider) return first;
  // A standard deviation that once is far too small has no slope any more: the second start has larger ones.
  Eigen::VectorXd wider = start;
  wider.segment(coordinates.parameters(), coordinates.parameters()).array() += k_wider;
  const Eigen::VectorXd second = minimise_within(penalised, wider, lower, upper, k_tolerance, k_iterations);
  return penalised(second).value < penalised(first).value - k_better ? second : first;
}

}  // namespace mottle::updating
