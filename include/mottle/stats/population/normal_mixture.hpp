// A population of several batches: units (specimens) whose effects come from a mixture of normal populations, or are
// outliers, observed with noise of known variance. Estimates it; for the number of batches see mixture_choice.hpp.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "mottle/core/random.hpp"
#include "mottle/layers.hpp"
#include "mottle/stats/population/random_effects.hpp"

namespace mottle::stats {

/// How units see their effects x: y = D x + e, e ~ N(0, N).
struct MixtureDesign {
  Eigen::MatrixXd design;  ///< D [row x effect], no more rows than effects
  Eigen::MatrixXd noise;   ///< N [row x row]
};

/// Units whose rows have been reduced to those that depend on effects: where a unit determines its own effects, y is
/// its generalised least-squares estimate of them and D the identity.
struct MixtureData {
  std::vector<MixtureDesign> designs;
  std::vector<std::size_t> design_of;      ///< [unit]
  std::vector<Eigen::VectorXd> responses;  ///< y [unit]

  std::size_t size() const { return responses.size(); }
  Eigen::Index effects() const { return designs.front().design.cols(); }
  const MixtureDesign& design(std::size_t unit) const { return designs[design_of[unit]]; }
};

/// Reduces units. What it leaves out does not depend on the effects.
///
/// @param units  their noise is known: no factor is estimated, no error shared; effects of about unit size
/// @param alike  number of the units' kind; units of one kind that determine their effects are given the mean of
///               their noises, which makes work on them many times faster; empty: each keeps its own [unit]
MixtureData mixture_data(const std::vector<RandomEffectsUnit>& units, const std::vector<int>& alike = {});

/// One batch.
struct MixtureComponent {
  double weight = 0.0;         ///< of the units that are no outliers
  Eigen::VectorXd mean;        ///< [effect]
  Eigen::MatrixXd covariance;  ///< positive semi-definite [effect x effect]
};

/// Where outliers come from: a broad normal distribution that is not estimated with the batches.
struct OutlierPopulation {
  double fraction = 0.0;  ///< of all units, in [0, 1)
  Eigen::VectorXd mean = {};
  Eigen::MatrixXd covariance = {};
};

struct MixtureSettings {
  bool is_restricted = true;  ///< scatter about estimated means, not about known ones
  /// Weight, in units, of the belief that batches scatter alike, so that none collapses onto a few units. 0: none.
  double prior_weight = 2.0;
  bool has_common_covariance = false;
  std::vector<int> covariance_groups = {};  ///< as RandomEffectsSettings::covariance_groups
  OutlierPopulation outliers = {};
  /// Brings the mean of a component to where it may lie, given its information matrix; empty: anywhere. Called from
  /// several threads.
  std::function<Eigen::VectorXd(const Eigen::VectorXd& mean, const Eigen::MatrixXd& information)> confine = {};
  int iterations = 1000;
  double tolerance = 1e-9;  ///< of the log-likelihood's change in one step
};

/// Components in the order of their start; order() has that of reports.
struct MixtureFit {
  std::vector<MixtureComponent> components;
  std::vector<Eigen::MatrixXd> mean_covariances;  ///< A_k^-1 of every component's mean
  Eigen::MatrixXd probabilities;  ///< of each unit's component; the last column: that it is an outlier [unit x K + 1]
  double log_likelihood = 0.0;    ///< of the reduced data, with all constants, without the covariances' prior
  int iterations = 0;
  bool converged = false;

  /// Most probable component of a unit, also of an outlier.
  Eigen::Index component_of(Eigen::Index unit) const;
  /// Expected number of units of a component.
  double size_of(Eigen::Index component) const { return probabilities.col(component).sum(); }
  /// Mean and covariance of all batches together.
  Eigen::VectorXd mean() const;
  Eigen::MatrixXd covariance() const;
  /// Sum of the covariances, each by its weight: the scatter within batches.
  Eigen::MatrixXd within() const;
};

/// A batch is what has as many units as this; fewer are outliers.
inline constexpr int k_smallest_batch = 3;

/// (Restricted) maximum likelihood of
///
///   p(y_s) = (1 - e) sum_k w_k N(y_s; D_s mu_k, C_sk) + e N(y_s; D_s m_0, D_s S_0 D_s' + N_s),  C_sk = D_s Sigma_k
///   D_s'
///   + N_s
///
/// by expectation-maximisation, with r_sk the probability that unit s is of batch k, n_k its sum over s, nu the weight
/// of the prior:
///
///   mu_k = A_k^-1 sum_s r_sk D_s' C_sk^-1 y_s,   A_k = sum_s r_sk D_s' C_sk^-1 D_s
///   T_k = sum_s r_sk [b_sk b_sk' + Sigma_k - Sigma_k D_s' P_sk D_s Sigma_k],   b_sk = Sigma_k D_s' C_sk^-1 (y_s - D_s
///   mu_k)
///   Sigma_k <- (T_k + nu W) / (n_k + nu),   W = sum_k T_k / sum_k n_k
///   P_sk = C_sk^-1 - C_sk^-1 D_s A_k^-1 D_s' C_sk^-1 (restricted),  C_sk^-1 (plain)
///
/// Without noise the restricted estimate is Sigma_k = (scatter about mu_k + nu W) / (n_k - 1 + nu). Where batches
/// scatter alike the prior has no bias; a batch of variance v among such of mean variance V is estimated (nu / (n_k - 1
/// + nu)) (V - v) too high. With nu = 0, e = 0, the plain likelihood and no noise it is the textbook's mixture
/// [McLachlan2000].
///
/// @param start  probabilities of the units' components, rows may sum to less than 1 [unit x K]
/// @return       nothing where a component has lost its units, or its covariance is singular
/// Source: [McLachlan2000]; [Fraley2007] for priors against collapse; [Friedman1989] for the pooled scatter.
std::optional<MixtureFit> fit_mixture(const MixtureData& data, const Eigen::Ref<const Eigen::MatrixXd>& start,
                                      const MixtureSettings& settings);

/// The same from the components of an earlier fit.
std::optional<MixtureFit> fit_mixture(const MixtureData& data, const MixtureFit& start,
                                      const MixtureSettings& settings);

/// The outliers' population: mean of all units taken as one batch, and `width`^2 times its covariance.
OutlierPopulation outlier_population(const MixtureData& data, double fraction, double width,
                                     const MixtureSettings& settings);

/// Each unit's effects as one population of all units holds them: the points that starts are made of [unit x effect].
Eigen::MatrixXd held_points(const MixtureData& data, const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance);

/// Order of components in reports: the heavier first, of equal ones the one with the smaller mean.
std::vector<Eigen::Index> mixture_order(const MixtureFit& fit);

/// The same components in another order.
MixtureFit reordered(const MixtureFit& fit, const std::vector<Eigen::Index>& order);

}  // namespace mottle::stats
