// Confidence intervals of a population whose members are known one by one.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// 95 % intervals of means, deviations and correlations of x, from the sample moments of t = g(x), t normal.
///
/// Identity: mean by Student's t, deviation by chi-squared. Other scales: quantiles of the mean and deviation of x over
/// the fiducial distribution of those of t, mu = m - z s sqrt(nu / chi2_nu) / sqrt n, sigma = s sqrt(nu / chi2_nu),
/// nu = n - 1. Correlation: the exact interval on the scales, its ends carried over to x at the estimated deviations;
/// 0 between parameters of different groups.
///
/// @param mean, covariance  of t, from a sample of `count` [parameter], [parameter x parameter]
/// @param count             >= 2
/// @param groups            as UpdatingProblem::covariance_groups
/// Source: [Krishnamoorthy2003] for the logarithm.
ParameterIntervals normal_theory_intervals(const std::vector<ParameterTransform>& scales,
                                           const Eigen::Ref<const Eigen::VectorXd>& mean,
                                           const Eigen::Ref<const Eigen::MatrixXd>& covariance, int count,
                                           const std::vector<int>& groups);

/// Evidence of a sample without noise: its covariance, with n - 1 degrees of freedom in each entry, and a mean whose
/// covariance is the n-th part of it.
///
/// @param mean, covariance  of t [parameter], [parameter x parameter]
/// @param count             n >= 1
PopulationEvidence sample_evidence(const Eigen::Ref<const Eigen::VectorXd>& mean,
                                   const Eigen::Ref<const Eigen::MatrixXd>& covariance, Eigen::Index count);

/// 95 % intervals of the means alone where an error that all members share is in them: by population_intervals.
///
/// @param shared  covariance of that part of t's mean [parameter x parameter]
Eigen::MatrixXd normal_theory_means(const std::vector<ParameterTransform>& scales,
                                    const Eigen::Ref<const Eigen::VectorXd>& mean,
                                    const Eigen::Ref<const Eigen::MatrixXd>& covariance, int count,
                                    const Eigen::Ref<const Eigen::MatrixXd>& shared);

}  // namespace mottle::updating
