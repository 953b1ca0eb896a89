#include "mottle/updating/methods/iteration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/subject.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/moments/distance.hpp"

namespace mottle::updating {

namespace {

Eigen::VectorXi measured_counts(const Eigen::MatrixXd& values) {
  return (!values.array().isNaN()).cast<int>().colwise().sum();
}

}  // namespace

TestMoments test_moments(const TestData& tests) {
  const Eigen::MatrixXd& values = tests.values;
  require_of(values.rows() >= 1, {Subject::Kind::tests}, "there is no specimen");
  require_of(values.rows() > 1 || values.allFinite(), {Subject::Kind::tests}, "the only specimen has missing values");
  const Eigen::Index p = values.cols();
  TestMoments found{Eigen::VectorXd(p), Eigen::MatrixXd::Zero(p, p), measured_counts(values)};
  std::vector<Eigen::Index> scattered;
  for (Eigen::Index k = 0; k < p; ++k) {
    require_of(found.count(k) > 0, {Subject::Kind::tests}, "output {} (from 1) has no measured value", k + 1);
    if (found.count(k) > 1)
      scattered.push_back(k);
    else
      found.mean(k) = values.col(k).array().isNaN().select(0.0, values.col(k).array()).sum();
  }
  if (scattered.empty()) return found;
  const SampleMoments moments = available_case_moments(values(Eigen::all, scattered));
  found.mean(scattered) = moments.mean;
  found.covariance(scattered, scattered) = moments.covariance;
  return found;
}

void require_repeated_outputs(const TestData& tests, const std::vector<Quantity>& outputs) {
  if (tests.values.rows() == 1) return;
  const Eigen::VectorXi count = measured_counts(tests.values);
  for (Eigen::Index k = 0; k < count.size(); ++k) {
    require_of(count(k) > 1, {Subject::Kind::tests},
               "output '{}' is measured once in {} specimens, which gives no scatter; leave it out of [outputs] "
               "(methods \"bayes\" and \"hierarchical\" need none)",
               outputs[static_cast<std::size_t>(k)].name(), tests.values.rows());
  }
}

namespace {

IterationRecord record_drawn(const UpdatingProblem& problem, const TestMoments& tests,
                             const SampleTransform& from_uniform, const RunContext& context) {
  // The same streams at every iteration (common random numbers): the update is then a smooth fixed-point map, and
  // its convergence is not hidden by the Monte-Carlo error of one cloud against the next.
  const StreamKey key{.seed = context.seed, .purpose = StreamPurpose::parameter_cloud, .iteration = 0};
  IterationRecord record;
  record.cloud = evaluate_cloud(problem.model, problem.space, from_uniform, problem.cloud, key, context);
  const Cloud::Valid valid = record.cloud.valid();
  record.output_mean = sample_mean(valid.outputs);
  record.output_covariance = sample_covariance(valid.outputs);
  record.failures = record.cloud.failures;
  record.notes = record.cloud.notes;
  record.rejected_draws = record.cloud.rejected;
  set_distances(record, tests);
  return record;
}

/// Of a distribution or an estimate.
template <typename Drawable>
IterationRecord state_of(const UpdatingProblem& problem, const TestMoments& tests, const Drawable& drawable,
                         const RunContext& context) {
  const auto from_uniform = [&](const Eigen::Ref<const Eigen::MatrixXd>& uniforms) {
    return drawable.from_uniform(uniforms);
  };
  IterationRecord record = record_drawn(problem, tests, from_uniform, context);
  record.parameter_mean = drawable.mean();
  record.parameter_covariance = drawable.covariance();
  return record;
}

}  // namespace

IterationRecord record_state(const UpdatingProblem& problem, const TestMoments& tests,
                             const JointDistribution& distribution, int index, const RunContext& context) {
  if (index == 0) {
    context.phase({.name = "cloud before the update"});
  } else {
    begin_iteration(problem, index, context);
  }
  return state_of(problem, tests, distribution, context);
}

IterationRecord record_state(const UpdatingProblem& problem, const TestMoments& tests, const Estimate& estimate,
                             const RunContext& context) {
  context.phase({.name = "cloud after the update"});
  return state_of(problem, tests, estimate, context);
}

void begin_iteration(const UpdatingProblem& problem, std::int64_t index, const RunContext& context) {
  context.phase({.name = "iteration", .step = index, .steps = problem.iterations, .may_end_early = true});
}

void set_distances(IterationRecord& record, const TestMoments& tests) {
  record.distance_euclidean = euclidean_distance(record.output_mean, tests.mean);
  record.distance_mahalanobis = tests.covariance.isZero(0.0)
                                    ? std::numeric_limits<double>::quiet_NaN()
                                    : mahalanobis_distance(record.output_mean, tests.mean, tests.covariance);
}

void append_state(UpdatingResult& result, IterationRecord state) {
  constexpr Eigen::Index k_shown = 500;
  result.model_evaluations += state.cloud.samples.rows();
  if (result.history.size() > 1) {
    Cloud& cloud = result.history.back().cloud;
    const Cloud::Valid valid = cloud.valid();
    const Eigen::Index shown = std::min(k_shown, valid.samples.rows());
    cloud.samples = valid.samples.topRows(shown);
    cloud.outputs = valid.outputs.topRows(shown);
    cloud.failures.clear();
  }
  result.history.push_back(std::move(state));
}

double largest_movement(const Eigen::Ref<const Eigen::VectorXd>& prior_std, const Eigen::VectorXd& mean_before,
                        const Eigen::MatrixXd& covariance_before, const Eigen::VectorXd& mean_after,
                        const Eigen::MatrixXd& covariance_after) {
  const Eigen::ArrayXd mean_change = (mean_after - mean_before).array().abs() / prior_std.array();
  const Eigen::ArrayXd std_change =
      (covariance_after.diagonal().array().sqrt() - covariance_before.diagonal().array().sqrt()).abs() /
      prior_std.array();
  return std::max(mean_change.maxCoeff(), std_change.maxCoeff());
}

std::string ending_message(UpdatingStatus status, std::size_t updates, double tolerance, const EndingWords& words) {
  switch (status) {
    case UpdatingStatus::converged:
      return fmt::format("after {} iterations {} by more than {} of its prior standard deviation", updates,
                         words.at_rest, tolerance);
    case UpdatingStatus::stalled:
      return words.stalled;
    case UpdatingStatus::stopped:
      return fmt::format("stopped on request after {} iterations", updates);
    default:
      return fmt::format("{} did not converge in {} iterations", words.moving, updates);
  }
}

bool is_stalled(const std::vector<double>& movements, std::size_t window) {
  if (movements.size() <= window) return false;
  const auto best = std::min_element(movements.begin(), movements.end());
  return static_cast<std::size_t>(std::distance(best, movements.end())) > window;
}

}  // namespace mottle::updating
