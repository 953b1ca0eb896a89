// Tests whose law where the model is right is that of simulated studies instead of a closed form.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "mottle/layers.hpp"
#include "updating/verdict/test_plan.hpp"

namespace mottle::updating {

/// A statistic of the tests, and the same of studies simulated with the right model, each estimated anew.
struct StudiedStatistic {
  double observed = 0.0;
  Eigen::VectorXd simulated;  ///< [study]; empty: there is no such law
};

/// Gives a planned test the law of simulated studies. With T_b the statistics of B studies,
///
///   p = (1 + #{T_b >= T}) / (B + 1),   critical value at level a: order statistic ceil((1 - a) (B + 1)) of T_b,
///
/// infinite where that is beyond B. Where T and the T_b are exchangeable, T is larger than it with a probability of at
/// most a. The power that is stated is that of the closed form beyond the simulated critical value: studies that
/// scatter more than the closed form find smaller errors than it says.
///
/// @param tail  upper tail of the closed form at a value of the statistic
/// Source: [Davison1997], section 4.2.5.
void judge_by_studies(const StudiedStatistic& statistic, const std::function<double(double)>& tail, PlannedTest& test);

}  // namespace mottle::updating
