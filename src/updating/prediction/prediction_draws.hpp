// Draws of new specimens' tests from an estimated population.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"
#include "mottle/updating/prediction/prediction.hpp"

namespace mottle::updating {

class PredictiveDraws {
 public:
  using Kind = SpecimenDrawing::Kind;

  PredictiveDraws(const Model& model, const ParameterSpace& space, const Estimate& estimate,
                  const PredictionSettings& settings, const RunContext& context);

  /// Tests [draw x output], those of Kind::population without measurement noise; impossible ones left out and counted
  /// in `prediction`.
  /// @throws SystemFailure  more than half are
  Eigen::MatrixXd draw(Kind kind, Prediction& prediction) const;

 private:
  Eigen::MatrixXd points(Kind kind) const;
  Eigen::VectorXd shared_error(Kind kind, Eigen::Index draw) const;
  void add_model_error(Kind kind, const std::vector<Eigen::Index>& draws, Eigen::MatrixXd& outputs) const;

  const Model& model_;
  const ParameterSpace& space_;
  const Estimate& estimate_;
  const PredictionSettings& settings_;
  const RunContext& context_;
  Eigen::MatrixXd error_root_;  // of the covariance of the model's error, where there is one
};

/// Squared distances of tests from the prediction by its own covariance; nan where a test is incomplete.
Eigen::VectorXd squared_distances(const Prediction& prediction, const Eigen::Ref<const Eigen::MatrixXd>& values);

}  // namespace mottle::updating
