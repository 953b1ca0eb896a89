// Which outputs a specimen's test has, and what of them counts as rounding.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::updating {

/// Standard deviation, as a part of its mean, below which an output counts as the same in all specimens.
inline constexpr double k_last_digits = 1e-9;

/// Outputs that a specimen has.
///
/// @param values  tests [specimen x output], nan: missing
inline std::vector<Eigen::Index> measured_outputs(const Eigen::Ref<const Eigen::MatrixXd>& values,
                                                  Eigen::Index specimen) {
  std::vector<Eigen::Index> outputs;
  for (Eigen::Index k = 0; k < values.cols(); ++k) {
    if (!std::isnan(values(specimen, k))) outputs.push_back(k);
  }
  return outputs;
}

/// The deviation to weigh an output by: that given, a thousandth of the output's mean where specimens do not differ
/// beyond its last digits, 1 where the mean is 0 too.
inline double weighing_deviation(double standard_deviation, double mean) {
  constexpr double k_no_scatter = 1e-3;
  const double size = std::abs(mean);
  if (standard_deviation > k_last_digits * size) return standard_deviation;
  return size > 0.0 ? k_no_scatter * size : 1.0;
}

}  // namespace mottle::updating
