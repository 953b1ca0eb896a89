// The problem of a population fit, whose model is adapted to where the iterate is.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>

#include "mottle/layers.hpp"
#include "updating/fits/regional_problem.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// The problem about the iterate. A model that adapts to regions does so at the mean of the tests, with the prior's
/// covariance, and again wherever the mean comes to lie a prior deviation beside the last region's.
class FollowingProblem {
 public:
  FollowingProblem(const UpdatingProblem& problem, const PriorOnScales& prior, PopulationFit& fit)
      : problem_(problem), prior_(prior), fit_(fit) {}

  /// @param given  where the specimens lie; null: it follows the iterate
  void begin(std::shared_ptr<const SampleRegion> given) {
    follows_ = given == nullptr;
    adapt(follows_ ? region_around(problem_, fit_.mean, prior_.covariance) : std::move(given));
  }
  void follow() {
    constexpr double k_beside = 1.0;
    if (fit_.region == nullptr || !follows_) return;
    const Eigen::VectorXd moved = (fit_.mean - centre_).cwiseQuotient(prior_.covariance.diagonal().cwiseSqrt());
    if (moved.cwiseAbs().maxCoeff() > k_beside) adapt(region_around(problem_, fit_.mean, prior_.covariance));
  }
  const UpdatingProblem& now() const { return current_->problem(); }

 private:
  void adapt(std::shared_ptr<const SampleRegion> region) {
    centre_ = fit_.mean;
    fit_.region = region;
    current_ = std::make_unique<RegionalProblem>(problem_, std::move(region));
  }

  const UpdatingProblem& problem_;
  const PriorOnScales& prior_;
  PopulationFit& fit_;
  bool follows_ = true;
  Eigen::VectorXd centre_;  // of the region, on the scales
  std::unique_ptr<RegionalProblem> current_;
};

}  // namespace mottle::updating
