// What a kind of surrogate fits: the part of Surrogate that knows nothing of units.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "mottle/stats/surrogates/surrogate.hpp"

namespace mottle::stats {

/// Outputs in scaled units at scaled inputs.
class Surrogate::Fit {
 public:
  virtual ~Fit() = default;
  /// @param x  [point x input]
  /// @return   [point x output]
  virtual Eigen::MatrixXd at(const Eigen::MatrixXd& x) const = 0;
};

}  // namespace mottle::stats
