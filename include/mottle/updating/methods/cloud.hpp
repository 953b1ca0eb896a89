// A Monte-Carlo cloud: parameters drawn from a distribution and the model's outputs for each.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"
#include "mottle/model/parameters/parameter_space.hpp"
#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::updating {

/// How a cloud is drawn.
struct CloudSettings {
  int samples = 1000;
  SamplingDesign design = SamplingDesign::monte_carlo;
  double max_failed = 0.3;  ///< a cloud with a larger fraction of failed runs stops the computation
};

/// All samples of a cloud, failed ones included (their outputs are nan).
struct Cloud {
  Eigen::MatrixXd samples;  ///< [sample x parameter]
  Eigen::MatrixXd outputs;  ///< [sample x output]
  std::vector<FailedRun> failures;
  std::vector<SampleNote> notes = {};  ///< of runs that succeeded: modes that crossed or mixed
  std::int64_t rejected = 0;           ///< physically impossible draws that were replaced

  /// Samples and outputs of the runs that succeeded.
  struct Valid {
    Eigen::MatrixXd samples;
    Eigen::MatrixXd outputs;
  };
  Valid valid() const;
};

/// Draws and evaluates a cloud.
///
/// @param from_uniform  of the distribution that the parameters are drawn from
/// @param key           names the random streams
/// @throws SystemFailure  more than `max_failed` of the runs failed (names the first reasons)
Cloud evaluate_cloud(const Model& model, const ParameterSpace& space, const SampleTransform& from_uniform,
                     const CloudSettings& settings, const StreamKey& key, const RunContext& context);
Cloud evaluate_cloud(const Model& model, const ParameterSpace& space, const JointDistribution& distribution,
                     const CloudSettings& settings, const StreamKey& key, const RunContext& context);

/// Evaluates given parameter vectors [sample x parameter] in place of drawn ones.
Cloud evaluate_points(const Model& model, const Eigen::Ref<const Eigen::MatrixXd>& points, double max_failed,
                      const RunContext& context);

}  // namespace mottle::updating
