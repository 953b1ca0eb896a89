#include "updating/verdict/other_solutions.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "updating/methods/matched_moments.hpp"
#include "updating/methods/scaled_parameters.hpp"

namespace mottle::updating {
namespace {

/// Starts spread over twice the prior's deviations, on the scales; those where the model fails are left out.
Eigen::MatrixXd draw_starts(const UpdatingProblem& problem, const PriorOnScales& prior, int starts,
                            const RunContext& context, std::int64_t& evaluations) {
  constexpr double k_spread = 2.0;
  const StreamKey key{.seed = context.seed, .purpose = StreamPurpose::design_permutation, .iteration = 1};
  const Eigen::VectorXd std = prior.covariance.diagonal().cwiseSqrt();
  Eigen::MatrixXd points = uniform_design(SamplingDesign::latin_hypercube, starts, prior.mean.size(), key);
  points = points.unaryExpr([](double u) { return standard_normal_quantile(u); });
  points = ((k_spread * points) * std.asDiagonal()).rowwise() + prior.mean.transpose();
  const Eigen::MatrixXd outputs = outputs_on_scales(problem, points, context, evaluations);
  std::vector<Eigen::Index> usable;
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    if (outputs.row(s).allFinite()) usable.push_back(s);
  }
  return points(usable, Eigen::all);
}

/// The metric in which two means count as the same: the sampling covariance of the mean test, and what it leaves of the
/// parameters in the directions that the outputs see.
struct MeanMetric {
  Eigen::MatrixXd precision;   // of the mean test [output x output]
  Eigen::MatrixXd covariance;  // of the estimate along the seen directions, in prior deviations [direction x direction]

  double misfit(const Eigen::VectorXd& residual) const { return residual.dot(precision * residual); }
};

/// M = (G Sigma G' + R) / n + D. A part in a million of what the prior moves an output keeps it regular.
MeanMetric metric_of(const PopulationFit& fit, const TestData& tests, const Eigen::VectorXd& prior_std) {
  constexpr double k_smallest = 1e-6;
  const Eigen::MatrixXd moved = fit.sensitivity * prior_std.asDiagonal();
  Eigen::MatrixXd covariance = fit.sensitivity * fit.covariance * fit.sensitivity.transpose();
  covariance.diagonal() += fit.noise;
  covariance = covariance_of_tests_mean(tests, covariance);
  if (tests.is_model_error_estimated) covariance.diagonal() += fit.model_error->std.cwiseAbs2();
  covariance.diagonal() += k_smallest * k_smallest * moved.rowwise().squaredNorm();
  MeanMetric metric;
  metric.precision = inverse_by_lu(covariance);
  const Eigen::MatrixXd seen = moved * fit.seen;
  metric.covariance = inverse_by_lu(seen.transpose() * metric.precision * seen);
  return metric;
}

}  // namespace

std::vector<Eigen::VectorXd> other_solutions(const UpdatingProblem& problem, const PopulationFit& fit, int starts,
                                             const RunContext& context, std::int64_t& evaluations) {
  constexpr double k_apart = 0.1;  // prior deviations: nearer solutions are one for every purpose
  constexpr double k_flat = 1e4;   // times the prior's deviations: it then holds nothing that the outputs see
  if (starts == 0) return {};
  const PriorOnScales prior = prior_on_scales(problem.space);
  const Eigen::VectorXd std = prior.covariance.diagonal().cwiseSqrt();
  const Eigen::RowVectorXd target = means_of_tests(problem.tests.values);
  const MeanMetric metric = metric_of(fit, problem.tests, std);
  const double same = chi_squared_quantile(1.0 - problem.level, static_cast<double>(fit.seen.cols()));
  HoldingPopulation hold{prior.mean, k_flat * k_flat * prior.covariance,
                         fit.noise / static_cast<double>(problem.tests.values.rows())};
  if (fit.model_error) hold.noise += fit.model_error->std.cwiseAbs2();
  const Eigen::MatrixXd drawn = draw_starts(problem, prior, starts, context, evaluations);
  Eigen::MatrixXd from(drawn.rows() + 1, drawn.cols());
  from << fit.mean.transpose(), drawn;
  const SpecimenFits found =
      fit_specimens(problem, target.replicate(from.rows(), 1), hold, {from}, context, evaluations);
  const auto misfit = [&](Eigen::Index s) { return metric.misfit((found.outputs.row(s) - target).transpose()); };
  const auto seen = [&](const Eigen::VectorXd& t) -> Eigen::VectorXd {
    return fit.seen.transpose() * (t - prior.mean).cwiseQuotient(std);
  };
  const ScaledParameters parameters(problem.space);
  std::vector<Eigen::VectorXd> kept{found.points.row(0)};
  for (Eigen::Index s = 1; s < found.points.rows(); ++s) {
    const Eigen::VectorXd t = found.points.row(s);
    const bool fits = found.converged[static_cast<std::size_t>(s)] && misfit(s) - misfit(0) <= same;
    const bool is_new = std::none_of(kept.begin(), kept.end(), [&](const Eigen::VectorXd& other) {
      const Eigen::VectorXd between = seen(t) - seen(other);
      return between.cwiseAbs().maxCoeff() < k_apart ||
             between.dot(solve_semidefinite(metric.covariance, between)) <= same;
    });
    if (fits && is_new && parameters.clamp(t) == t) kept.push_back(t);
  }
  std::sort(kept.begin() + 1, kept.end(),
            [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return seen(a).norm() < seen(b).norm(); });
  const std::vector<ParameterTransform> scales = problem.space.transforms();
  std::vector<Eigen::VectorXd> solutions;
  for (std::size_t k = 1; k < kept.size(); ++k) {
    solutions.emplace_back(to_variables(scales, kept[k].transpose()).row(0));
  }
  return solutions;
}

}  // namespace mottle::updating
