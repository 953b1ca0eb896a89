#include "updating/population/linear_record.hpp"

namespace mottle::updating {

IterationRecord linear_record(const UpdatingProblem& problem, const PopulationFit& fit, const TestMoments& tests) {
  IterationRecord record;
  const auto population = JointDistribution::transformed_normal(problem.space.transforms(), fit.mean, fit.covariance);
  record.parameter_mean = population.mean();
  record.parameter_covariance = population.covariance();
  const Eigen::VectorXd point = fit.specimens.points.colwise().mean();
  const Eigen::VectorXd outputs = fit.specimens.outputs.colwise().mean();
  record.output_mean = outputs + fit.sensitivity * (fit.mean - point);
  record.output_covariance = fit.sensitivity * fit.covariance * fit.sensitivity.transpose();
  set_distances(record, tests);
  return record;
}

std::function<bool(const PopulationFit&)> record_iterations(const UpdatingProblem& problem, const TestMoments& tests,
                                                            const RunContext& context, UpdatingResult& result) {
  return [&](const PopulationFit& now) {
    append_state(result, linear_record(problem, now, tests));
    const bool goes_on = !context.stop_requested() && !now.converged && now.iterations < problem.iterations;
    if (goes_on) begin_iteration(problem, now.iterations + 1, context);
    return !context.stop_requested();
  };
}

}  // namespace mottle::updating
