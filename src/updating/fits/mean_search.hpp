// The search behind find_mean_solutions(): its starts, and the minima that they have led to.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "updating/fits/exchanged_parameters.hpp"
#include "updating/fits/mean_solutions.hpp"
#include "updating/fits/regional_problem.hpp"
#include "updating/fits/specimen_fit.hpp"

namespace mottle::updating {

/// What it is given must outlive it.
class MeanSearch {
 public:
  MeanSearch(const UpdatingProblem& problem, const Eigen::RowVectorXd& target, const MeanSearchSettings& settings,
             const RunContext& context, std::int64_t& evaluations)
      : problem_(problem),
        target_(target),
        settings_(settings),
        context_(context),
        evaluations_(evaluations),
        prior_(prior_on_scales(problem.space)),
        std_(prior_.covariance.diagonal().cwiseSqrt()),
        doubt_(chi_squared_quantile(1.0 - problem.level, static_cast<double>(std_.size()))),
        region_(problem, region_around(problem, prior_.mean, prior_.covariance)),
        permutations_(exchanges(ScaledParameters(problem.space))) {}

  /// Descends from each of the points, whose outputs are known or evaluated [start x parameter], [start x output].
  void descend(const Eigen::MatrixXd& points, const Eigen::MatrixXd& outputs);
  void descend(const Eigen::MatrixXd& points);

  /// Descends from the prior's mean, and where some combination of the parameters does not move the outputs there, from
  /// half a prior deviation beside it.
  void descend_from_prior();

  /// Descends from every solution, once, with the values of like parameters exchanged: from the eight nearest to the
  /// mean test.
  void exchange();

  /// Rows of outputs that are there, nearest to the mean test first.
  std::vector<Eigen::Index> nearest_first(const Eigen::MatrixXd& outputs) const;

  const PriorOnScales& prior() const { return prior_; }
  double misfit(const Eigen::RowVectorXd& outputs) const {
    return (outputs - target_).cwiseAbs2().cwiseQuotient(settings_.variance.transpose()).sum();
  }
  int starts() const { return starts_; }

  /// Those that explain the mean about as well as the best, least residual first.
  /// @throws SystemFailure  there is none
  MeanSolutions result() const;

  /// Whether each of these was met twice.
  bool are_met_twice() const;

  /// The same, and one leaves no more than a right model does.
  bool is_settled() const;

 private:
  const UpdatingProblem& problem() const { return region_.problem(); }

  /// Those that get stuck go on with derivatives from there.
  SpecimenFits fit(const Eigen::MatrixXd& points, const Eigen::MatrixXd& outputs);

  /// Ends beyond the bounds count where these hold them.
  void add(SpecimenFits fits);

  bool is_close(const MeanSolution& one) const;

  double residual(const MeanSolution& end) const;

  void keep(MeanSolution end);

  bool is_one(const MeanSolution& a, const MeanSolution& b) const;

  const UpdatingProblem& problem_;
  const Eigen::RowVectorXd& target_;
  const MeanSearchSettings& settings_;
  const RunContext& context_;
  std::int64_t& evaluations_;
  PriorOnScales prior_;
  Eigen::VectorXd std_;
  double doubt_;
  RegionalProblem region_;
  std::vector<std::vector<Eigen::Index>> permutations_;
  std::vector<MeanSolution> found_;
  int starts_ = 0;
};

}  // namespace mottle::updating
