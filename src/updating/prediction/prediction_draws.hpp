// Draws of new specimens' tests from an estimated population.
#pragma once

#include <Eigen/Core>

#include "mottle/updating/prediction/prediction.hpp"

namespace mottle {

class PredictiveDraws {
 public:
  enum class Kind {
    population,  ///< the estimate taken as exact, without measurement noise
    outputs,     ///< each output by itself: one scale of the whole scatter is uncertain
    joint,       ///< all outputs together: the whole covariance is uncertain
  };

  PredictiveDraws(const Model& model, const ParameterSpace& space, const PredictedPopulation& population,
                  const PredictionSettings& settings, const RunContext& context);

  /// Whether the specimens tell enough of the covariance for a region of all outputs together.
  bool has_joint_region() const;

  /// Tests [draw x output], impossible ones left out and counted in `prediction`.
  /// @throws SystemFailure  more than half are
  Eigen::MatrixXd draw(Kind kind, Prediction& prediction) const;

 private:
  Eigen::MatrixXd points(Kind kind) const;
  double joint_freedom() const;
  Eigen::VectorXd shared_error(Kind kind, Eigen::Index draw) const;
  void add_model_error(Kind kind, const std::vector<Eigen::Index>& draws, Eigen::MatrixXd& outputs) const;

  const Model& model_;
  const ParameterSpace& space_;
  const PredictedPopulation& population_;
  const PredictionSettings& settings_;
  const RunContext& context_;
  Eigen::MatrixXd error_root_;  // of the covariance of the model's error, where there is one
};

/// Squared distances of tests from the prediction by its own covariance; nan where a test is incomplete.
Eigen::VectorXd squared_distances(const Prediction& prediction, const Eigen::Ref<const Eigen::MatrixXd>& values);

}  // namespace mottle
