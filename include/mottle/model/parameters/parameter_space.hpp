// The uncertain parameters: names, prior distribution, bounds and physical limits.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "mottle/core/random.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/parameters/parameter_targets.hpp"
#include "mottle/stats/distributions/joint_distribution.hpp"
#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::model {

/// One uncertain parameter.
struct Parameter {
  std::string name;
  std::string unit;
  /// The updated mean stays within the bounds; of a population that is normal on another scale, its median.
  double lower_bound = -std::numeric_limits<double>::infinity();
  double upper_bound = std::numeric_limits<double>::infinity();
  PhysicalLimit limit = {};
  ParameterTransform transform = {};  ///< under which methods that estimate a population take it as normal
};

/// A drawn cloud of parameters.
struct ParameterDraw {
  Eigen::MatrixXd samples;    ///< [sample x parameter]
  std::int64_t rejected = 0;  ///< draws that were physically impossible and were drawn again
};

/// Samples from uniforms in (0, 1), row by row: the inverse transform of a distribution [sample x parameter].
using SampleTransform = std::function<Eigen::MatrixXd(const Eigen::Ref<const Eigen::MatrixXd>& uniforms)>;

/// All uncertain parameters with their joint prior.
class ParameterSpace {
 public:
  /// Throws InvalidInput: bounds crossed, prior mean outside the bounds or physically impossible.
  ParameterSpace(std::vector<Parameter> parameters, JointDistribution prior);

  Eigen::Index count() const { return static_cast<Eigen::Index>(parameters_.size()); }
  const std::vector<Parameter>& parameters() const { return parameters_; }
  const JointDistribution& prior() const { return prior_; }
  std::vector<std::string> names() const;
  std::vector<ParameterTransform> transforms() const;

  /// Whether every stiffness and mass is positive (damping: not negative).
  bool is_possible(const Eigen::Ref<const Eigen::RowVectorXd>& sample) const;

  /// `parameters` moved to the nearest point within the bounds and physical limits.
  Eigen::VectorXd clamp(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

  /// -1 where a parameter is on its lower bound, +1 on its upper, else 0 (relative tolerance 1e-9).
  Eigen::VectorXi active_bounds(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

  /// Draws from the distribution whose transform is `from_uniform`; a sample that is physically impossible is rejected
  /// and drawn again, independently and by plain Monte Carlo, until it is possible: the cloud follows the distribution
  /// cut at the physical limits.
  ///
  /// Throws InvalidInput after 10,000 rejections of one sample: the distribution is almost wholly impossible.
  ParameterDraw draw(const SampleTransform& from_uniform, SamplingDesign design, Eigen::Index samples,
                     const StreamKey& key) const;
  ParameterDraw draw(const JointDistribution& distribution, SamplingDesign design, Eigen::Index samples,
                     const StreamKey& key) const;

 private:
  std::vector<Parameter> parameters_;
  JointDistribution prior_;
};

}  // namespace mottle::model
