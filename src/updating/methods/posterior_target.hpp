// The posterior of a problem as the sampler takes it: scores that are standard normal before the tests.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/sample_region.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "updating/methods/common_likelihood.hpp"

namespace mottle::updating {

/// Whether each sample lies within bounds, physical limits and scales [sample x parameter].
std::vector<bool> are_possible(const ParameterSpace& space, const Eigen::Ref<const Eigen::MatrixXd>& samples);

/// Runs the model for the sampler, counts what failed, and adapts the model to where the particles are. What it is made
/// of must outlive it, and it must outlive its target().
class PosteriorTarget {
 public:
  PosteriorTarget(const UpdatingProblem& problem, const NoiseLevels& noise, const CommonLikelihood& likelihood,
                  const RunContext& context);

  /// With gradients where the model has derivatives of its own that are no dearer than differences.
  SamplingTarget target();
  bool has_gradient() const { return has_gradient_; }
  /// Parameters of scores of parameters and levels [point x parameter].
  Eigen::MatrixXd parameters(const Eigen::MatrixXd& points) const;
  /// Parameters and levels [point x name].
  Eigen::MatrixXd values(const Eigen::MatrixXd& points) const;
  std::int64_t evaluations() const { return evaluations_; }
  std::int64_t failed() const { return failed_; }
  /// Points at which the gradient was asked for.
  std::int64_t gradients() const { return gradients_; }
  /// To which the model is adapted; null: to none.
  const std::shared_ptr<const SampleRegion>& region() const { return region_; }

 private:
  /// A batch of points and what the model says of them.
  struct Runs {
    Eigen::MatrixXd values;   ///< parameters and levels [point x name]
    Eigen::MatrixXd outputs;  ///< [point x output]
    Eigen::VectorXd log_likelihood;
  };

  Runs run(const Eigen::MatrixXd& points);
  LikelihoodGradient with_gradient(const Eigen::MatrixXd& points);
  Eigen::VectorXd gradient_at(const Eigen::VectorXd& point, const Eigen::VectorXd& values,
                              const Eigen::VectorXd& outputs) const;
  Eigen::MatrixXd levels(const Eigen::MatrixXd& points) const;
  std::vector<bool> is_possible(const Eigen::MatrixXd& points) const;
  Eigen::VectorXd largest_log_likelihood(const Eigen::MatrixXd& points) const;
  void follow(const Eigen::MatrixXd& particles);

  const UpdatingProblem& problem_;
  const NoiseLevels& noise_;
  const CommonLikelihood& likelihood_;
  const RunContext& context_;
  std::int64_t evaluations_ = 0;
  std::int64_t failed_ = 0;
  std::int64_t gradients_ = 0;
  bool has_gradient_ = false;
  std::shared_ptr<const SampleRegion> region_;
  bool has_width_ = false;
  double width_ = 0.0;  // of the region, mean of ln standard deviations
};

}  // namespace mottle::updating
