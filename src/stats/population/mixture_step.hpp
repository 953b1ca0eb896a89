// One step of expectation and maximisation of a mixture.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/population/normal_mixture.hpp"

namespace mottle::stats {

/// A normal distribution of effects as the units of one design see it.
struct SeenNormal {
  Eigen::VectorXd centre;    ///< D mu [row]
  Eigen::MatrixXd root;      ///< L^-1, C = L L' [row x row]
  double log_peak = 0.0;     ///< of the density
  Eigen::MatrixXd weighted;  ///< D' C^-1 [effect x row]
  Eigen::MatrixXd seen;      ///< D' C^-1 D [effect x effect]

  double log_density(const Eigen::VectorXd& response) const {
    return log_peak - 0.5 * (root * (response - centre)).squaredNorm();
  }
};

/// @return  nothing where C is not positive definite
std::optional<SeenNormal> see_normal(const MixtureDesign& design, const Eigen::VectorXd& mean,
                                     const Eigen::MatrixXd& covariance);

/// Mixture at given components: probabilities and likelihood, and the components that they make.
class MixtureStep {
 public:
  MixtureStep(const MixtureData& data, const MixtureSettings& settings);

  /// Fills `probabilities` and `log_likelihood` of the fit; false where a covariance is singular.
  bool expect(MixtureFit& fit);
  /// Components of the fit's probabilities; `expect` must have been called with these. False: one has no units left.
  bool maximise(MixtureFit& fit) const;
  /// Components of given probabilities alone, each unit's rows taken as they are: where a fit starts.
  bool begin(const Eigen::MatrixXd& points, MixtureFit& fit) const;

 private:
  /// T_k and mean of a component, from its units' probabilities.
  struct Moments {
    Eigen::VectorXd mean;
    Eigen::MatrixXd scatter;
    Eigen::MatrixXd mean_covariance;
    double size = 0.0;
  };
  Moments moments_of(const MixtureFit& fit, Eigen::Index component) const;
  void take(const std::vector<Moments>& moments, MixtureFit& fit) const;

  const MixtureData& data_;
  const MixtureSettings& settings_;
  std::vector<std::vector<SeenNormal>> seen_;  // [component][design]
  Eigen::VectorXd outlier_density_;            // logarithm, with the fraction [unit]
};

}  // namespace mottle::stats
