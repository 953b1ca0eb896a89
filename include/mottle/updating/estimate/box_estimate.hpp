// An estimate that is a box: bounds of each parameter, and nothing on how the parameters lie between them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/eigenvalue_bounds.hpp"
#include "mottle/updating/estimate/estimate.hpp"

namespace mottle::updating {

/// Parameters between bounds. A box has no moments: its mean is its middle, its covariance that of the uniform
/// distribution on it, width^2 / 12 on the diagonal, and draws, densities and quantiles are of that distribution: a
/// convention, by which clouds fill the box. Correlations are not known; those of the convention are 0.
class BoxEstimate final : public Estimate {
 public:
  /// @throws InvalidInput  ends that are crossed, not finite, or of different size
  explicit BoxEstimate(ParameterBox box);

  EstimateKind kind() const override { return EstimateKind::box; }
  const ParameterBox& box() const { return box_; }
  Eigen::VectorXd mean() const override { return box_.middle(); }
  Eigen::MatrixXd covariance() const override;
  Eigen::MatrixXd from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const override;
  Eigen::VectorXd density(Eigen::Index parameter, const Eigen::Ref<const Eigen::VectorXd>& points) const override;
  Eigen::VectorXd density_points(Eigen::Index parameter, Eigen::Index count) const override;
  double quantile(Eigen::Index parameter, double probability) const override;
  /// The outline of the whole box, whatever the probability.
  std::vector<Eigen::MatrixXd> region(Eigen::Index first, Eigen::Index second, double probability,
                                      Eigen::Index points) const override;
  std::string prediction_note() const override;

 private:
  ParameterBox box_;
};

}  // namespace mottle::updating
