// Weighted, regularised least squares of one test within bounds, and the steps that descend in it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// J(x) = (z - f(x))' W (z - f(x)) + (x - x0)' Q (x - x0) in fixed numbers.
struct LeastSquares {
  Eigen::VectorXd target;     ///< z [output]
  Eigen::VectorXd weight;     ///< diagonal of W [output]
  Eigen::VectorXd start;      ///< x0 [parameter]
  Eigen::VectorXd prior_std;  ///< s0 [parameter]
  Eigen::MatrixXd prior;      ///< Q [parameter x parameter]
};

/// Where a descent is.
struct LeastSquaresPoint {
  Eigen::VectorXd parameters;   ///< x
  Eigen::VectorXd outputs;      ///< f(x)
  Eigen::MatrixXd sensitivity;  ///< G = df/dx [output x parameter]
};

/// J(x).
double cost(const LeastSquares& setup, const Eigen::VectorXd& parameters, const Eigen::VectorXd& outputs);

/// Outputs at one point, or nothing where the model run failed.
std::optional<Eigen::VectorXd> evaluate_one(const UpdatingProblem& problem, const Eigen::VectorXd& parameters,
                                            const RunContext& context, std::int64_t& evaluations);

/// Number of combinations of the parameters that the outputs determine without a prior.
Eigen::Index determined_combinations(const LeastSquares& setup, const Eigen::MatrixXd& g);

/// Whether J has one minimum to first order.
bool has_full_rank(const LeastSquares& setup, const Eigen::MatrixXd& g);

/// Moves the point by a Gauss-Newton step over the parameters that no bound holds, halved until J does not rise (a
/// failed run counts as a rise); where no part of the step helps it stays.
///
/// @return  largest movement of a parameter, in its prior standard deviations
double step_down(const UpdatingProblem& problem, const LeastSquares& setup, LeastSquaresPoint& point,
                 const RunContext& context, std::int64_t& evaluations);

}  // namespace mottle::updating
