#include "updating/fits/regional_problem.hpp"

#include "mottle/core/error.hpp"

namespace mottle::updating {

std::shared_ptr<const SampleRegion> region_around(const UpdatingProblem& problem, const Eigen::VectorXd& mean,
                                                  const Eigen::MatrixXd& covariance) {
  if (!problem.model.adapts_to_regions()) return nullptr;
  const std::vector<ParameterTransform> scales = problem.space.transforms();
  const Eigen::VectorXd centre = to_variables(scales, mean.transpose()).row(0);
  try {
    return std::make_shared<const SampleRegion>(
        region_of(problem.space, centre, JointDistribution::transformed_normal(scales, mean, covariance)));
  } catch (const InvalidInput&) {
    return nullptr;
  }
}

RegionalProblem::RegionalProblem(const UpdatingProblem& problem, std::shared_ptr<const SampleRegion> region)
    : model_(region == nullptr ? nullptr : std::make_unique<const RegionModel>(problem.model, std::move(region))),
      problem_(model_ == nullptr ? problem : problem.with_model(*model_, problem.derivatives)) {}

}  // namespace mottle::updating
