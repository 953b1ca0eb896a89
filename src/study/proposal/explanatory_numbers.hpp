// Which numbers of a model explain the tests: by likelihood, forward, with exchanges, and backward.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "study/proposal/linear_explanation.hpp"

namespace mottle::study {

struct ExplanatoryNumbers {
  std::vector<Eigen::Index> chosen = {};  ///< by what each explains, descending
  std::vector<double> losses = {};        ///< of ln likelihood without each of them
  Eigen::VectorXd gains = {};             ///< of ln likelihood with one more; 0 of the chosen [number]
  Eigen::VectorXd mean = {};              ///< expected mean, in prior standard deviations, 0 of the others [number]
  Eigen::VectorXd noise = {};             ///< standard deviation [output]
};

/// ln likelihood that a number must add: one of `candidates` numbers is chosen, so chance alone adds more of it the
/// more there are. 1 + ln(candidates), of at least three.
double least_gain(Eigen::Index candidates);

/// Starts from `chosen`. Adds the number of the largest gain among those that exceed least_gain(), until there is none,
/// exchanges each for another where this raises the likelihood, then removes those that are missed by less.
/// Preferences count as ln likelihood where numbers are compared, and never make up for a small gain.
///
/// @param most      numbers at most, >= 1
/// @param is_fixed  the numbers in `chosen` stay, and no other is chosen
ExplanatoryNumbers select_explanatory(const LinearisedTests& problem, std::size_t most,
                                      const std::vector<Eigen::Index>& chosen = {}, bool is_fixed = false);

}  // namespace mottle::study
