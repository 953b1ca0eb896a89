#include "updating/fits/mean_solutions.hpp"

#include <algorithm>

#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/mean_search.hpp"

namespace mottle::updating {
namespace {

constexpr Eigen::Index k_round = 16;  // starts that are tried together

/// Points of a Latin hypercube over more than the prior: basins within its tails are reached from beyond them too.
Eigen::MatrixXd space_filling(const PriorOnScales& prior, int count, std::uint64_t seed, std::uint32_t round) {
  constexpr double k_spread = 1.5;
  const StreamKey key{.seed = seed, .purpose = StreamPurpose::design_permutation, .iteration = round};
  const Eigen::VectorXd std = prior.covariance.diagonal().cwiseSqrt();
  const Eigen::MatrixXd uniform = uniform_design(SamplingDesign::latin_hypercube, count, prior.mean.size(), key);
  const Eigen::MatrixXd normal = uniform.unaryExpr([](double u) { return standard_normal_quantile(u); });
  return (k_spread * normal * std.asDiagonal()).rowwise() + prior.mean.transpose();
}

/// Rows `from` to `from + count` of what there is.
Eigen::MatrixXd rows_of(const Eigen::MatrixXd& points, Eigen::Index from, Eigen::Index count) {
  const Eigen::Index first = std::min(from, points.rows());
  return points.middleRows(first, std::min(count, points.rows() - first));
}

}  // namespace

MeanSolutions find_mean_solutions(const UpdatingProblem& problem, const Eigen::RowVectorXd& target,
                                  const MeanSearchSettings& settings, const Cloud& prior_cloud,
                                  const RunContext& context, std::int64_t& evaluations) {
  if (settings.starts == 0) {
    return {.solutions = {
                MeanSolution{.point = prior_on_scales(problem.space).mean, .outputs = {}, .is_from_prior = true}}};
  }
  MeanSearch search(problem, target, settings, context, evaluations);
  search.descend_from_prior();
  const std::vector<Eigen::Index> nearest = search.nearest_first(prior_cloud.outputs);
  const Eigen::MatrixXd samples = from_variables(problem.space.transforms(), prior_cloud.samples(nearest, Eigen::all));
  const int most = k_more_starts * settings.starts;
  Eigen::MatrixXd filling(most, search.prior().mean.size());
  filling << space_filling(search.prior(), settings.starts, context.seed, 1),
      space_filling(search.prior(), most - settings.starts, context.seed, 2);
  Eigen::Index near_done = 0;
  Eigen::Index far_done = 0;
  const auto is_done = [&] {
    if (search.starts() < settings.starts) return near_done > 0 && search.is_settled();
    return search.starts() >= most || search.are_met_twice();
  };
  while (!is_done()) {
    context.throw_if_stopped();
    const int limit = search.starts() < settings.starts ? settings.starts : most;
    const Eigen::Index count = std::min<Eigen::Index>(k_round, limit - search.starts());
    const Eigen::MatrixXd far = rows_of(filling, far_done, count / 2);
    const Eigen::MatrixXd near = rows_of(samples, near_done, count - far.rows());
    if (near.rows() + far.rows() == 0) break;
    Eigen::MatrixXd round(near.rows() + far.rows(), filling.cols());
    round << near, far;
    search.descend(round);
    search.exchange();
    near_done += near.rows();
    far_done += far.rows();
  }
  return search.result();
}

double generous_residual(const UpdatingProblem& problem) {
  constexpr double k_generous = 10.0;
  const Eigen::Index left = problem.tests.values.cols() - problem.space.count();
  return k_generous * static_cast<double>(std::max<Eigen::Index>(left, 1));
}

MeanSearchSettings mean_search_settings(const UpdatingProblem& problem) {
  constexpr double k_hundredth = 0.01;
  const TestMoments tests = test_moments(problem.tests);
  const Eigen::VectorXd error = problem.tests.model_error_variance();
  const Eigen::VectorXd given = problem.tests.repeatability_std.cwiseAbs2();
  const bool is_known = given.minCoeff() > 0.0;
  MeanSearchSettings settings{.starts = problem.starts, .noise = given, .variance = tests.covariance.diagonal()};
  for (Eigen::Index k = 0; k < given.size(); ++k) {
    const double count = tests.count(k);
    const double unknown = k_hundredth * k_hundredth * tests.mean(k) * tests.mean(k);
    const double least = 1e-12 * tests.mean(k) * tests.mean(k) + 1e-300;
    if (!(settings.variance(k) > 0.0)) settings.variance(k) = given(k) > 0.0 ? given(k) : unknown;
    if (!(given(k) > 0.0)) settings.noise(k) = settings.variance(k);
    settings.variance(k) = std::max(settings.variance(k), given(k)) / count + error(k) + least;
    settings.noise(k) = settings.noise(k) / count + error(k);
  }
  if (is_known && !problem.tests.is_model_error_estimated) settings.expected_residual = generous_residual(problem);
  return settings;
}

MeanSolutions find_mean_solutions(const UpdatingProblem& problem, const Cloud& prior_cloud, const RunContext& context,
                                  std::int64_t& evaluations) {
  const Eigen::RowVectorXd target = test_moments(problem.tests).mean.transpose();
  return find_mean_solutions(problem, target, mean_search_settings(problem), prior_cloud, context, evaluations);
}

}  // namespace mottle::updating
