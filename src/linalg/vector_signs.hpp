// The sign of a mode shape: one rule for all solvers.
#pragma once

#include <Eigen/Core>

namespace mottle::linalg {

/// Turns each column so that its component of largest magnitude (ties: the first) is positive.
inline void make_largest_component_positive(Eigen::MatrixXd& vectors) {
  for (Eigen::Index mode = 0; mode < vectors.cols(); ++mode) {
    Eigen::Index largest = 0;
    vectors.col(mode).cwiseAbs().maxCoeff(&largest);
    if (vectors(largest, mode) < 0.0) vectors.col(mode) *= -1.0;
  }
}

}  // namespace mottle::linalg
