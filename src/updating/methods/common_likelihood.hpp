// Likelihood of parameters that all specimens have in common, with levels of the noise where these are not known.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/bayes.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// Noise of the tests: known variances, or levels with a prior, one for each kind of the outputs without repeatability.
/// A level is the noise's standard deviation as a fraction of the root mean square of the tested values, of each output
/// where the kind's noise is relative, of all outputs of the kind else.
class NoiseLevels {
 public:
  /// @param method  whose option a message names
  /// Throws InvalidInput: noise is to be given but an output has no repeatability.
  NoiseLevels(const UpdatingProblem& problem, const BayesOptions& options, const std::string& method = "bayes");

  Eigen::Index count() const { return static_cast<Eigen::Index>(names_.size()); }
  /// "noise:f": the level of frequencies.
  const std::vector<std::string>& names() const { return names_; }
  /// Level at a standard normal score: the inverse of its prior's distribution.
  double level(double score) const;
  /// Variance of each output, given the levels [level] -> [output].
  Eigen::VectorXd variances(const Eigen::Ref<const Eigen::VectorXd>& levels) const;
  /// Turns derivatives by the variances [output] into such by the scores of the levels [level].
  Eigen::VectorXd by_scores(const Eigen::Ref<const Eigen::VectorXd>& by_variances,
                            const Eigen::Ref<const Eigen::VectorXd>& scores) const;
  bool is_known() const { return names_.empty(); }
  /// That the levels have not gone to zero, as they do where the tests are met, or repeat each other, exactly.
  /// @param scores  of the particles [particle x level]
  /// @throws InvalidInput  a level has no posterior
  void require_above_zero(const Eigen::Ref<const Eigen::MatrixXd>& scores) const;

 private:
  BayesOptions options_;
  std::string method_;
  NoiseModel model_;
  std::vector<std::string> names_;
};

/// ln of prod_s N(z_s; f + d, R) with d ~ N(0, D) integrated out; R and D diagonal. For each output with n measured
/// values of mean z and sum of squares S about it
///
///   -1/2 (n ln 2 pi + (n - 1) ln r + ln(r + n d) + S / r + n (z - f)^2 / (r + n d))
///
/// d the variance of the model's error.
class CommonLikelihood {
 public:
  /// Derivatives of the logarithm.
  struct Slopes {
    Eigen::VectorXd by_outputs;    ///< [output]
    Eigen::VectorXd by_variances;  ///< [output]
  };

  explicit CommonLikelihood(const TestData& tests);

  /// @param outputs    f [output]; nan: the model failed, and the likelihood is zero
  /// @param variances  r [output], > 0
  double log_value(const Eigen::Ref<const Eigen::VectorXd>& outputs,
                   const Eigen::Ref<const Eigen::VectorXd>& variances) const;
  Slopes slopes(const Eigen::Ref<const Eigen::VectorXd>& outputs,
                const Eigen::Ref<const Eigen::VectorXd>& variances) const;
  const Eigen::VectorXd& count() const { return count_; }
  const Eigen::VectorXd& mean() const { return mean_; }
  /// Sum of squares about the mean [output].
  const Eigen::VectorXd& scatter() const { return scatter_; }
  /// Of the mean of the tests about f [output].
  Eigen::VectorXd variance_of_mean(const Eigen::Ref<const Eigen::VectorXd>& variances) const;

 private:
  Eigen::VectorXd count_;
  Eigen::VectorXd mean_;
  Eigen::VectorXd scatter_;
  Eigen::VectorXd model_error_;  // variance
};

}  // namespace mottle::updating
