// A model whose evaluations the ranks of a job share.
#pragma once

#include <string>
#include <vector>

#include "mottle/core/ranks.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"

namespace mottle::model {

/// The same numbers as the model's own, each batch shared out where there are ranks. All of them ask for the same
/// batches.
class RankedModel final : public Model {
 public:
  /// @param ranks  null: this process is alone. Model and ranks must outlive this object
  RankedModel(const Model& model, Ranks* ranks) : model_(model), ranks_(ranks) {}

  Eigen::Index parameter_count() const override { return model_.parameter_count(); }
  const std::vector<Quantity>& outputs() const override { return model_.outputs(); }
  Eigen::Index batch_size() const override { return model_.batch_size(); }
  double difference_step() const override { return model_.difference_step(); }
  bool adapts_to_regions() const override { return model_.adapts_to_regions(); }
  /// Throws SystemFailure where the ranks ask for different samples.
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override {
    return evaluate(nullptr, samples, context);
  }
  Evaluation evaluate_in(const SampleRegion& region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                         const RunContext& context) const override {
    return evaluate(&region, samples, context);
  }

 private:
  Evaluation evaluate(const SampleRegion* region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                      const RunContext& context) const;
  const Model& model_;
  Ranks* ranks_;
};

/// What ranks make sure that they have in common before they share a batch: its samples, and the region, which may be
/// null.
Digest digest_of_samples(const SampleRegion* region, const Eigen::Ref<const Eigen::MatrixXd>& samples);

}  // namespace mottle::model
