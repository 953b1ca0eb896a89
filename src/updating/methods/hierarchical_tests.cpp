#include "updating/methods/hierarchical_tests.hpp"

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/methods/linear_units.hpp"
#include "updating/methods/mean_limits.hpp"
#include "updating/population/model_error.hpp"
#include "updating/population/population_report.hpp"
#include "updating/verdict/cloud_agreement.hpp"
#include "updating/verdict/scatter_tests.hpp"

namespace mottle::updating {
namespace {

/// Where the tests and the prior put the mean if no bound holds it, in the typical population.
FreeMean free_mean(const UpdatingProblem& problem, const PopulationFit& fit) {
  const PriorOnScales prior = prior_on_scales(problem.space);
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(prior.mean.size(), prior.mean.size());
  Eigen::MatrixXd information = solve_semidefinite(prior.covariance, identity);
  Eigen::VectorXd weighted = information * prior.mean;
  for (const RandomEffectsUnit& unit : fit.units) {
    Eigen::MatrixXd total = unit.design * fit.covariance * unit.design.transpose();
    total.diagonal() += unit.noise;
    Eigen::VectorXd response = unit.response;
    if (fit.model_error) response -= unit.shared * fit.model_error->shift;
    const Eigen::MatrixXd gain = solve_semidefinite(total, unit.design).transpose();
    information += gain * unit.design;
    weighted += gain * response;
  }
  const Eigen::MatrixXd covariance = solve_semidefinite(information, identity);
  return {covariance * weighted, 0.5 * (covariance + covariance.transpose()),
          static_cast<double>(fit.units.size()) - 1.0};
}

}  // namespace

PopulationFit as_population_fit(const HierarchicalFindings& findings, const UpdatingResult& result) {
  const UpdatingProblem& problem = findings.problem;
  const PopulationOnScales& typical = *result.estimate->population();
  const Eigen::Index q = typical.mean.size();
  PopulationFit fit;
  fit.mean = typical.mean;
  fit.covariance = typical.covariance;
  fit.noise = result.noise_covariance.diagonal();
  fit.model_error = result.model_error;
  fit.map = Eigen::MatrixXd::Identity(q, q);
  fit.specimens = findings.fits;
  fit.sensitivity = mean_jacobian(findings.fits.jacobians);
  const ScaledParameters parameters(problem.space);
  const Eigen::VectorXd root = (fit.noise + problem.tests.model_error_variance()).cwiseSqrt().cwiseInverse();
  constexpr double k_unseen = 1e-6;
  const SingularValues seen(root.asDiagonal() * fit.sensitivity * parameters.standard_deviation().asDiagonal(),
                            Eigen::ComputeThinV);
  const Eigen::Index rank = (seen.values().array() > k_unseen * seen.values()(0)).count();
  fit.seen = seen.right().leftCols(rank);
  Eigen::VectorXd shift;
  Eigen::MatrixXd absorbed;
  if (fit.model_error) {
    shift = fit.model_error->shift;
    absorbed = absorbed_errors(fit.sensitivity, parameters.standard_deviation().asDiagonal() * fit.seen,
                               root.cwiseAbs2().cwiseInverse());
  }
  fit.units = linear_units(problem.tests.values, shift, fit.sensitivity, absorbed, fit.specimens,
                           known_noise(fit.noise), Eigen::VectorXd::Zero(q), fit.map);
  fit.effects.mean = fit.mean;
  fit.effects.covariance = fit.covariance;
  return fit;
}

void test_hierarchical(const HierarchicalFindings& findings, const PopulationFit& fit, const RunContext& context,
                       UpdatingResult& result) {
  const UpdatingProblem& problem = findings.problem;
  TestPlan plan;
  if (findings.noise.is_known()) {
    plan_residual_tests(problem, fit, context, plan, result.model_evaluations);
  } else {
    plan.leave_untested(Aspect::means,
                        "The means were not tested: the noise is estimated, and takes in what the model cannot "
                        "explain. Give [test] repeatability.");
    plan.leave_untested(Aspect::scatter,
                        "The scatter was not tested: noise and scatter of the parameters are both estimated. Give "
                        "[test] repeatability.");
  }
  const TestMoments tests = test_moments(problem.tests);
  const IterationRecord& last = result.history.back();
  plan.add(cloud_agreement_test({tests.covariance.diagonal(), last.output_covariance.diagonal() + fit.noise,
                                 last.cloud.valid().outputs, counts_with_scatter(tests),
                                 std::vector<bool>(problem.model.outputs().size(), true), output_names(problem)}));
  plan_bound_test(problem, free_mean(problem, fit), plan);
  plan_prior_shift(problem, fit.mean, sample_covariance(means_of(findings.draws)), plan);
  plan.make(problem.level, result);
}

}  // namespace mottle::updating
