// The parameters that explain the mean of the tests: a search for all of them, from many starting points.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

struct MeanSearchSettings {
  int starts = k_usual_starts;  ///< most starting points; 0: the prior's mean alone
  Eigen::VectorXd noise;        ///< R: variance of the mean test by its measurement alone [output]
  Eigen::VectorXd variance;     ///< diagonal of M: the specimens' scatter included [output]
  /// What a right model leaves of MeanSolution::residual, generously: until a solution leaves less, no start is spared.
  double expected_residual = std::numeric_limits<double>::infinity();
};

/// A local minimum of the distance between model and mean test.
struct MeanSolution {
  Eigen::VectorXd point;          ///< t, on the parameters' scales [parameter]
  Eigen::VectorXd outputs;        ///< f(t) [output]
  Eigen::MatrixXd jacobian = {};  ///< df/dt [output x parameter]
  double residual = 0.0;          ///< (z - f)' R^-1 (z - f), which was minimised; R floored as in fit_specimens()
  double misfit = 0.0;            ///< (z - f)' M^-1 (z - f)
  int met = 0;                    ///< number of starts that lead to it
  bool is_from_prior = false;     ///< the prior's mean is one of them
  bool is_exchanged = false;      ///< it was tried with its values exchanged
};

struct MeanSolutions {
  /// Those that explain the mean test about as well as the best, least residual first; at least one.
  std::vector<MeanSolution> solutions = {};
  int starts = 0;  ///< that were tried
};

/// Minimises the distance between the model and the mean test z, without a prior, from the prior's mean, the samples of
/// the prior's cloud that are nearest to z, and points of a Latin hypercube over 1.5 of the prior's deviations, in
/// rounds, until each solution has been met twice and one leaves no more than a right model does, or the starts are
/// used up. Also tried: a point beside the prior's mean, where some combination of the parameters does not move the
/// outputs to first order there (a symmetric structure with equal means), and each solution with the values of
/// parameters exchanged that have equal priors.
///
/// Two ends count as one solution where they lie within a tenth of a prior deviation of each other, or within what the
/// mean test determines: (t' - t)' G' M^-1 G (t' - t) <= c, c the 1 - level quantile of chi-squared with as many
/// degrees of freedom as parameters. A solution explains the mean about as well as the best where its misfit exceeds
/// the least by no more than 4 c: M is not yet known well.
///
/// That all solutions were found is not proven: a basin that takes a fraction w of the starts is missed by all of N of
/// them with probability (1 - w)^N.
///
/// @param target  z [output]
/// @param prior_cloud  drawn from the prior, with the model's outputs
/// @throws SystemFailure  the model fails at the prior's mean, and from every other start
MeanSolutions find_mean_solutions(const UpdatingProblem& problem, const Eigen::RowVectorXd& target,
                                  const MeanSearchSettings& settings, const Cloud& prior_cloud,
                                  const RunContext& context, std::int64_t& evaluations);

/// 10 (p - q) for p outputs and q parameters, at least 10: what a right model leaves of the residual is chi-squared
/// with p - q degrees of freedom, and what the outputs' curvature adds.
double generous_residual(const UpdatingProblem& problem);

/// R and M from the tests: repeatability, scatter, and the model's error where it is given; a measurement of unknown
/// noise counts with the scatter, a single one with a hundredth of its value.
MeanSearchSettings mean_search_settings(const UpdatingProblem& problem);

/// The search of a method that has no likelihood to tell solutions apart: the mean test of all specimens, settings as
/// above.
MeanSolutions find_mean_solutions(const UpdatingProblem& problem, const Cloud& prior_cloud, const RunContext& context,
                                  std::int64_t& evaluations);

}  // namespace mottle::updating
