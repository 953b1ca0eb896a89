// Mean, covariance and correlation of samples, complete or with missing entries.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Mean of every column.
///
/// @param samples  [sample x variable], at least 1 row, no nan
Eigen::VectorXd sample_mean(const Eigen::Ref<const Eigen::MatrixXd>& samples);

/// Unbiased sample covariance: centred' centred / (n - 1).
///
/// @param samples  [sample x variable], at least 2 rows, no nan
/// @return         [variable x variable], exactly symmetric
/// @throws InvalidInput  fewer than 2 rows, or an entry that is not finite
Eigen::MatrixXd sample_covariance(const Eigen::Ref<const Eigen::MatrixXd>& samples);

/// Square roots of the unbiased sample variances; arguments and errors as sample_covariance.
Eigen::VectorXd sample_standard_deviation(const Eigen::Ref<const Eigen::MatrixXd>& samples);

/// Correlation matrix of a covariance: S_ij / sqrt(S_ii S_jj), clamped to [-1, 1].
///
/// @param covariance  [variable x variable]
/// @return            diagonal exactly 1; a variable without variance has correlation 0 with every other
/// @throws InvalidInput  not square, or a negative variance
Eigen::MatrixXd correlation_from_covariance(const Eigen::Ref<const Eigen::MatrixXd>& covariance);

/// Makes an estimate of a covariance positive semi-definite, which rounding or pairwise formation may have spoiled:
/// negative eigenvalues of its correlation become zero, and the correlation's diagonal is scaled back to 1, which keeps
/// the variances. A variable whose variance is not positive has none. What is positive semi-definite to rounding stays.
///
/// @param covariance  [variable x variable], symmetric, finite, of any units
/// @param min_eigenvalue  lower limit, instead of zero, of the correlation's eigenvalues, as a fraction of the largest
/// @return            whether an eigenvalue was below zero by more than rounding
/// Source: [Rousseeuw1993].
bool repair_covariance(Eigen::MatrixXd& covariance, double min_eigenvalue = 0.0);

/// Moments of samples in which entries may be missing.
struct SampleMoments {
  Eigen::VectorXi count;       ///< [variable], values present
  Eigen::VectorXd mean;        ///< [variable]
  Eigen::MatrixXd covariance;  ///< [variable x variable], positive semi-definite
  bool was_repaired = false;   ///< the pairwise covariances did not fit together and were changed
};

/// Moments from whatever is present: each mean and variance from all values of its column, each covariance from the
/// rows that hold both columns (centred at the means of those rows, divided by their number less one; 0 where fewer
/// than two rows hold both). Unbiased where entries are missing completely at random. Pairwise covariances need not
/// form a covariance matrix; where they do not, the negative eigenvalues of the correlation are set to zero and its
/// diagonal is scaled back to 1, which keeps the variances.
///
/// @param samples  [sample x variable], nan = missing
/// @throws InvalidInput  a column with fewer than 2 values (names its index, from 0), or an infinite entry
/// Source: [Little2019], section 3.4; [Rousseeuw1993] for the repair.
SampleMoments available_case_moments(const Eigen::Ref<const Eigen::MatrixXd>& samples);

}  // namespace mottle::stats
