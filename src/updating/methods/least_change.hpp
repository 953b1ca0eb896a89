// Steps of least squares that change no more than the residuals ask for: what outputs do not see stays with the prior.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/fits/scaled_parameters.hpp"

namespace mottle::updating {

/// T = argmin |W^1/2 (r - G d)| as a map from residuals to steps, d of least length in prior deviations.
///
///   A = W^1/2 G D,   T W^-1/2 = D A^+,   D = diag(prior deviations)
struct Gain {
  Eigen::MatrixXd matrix;  ///< from whitened residuals to steps [parameter x output]
  int rank = 0;            ///< combinations of parameters that the outputs see
};

/// @param whitened   W^1/2 G [output x parameter]
/// @param deviation  prior deviations [parameter]
/// @param damping    Levenberg's, as a part of the largest singular value of A; 0: none
/// Singular values below 1e-6 of the largest count as zero.
Gain least_change_gain(const Eigen::Ref<const Eigen::MatrixXd>& whitened,
                       const Eigen::Ref<const Eigen::VectorXd>& standard_deviation, double damping = 0.0);

/// Gauss-Newton step from `point` towards small residuals and, where they do not decide, back to the prior mean.
/// Parameters that a bound holds are left out of it.
///
/// @param whitened  W^1/2 G at the point [output x parameter]
/// @param residual  W^1/2 (z - f) [output]
Eigen::VectorXd least_change_step(const ScaledParameters& parameters, const Eigen::Ref<const Eigen::VectorXd>& point,
                                  const Eigen::Ref<const Eigen::MatrixXd>& whitened,
                                  const Eigen::Ref<const Eigen::VectorXd>& residual, double damping = 0.0);

/// The same with `damping` raised until no parameter moves by more than two prior deviations: further out the
/// linearisation says nothing.
Eigen::VectorXd trusted_step(const ScaledParameters& parameters, const Eigen::Ref<const Eigen::VectorXd>& point,
                             const Eigen::Ref<const Eigen::MatrixXd>& whitened,
                             const Eigen::Ref<const Eigen::VectorXd>& residual, double& damping);

/// The damping for the step after one that helped, or did not.
double next_damping(double damping, bool has_helped);

/// Change dS of the parameters' covariance that explains a change D of the outputs' covariance best,
///
///   min |W^1/2 (D - G dS G') W^1/2|_F,   of least size in prior deviations,
///
/// entries between parameters of different groups zero. With one group it is T D T'.
///
/// @param whitened  W^1/2 G [output x parameter]
/// @param change    W^1/2 D W^1/2 [output x output]
/// @param groups    of each parameter; empty: one group
/// @param damping   Levenberg's, as above
Eigen::MatrixXd least_change_covariance(const Eigen::Ref<const Eigen::MatrixXd>& whitened,
                                        const Eigen::Ref<const Eigen::VectorXd>& standard_deviation,
                                        const Eigen::Ref<const Eigen::MatrixXd>& change, const std::vector<int>& groups,
                                        double damping = 0.0);

/// Sets entries between parameters of different groups to zero; `groups` as above.
void keep_groups(Eigen::MatrixXd& covariance, const std::vector<int>& groups);

/// The nearest covariance in units of the prior deviations: negative eigenvalues become zero.
///
/// @return  whether anything was changed beyond rounding
bool project_to_covariance(Eigen::MatrixXd& covariance, const Eigen::Ref<const Eigen::VectorXd>& standard_deviation,
                           const std::vector<int>& groups);

}  // namespace mottle::updating
