// A problem whose model is adapted to the region of an iterate.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "mottle/layers.hpp"
#include "mottle/model/region_model.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// The region of a normal distribution on the parameters' scales, for a model that adapts to regions; null where it
/// does not, or where the distribution is almost wholly impossible.
std::shared_ptr<const SampleRegion> region_around(const UpdatingProblem& problem, const Eigen::VectorXd& mean,
                                                  const Eigen::MatrixXd& covariance);

/// A problem with the same model in a region, which may be null: anywhere. What the problem refers to, and the model
/// of the problem, must outlive it.
class RegionalProblem {
 public:
  RegionalProblem(const UpdatingProblem& problem, std::shared_ptr<const SampleRegion> region);
  RegionalProblem(const RegionalProblem&) = delete;
  RegionalProblem& operator=(const RegionalProblem&) = delete;

  const UpdatingProblem& problem() const { return problem_; }

 private:
  std::unique_ptr<const RegionModel> model_;
  UpdatingProblem problem_;
};

}  // namespace mottle::updating
