// What the updated parameters say of specimens and outputs that were not used, and whether held-out tests agree.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"
#include "mottle/model/parameters/parameter_space.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// The model's error in predicted outputs.
struct PredictedError {
  ModelError estimate;               ///< of the tested outputs
  std::vector<Eigen::Index> tested;  ///< of each predicted output the tested one whose very error it has, -1: none
  Eigen::VectorXd own_std;           ///< of an error that no test has, 0: none [predicted output]
};

struct PredictionSettings {
  Eigen::VectorXd noise_std;  ///< of the measurement of a new specimen's outputs [output]
  std::optional<PredictedError> model_error = std::nullopt;
  int draws = 4000;
  double level = 0.05;  ///< intervals and regions hold 1 - level of new specimens
};

/// Held-out tests against the prediction.
struct HeldOutCheck {
  /// How often the transforms fall into each of as many equal parts of (0, 1) as they can fill.
  struct Histogram {
    std::vector<int> counts;
    int fewest = 0;  ///< counts that a right prediction gives a part in 95 % of cases
    int most = 0;
  };

  Eigen::VectorXd coverage;     ///< part of the tests inside each output's interval; nan: never measured [output]
  double joint_coverage = 0.0;  ///< part of the complete tests inside the joint region; nan: none, or no region
  Eigen::VectorXd distances;    ///< squared, of every complete test from the predicted mean; nan: incomplete [specimen]
  Eigen::MatrixXd transforms;   ///< probability integral transforms [specimen x output], nan: missing
  Eigen::VectorXd uniformity;   ///< p-value of each output's transforms being uniform [output]
  double adjusted_p = 1.0;      ///< the smallest of them after Holm
  Eigen::MatrixXd scores = {};  ///< transforms as standard normal numbers [specimen x output], nan: missing
  std::vector<Histogram> histograms = {};  ///< [output]
  Eigen::VectorXi min_inside = {};         ///< fewer tests inside are seen in one of a hundred cases [output]
};

/// Predictive distribution of one new specimen's test.
struct Prediction {
  Eigen::VectorXd mean;         ///< of the population [output]
  Eigen::MatrixXd covariance;   ///< of a test: population and noise [output x output]
  Eigen::MatrixXd interval;     ///< of a new test, the estimate's uncertainty included [output x 2]
  double joint_critical = 0.0;  ///< squared Mahalanobis distance that bounds the joint region; nan: too few specimens
  Eigen::MatrixXd draws;        ///< of a new test, whose columns follow the outputs' own predictive distributions
  std::int64_t model_evaluations = 0;
  std::int64_t impossible = 0;  ///< draws that are physically impossible or failed, left out
};

/// Predicts by draws of the estimate through the model. Of a normal population with total T = Sigma + N, noise's share
/// N, covariance M of the mean and degrees of freedom nu_i of T_ii from the population's evidence, each output's
/// interval comes from
///
///   t* = mu + w (M^1/2 z1) + (w T w - N)^1/2 z2,   y* = f(t*) + e,   w = diag(sqrt(nu_i / chi2_nu_i))
///
/// with the chi2 of all parameters at one probability: for a linear model of complete tests without noise exactly
/// mu_y +- t_nu s sqrt(1 + 1/n), nu = n - 1. The joint region (y - m)' C^-1 (y - m) <= c has its c from draws in which
/// T is inverse Wishart with the mean of the nu_i: for such a model Hotelling's (1 + 1/n) p nu / (nu - p + 1) F. What
/// no output sees (nu_i = 0) is drawn as it stands.
///
/// With a model error d, d* ~ N(d^, cov d) is drawn with each: t* moves by gain (d* - d^), outputs that have that error
/// get d*, others an error of their own. `mean` holds d^ and `covariance` the errors of their own.
///
/// @param model  of the predicted outputs, over the parameters of `space`
/// @throws SystemFailure  more than half of the draws fail
/// Source: [Geisser1963]; [Anderson2003], section 5.3.
Prediction predict(const Model& model, const ParameterSpace& space, const Estimate& estimate,
                   const PredictionSettings& settings, const RunContext& context);

/// @param values  held-out tests [specimen x output], nan: missing
/// Uniformity is Kolmogorov's test with the effective number m n / (m + n): the tests share one estimate from n.
/// Source: [Dawid1984]; [Stephens1970] for small samples.
HeldOutCheck check_held_out(const Prediction& prediction, const Estimate& estimate,
                            const Eigen::Ref<const Eigen::MatrixXd>& values);

/// What a prediction and its check say, in words.
std::vector<std::string> prediction_sentences(const Prediction& prediction, const HeldOutCheck* check,
                                              const Estimate& estimate, const std::vector<Quantity>& outputs,
                                              double level);

}  // namespace mottle::updating
