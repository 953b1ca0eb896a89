// How far a model's cloud is from tests, and where to it should move: by distances between samples alone.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// Which distance.
enum class SampleDistance { energy, sliced_wasserstein };

/// Covariance by which outputs are made comparable before distances are taken:
///
///   C = S [ n R_tests + (p + 1) R_cloud ] S / (n + p + 1)
///
/// S: robust standard deviations of the tests (1.4826 times the median of |z - median|; up to five values, and where
/// that is 0, the plain one), R_tests: correlations from ranks, 2 sin(pi r / 6), 0 where fewer than four specimens have
/// all outputs, R_cloud: correlations of the model's cloud with noise.
///
/// @param cloud_covariance  with noise [output x output]
/// @param noise_std         lower limit of S [output]
Eigen::MatrixXd comparison_covariance(const TestData& tests, const Eigen::Ref<const Eigen::MatrixXd>& cloud_covariance,
                                      const Eigen::Ref<const Eigen::VectorXd>& noise_std);

/// Distances between a cloud and tests with missing entries.
///
/// Energy: mean over the specimens' patterns of measured outputs, by their numbers of specimens, of the energy distance
/// in the outputs that they have, whitened by C there. Sliced Wasserstein: mean square over directions of the distance
/// of order 2: each output alone, with all specimens that have it, and random directions of whitened outputs, with
/// those specimens that have all (none where these are fewer than two).
class SampleComparison {
 public:
  /// @param covariance  C, positive definite [output x output]
  SampleComparison(SampleDistance kind, const Eigen::Ref<const Eigen::MatrixXd>& tests,
                   const Eigen::Ref<const Eigen::MatrixXd>& covariance, std::uint64_t seed);

  /// Dimensionless; of Wasserstein's distance the square.
  ///
  /// @param cloud  [sample x output]
  /// @param tests  with the same missing entries as those given above [specimen x output]
  double distance(const Eigen::Ref<const Eigen::MatrixXd>& cloud, const Eigen::Ref<const Eigen::MatrixXd>& tests) const;

 private:
  friend class DistanceGradient;
  struct Part {
    Eigen::MatrixXd map;  ///< whitened or projected outputs are map' of the outputs [output x coordinate]
    std::vector<Eigen::Index> specimens;
    double weight = 1.0;
  };

  SampleDistance kind_;
  std::vector<Part> parts_;
};

/// Gradient of a distance between one cloud and any tests with respect to what moves the cloud.
class DistanceGradient {
 public:
  /// @param cloud   [sample x output]
  /// @param slopes  dcloud / dcoordinate, one [sample x output] a coordinate
  DistanceGradient(const SampleComparison& comparison, const Eigen::Ref<const Eigen::MatrixXd>& cloud,
                   const std::vector<Eigen::MatrixXd>& slopes);

  /// The part that the tests have in it [coordinate].
  Eigen::VectorXd of_tests(const Eigen::Ref<const Eigen::MatrixXd>& tests) const;
  /// The part that is the same for all tests [coordinate].
  const Eigen::VectorXd& of_cloud() const { return of_cloud_; }

 private:
  struct Part {
    Eigen::MatrixXd cloud;   ///< whitened; or projected, in ascending order [sample x coordinate of the part]
    Eigen::MatrixXd slopes;  ///< of it, column by column [sample and coordinate of the part, coordinate]
  };

  const SampleComparison& comparison_;
  std::vector<Part> parts_;
  Eigen::VectorXd of_cloud_;
};

}  // namespace mottle::updating
