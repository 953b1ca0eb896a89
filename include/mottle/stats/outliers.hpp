// Samples that do not belong to the others.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mottle {

/// One sample far from the rest.
struct Outlier {
  Eigen::Index sample = 0;
  double distance = 0.0;  ///< Mahalanobis distance from the samples that are left
  double p_value = 1.0;   ///< of the largest distance among all, corrected for their number
};

/// Outliers of a normal sample by Wilks's test, one after the other: the farthest sample is taken out while
///
///   n / (n - 1)^2 D^2 ~ Beta(q / 2, (n - q - 1) / 2)
///
/// makes it less probable than level / n, up to a third of the samples; those found first may have hidden others.
///
/// @param samples  [sample x variable], no nan; fewer than q + 3 samples have no outliers
/// @param level    probability that a sample without outliers is said to have one
/// @return         in the order in which they were found
/// Source: [Wilks1963]; [Caroni1992].
std::vector<Outlier> find_outliers(const Eigen::Ref<const Eigen::MatrixXd>& samples, double level);

}  // namespace mottle
