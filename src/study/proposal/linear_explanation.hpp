// How well some numbers of a model explain the means and the scatter of tests, in the linear model.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::study {

/// Tests against a linearised model: z_s - y = A theta_s + noise, theta_s ~ N(mu, diag gamma), mu ~ N(0, 1), in prior
/// standard deviations of the numbers.
struct LinearisedTests {
  Eigen::MatrixXd differences;    ///< of the tests from the model; nan: not measured [specimen x output]
  Eigen::MatrixXd changes;        ///< A: by one standard deviation of each number [output x number]
  Eigen::VectorXd preferences;    ///< ln prior odds that a number is a parameter [number]
  Eigen::VectorXd typical_noise;  ///< median of each output's noise level before the tests [output]
  Eigen::VectorXd curvature;      ///< standard deviation of what the linear model leaves out of the means [output]
};

/// Means of the values that there are, of each column [output].
Eigen::VectorXd known_means(const Eigen::MatrixXd& values);

/// Restricted ln likelihood of a set of numbers:
///
///   scatter: -(n - 1)/2 (ln |V| + tr V^-1 S),   V = A diag(gamma) A' + R
///   means:   -1/2 (ln |W| + e' W^-1 e),         W = A (1 + diag(gamma) / n) A' + R / n + D
///
/// with S and e the covariance and the mean of the differences, R the noise (one level for all outputs of one typical
/// noise, log-normal about it) and D the squares of `curvature`. gamma and R are those of the greatest likelihood.
/// A missing value is replaced by its conditional mean, with its variance in S.
class LinearExplanation {
 public:
  /// @param problem  must outlive it; at least one specimen, each output measured at least once
  explicit LinearExplanation(const LinearisedTests& problem);

  /// What one more number adds to the ln likelihood with its preference, and with which variance gamma.
  struct Gain {
    double value = 0.0;
    double variance = 0.0;
  };
  Gain gain(Eigen::Index number) const;
  void add(Eigen::Index number, double variance);
  void remove(Eigen::Index number);
  /// Improves gamma and R one after the other, `sweeps` times.
  void estimate(int sweeps);

  const std::vector<Eigen::Index>& chosen() const { return chosen_; }
  bool has(Eigen::Index number) const;
  /// ln likelihood and preferences of the chosen, without constants.
  double value() const;
  /// Expected mu of the chosen given the tests, 0 of the others [number].
  Eigen::VectorXd expected_mean() const;
  const Eigen::VectorXd& noise() const { return noise_; }  ///< standard deviation [output]

 private:
  void update_factors();
  void update_moments();
  double likelihood() const;
  void estimate_noise();

  const LinearisedTests* problem_;
  Eigen::MatrixXd values_;  // differences with what is missing filled in
  Eigen::VectorXd mean_;
  Eigen::MatrixXd scatter_;  // S
  double specimens_ = 0.0;
  std::vector<Eigen::Index> chosen_;
  std::vector<double> variances_;
  Eigen::VectorXd noise_;
  Eigen::MatrixXd v_inverse_, w_inverse_;
  double v_log_determinant_ = 0.0;
  double w_log_determinant_ = 0.0;
};

}  // namespace mottle::study
