#include "updating/methods/abc_search.hpp"

#include <cmath>

#include "mottle/stats/moments/descriptive.hpp"

namespace mottle::updating {
namespace {

constexpr int k_comparable_from = 3;  // and only up to it a second start is tried, so that none alternates with it
/// Distances that differ by less, over the number of specimens, are alike: of a normal sample 0.002 of ln likelihood.
/// Few specimens leave several populations that are as near.
constexpr double k_alike = 0.002;
constexpr double k_whole_steps =
    4.0;  // iterations; later ones go a part of the way, as the surfaces of two clouds differ

/// How far one iteration may go: where the surface of the last cloud says something.
struct Limits {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
};

Limits limits_around(const PopulationCoordinates& coordinates, const Eigen::VectorXd& at) {
  constexpr double k_reach = 3.0;        // standard deviations of the cloud ...
  constexpr double k_least_reach = 0.3;  // ... and of the prior, where the cloud has hardly any
  constexpr double k_shrink = 1.0;       // of the logarithm of a standard deviation
  constexpr double k_grow = 1.0;
  const Eigen::Index q = coordinates.parameters();
  Limits limits{coordinates.lower(), coordinates.upper()};
  for (Eigen::Index i = 0; i < q; ++i) {
    const double reach = k_reach * std::exp(at(q + i)) + k_least_reach;
    limits.lower(i) = std::max(limits.lower(i), at(i) - reach);
    limits.upper(i) = std::min(limits.upper(i), at(i) + reach);
    limits.lower(q + i) = std::max(limits.lower(q + i), at(q + i) - k_shrink);
    limits.upper(q + i) = std::min(limits.upper(q + i), at(q + i) + k_grow);
  }
  return limits;
}

SampleComparison comparison_of(const UpdatingProblem& problem, SampleDistance distance, const Eigen::MatrixXd& cloud,
                               const SampledPopulation& population, const RunContext& context) {
  const Eigen::MatrixXd covariance =
      comparison_covariance(problem.tests, sample_covariance(cloud), population.noise_std);
  return {distance, problem.tests.values, covariance, context.seed};
}

double movement(const PopulationCoordinates& coordinates, const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
  const Eigen::Index q = coordinates.parameters();
  const Eigen::ArrayXd means = (after - before).head(q).cwiseAbs();
  const Eigen::ArrayXd deviations = (after.segment(q, q).array().exp() - before.segment(q, q).array().exp()).abs();
  return std::max(means.maxCoeff(), deviations.maxCoeff());
}

}  // namespace

NearestPopulation find_nearest_population(const UpdatingProblem& problem, const ScaledParameters& parameters,
                                          const PopulationCoordinates& coordinates, SampleDistance distance,
                                          const RunContext& context, UpdatingResult& result) {
  const TestMoments tests = test_moments(problem.tests);
  const auto specimens = static_cast<double>(problem.tests.values.rows());
  NearestPopulation found{coordinates.start(), nullptr, nullptr, {}, {}};
  Cloud cloud = result.history.front().cloud;
  result.status = UpdatingStatus::max_iterations;
  for (int iteration = 1; iteration <= problem.iterations; ++iteration) {
    if (context.stop_requested()) {
      result.status = UpdatingStatus::stopped;
      break;
    }
    found.transport = std::make_shared<CloudTransport>(cloud, parameters);
    const MovingCloud moving(coordinates, *found.transport, k_cloud_points, context.seed);
    const Eigen::MatrixXd slopes = found.transport->sensitivity(coordinates.at(found.coordinates).mean) *
                                   coordinates.prior_deviations().asDiagonal();
    found.offset = SharedOffset(problem, slopes, moving.at(found.coordinates));
    const Eigen::MatrixXd values = found.offset.taken_off(problem.tests.values);
    if (iteration <= k_comparable_from) {
      found.comparison = std::make_shared<SampleComparison>(
          comparison_of(problem, distance, moving.at(found.coordinates), coordinates.at(found.coordinates), context));
    }
    const auto [lower, upper] = limits_around(coordinates, found.coordinates);
    Eigen::VectorXd next = nearest_population(coordinates, moving, *found.comparison, values, found.coordinates, lower,
                                              upper, iteration <= k_comparable_from);
    const auto distance_at = [&](const Eigen::VectorXd& at) {
      return found.comparison->distance(moving.at(at), values);
    };
    const bool is_as_near = distance_at(found.coordinates) - distance_at(next) <= k_alike / specimens;
    if (iteration > k_comparable_from && is_as_near) next = found.coordinates;
    const double moved = movement(coordinates, found.coordinates, next);
    found.coordinates += std::min(1.0, k_whole_steps / iteration) * (next - found.coordinates);
    const double value = distance_at(found.coordinates);
    found.distances.push_back(distance == SampleDistance::energy ? value : std::sqrt(std::max(value, 0.0)));
    const SampledPopulation population = coordinates.at(found.coordinates);
    IterationRecord state = record_state(
        problem, tests,
        JointDistribution::transformed_normal(parameters.scales(), population.mean, population.covariance()), iteration,
        context);
    cloud = state.cloud;
    append_state(result, std::move(state));
    if (moved <= problem.tolerance && iteration >= k_comparable_from) {
      result.status = UpdatingStatus::converged;
      break;
    }
  }
  if (found.transport) found.transport = std::make_shared<CloudTransport>(cloud, parameters);
  result.message =
      ending_message(result.status, result.history.size() - 1, problem.tolerance,
                     {.at_rest = "no mean and no standard deviation moves", .moving = "means and standard deviations"});
  return found;
}

}  // namespace mottle::updating
