// Block Lanczos with full reorthogonalisation and thick restarts, for an operator that is symmetric in the M inner
// product. Knows neither factorisations nor shifts.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace mottle::linalg {

/// The largest eigenvalues theta of OP q = theta q, OP = (K - s M)^-1 M.
struct LanczosProblem {
  Eigen::Index size = 0;
  std::function<void(Eigen::Ref<Eigen::MatrixXd>)> solve;                          ///< (K - s M)^-1, in place
  std::function<Eigen::MatrixXd(const Eigen::Ref<const Eigen::MatrixXd>&)> weigh;  ///< M x
  /// Sum of |x_i| |M_ij| |x_j|, what rounding of x' M x is a part of.
  std::function<double(const Eigen::VectorXd&)> sum_of_terms;
};

struct LanczosPairs {
  Eigen::VectorXd values;   ///< theta, descending
  Eigen::MatrixXd vectors;  ///< M-orthonormal [row x pair]
  int solved_vectors = 0;
  bool is_converged = false;  ///< false: the limit of iterations was reached
};

/// @param wanted     pairs; fewer come back where the operator has no more
/// @param tolerance  largest residual of a pair, relative to its theta
/// Source: [Grimes1994], restarts [Wu2000].
LanczosPairs largest_pairs(const LanczosProblem& problem, int wanted, double tolerance);

}  // namespace mottle::linalg
