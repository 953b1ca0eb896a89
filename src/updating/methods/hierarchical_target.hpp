// The posterior of a population as the sampler takes it: linear specimens first, corrected by the model.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/fits/regional_problem.hpp"
#include "updating/population/linear_specimens.hpp"
#include "updating/population/population_prior.hpp"
#include "updating/sampling/corrected_posterior.hpp"

namespace mottle::updating {

/// Every specimen of every point.
struct DrawnSpecimens {
  Eigen::MatrixXd points;     ///< parameters on the scales, specimens side by side [point x specimen * parameter]
  Eigen::MatrixXd log_ratio;  ///< as SpecimenDraw's [point x specimen]
};

/// The density of the tests and of their specimens' parameters t_s is that of linear specimens, whose parameters are
/// known in closed form given the population, times one ratio for each specimen:
///
///   p(z_s, t_s) = N_lin(z_s) N_lin(t_s | z_s) N(z_s; f(t_s) + d, R) / N(z_s; f_lin(t_s) + d, R)
///
/// Scores u stand for the population, v_s for t_s given population and linear test. What it is made of must outlive it,
/// and it must outlive what target() and correction() give.
class HierarchicalTarget {
 public:
  HierarchicalTarget(const UpdatingProblem& problem, const PopulationPrior& prior,
                     std::vector<LinearSpecimen> specimens, const RunContext& context)
      : problem_(problem), prior_(prior), specimens_(std::move(specimens)), context_(context) {}

  SamplingTarget target() const;
  Correction correction();
  DrawnSpecimens specimens(const std::vector<PopulationAt>& populations, const Eigen::MatrixXd& auxiliaries) const;
  /// ln of the density of all tests given their specimens' parameters [point].
  /// @param log_ratio  of the correction [point x specimen]
  Eigen::VectorXd log_likelihood(const std::vector<PopulationAt>& populations, const DrawnSpecimens& drawn,
                                 const Eigen::MatrixXd& log_ratio) const;
  std::int64_t evaluations() const { return evaluations_; }
  std::int64_t failed() const { return failed_; }
  /// The problem with a model that is adapted to where the specimens are.
  const UpdatingProblem& near() const { return near_ ? near_->problem() : problem_; }

 private:
  Eigen::VectorXd log_linear(const Eigen::MatrixXd& points) const;
  Eigen::MatrixXd log_ratio(const Eigen::MatrixXd& points, const Eigen::MatrixXd& auxiliaries);
  Correction::IsPossible are_specimens_possible(const Eigen::MatrixXd& points,
                                                const Eigen::MatrixXd& auxiliaries) const;

  const UpdatingProblem& problem_;
  const PopulationPrior& prior_;
  std::vector<LinearSpecimen> specimens_;
  const RunContext& context_;
  std::unique_ptr<const RegionalProblem> near_;
  std::int64_t evaluations_ = 0;
  std::int64_t failed_ = 0;
};

}  // namespace mottle::updating
