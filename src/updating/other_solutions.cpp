#include "other_solutions.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/stats/standard_normal.hpp"
#include "mottle/updating/scaled_parameters.hpp"

namespace mottle {
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

}  // namespace

std::vector<Eigen::VectorXd> other_solutions(const UpdatingProblem& problem, const PopulationFit& fit, int starts,
                                             const RunContext& context, std::int64_t& evaluations) {
  constexpr double k_apart = 0.1;       // prior deviations
  constexpr double k_as_well = 2.0;     // times the estimate's own misfit
  constexpr double k_no_misfit = 1e-3;  // of what a prior deviation moves an output
  if (starts == 0) return {};
  const PriorOnScales prior = prior_on_scales(problem.space);
  const Eigen::VectorXd std = prior.covariance.diagonal().cwiseSqrt();
  const Eigen::RowVectorXd target = means_of_tests(problem.tests.values);
  const HoldingPopulation hold{prior.mean, prior.covariance, fit.noise};
  const Eigen::MatrixXd drawn = draw_starts(problem, prior, starts, context, evaluations);
  Eigen::MatrixXd from(drawn.rows() + 1, drawn.cols());
  from << fit.mean.transpose(), drawn;
  const SpecimenFits found =
      fit_specimens(problem, target.replicate(from.rows(), 1), hold, {from}, context, evaluations);
  const Eigen::VectorXd moved = (fit.sensitivity * std.asDiagonal()).rowwise().norm().cwiseMax(1e-300);
  const auto misfit = [&](Eigen::Index s) {
    return ((found.outputs.row(s) - target).transpose().cwiseQuotient(moved)).norm();
  };
  const auto seen = [&](const Eigen::VectorXd& t) -> Eigen::VectorXd {
    return fit.seen.transpose() * (t - prior.mean).cwiseQuotient(std);
  };
  std::vector<Eigen::VectorXd> kept{found.points.row(0)};
  for (Eigen::Index s = 1; s < found.points.rows(); ++s) {
    const Eigen::VectorXd t = found.points.row(s);
    const bool fits = found.converged[static_cast<std::size_t>(s)] && misfit(s) <= k_as_well * misfit(0) + k_no_misfit;
    const bool is_new = std::none_of(kept.begin(), kept.end(), [&](const Eigen::VectorXd& other) {
      return (seen(t) - seen(other)).cwiseAbs().maxCoeff() < k_apart;
    });
    if (fits && is_new && clamp_on_scales(problem.space, t) == t) kept.push_back(t);
  }
  std::sort(kept.begin() + 1, kept.end(),
            [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return seen(a).norm() < seen(b).norm(); });
  const std::vector<NormalScale> scales = problem.space.scales();
  std::vector<Eigen::VectorXd> solutions;
  for (std::size_t k = 1; k < kept.size(); ++k) {
    solutions.emplace_back(to_variables(scales, kept[k].transpose()).row(0));
  }
  return solutions;
}

}  // namespace mottle
