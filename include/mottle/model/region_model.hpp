// A model whose samples all lie in one region, to which it is adapted.
#pragma once

#include <memory>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"
#include "mottle/model/sample_region.hpp"

namespace mottle::model {

/// Names the region with every batch.
class RegionModel final : public Model {
 public:
  /// @param model  must outlive this object
  RegionModel(const Model& model, std::shared_ptr<const SampleRegion> region)
      : model_(model), region_(std::move(region)) {}

  Eigen::Index parameter_count() const override { return model_.parameter_count(); }
  const std::vector<Quantity>& outputs() const override { return model_.outputs(); }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override {
    return model_.evaluate_in(*region_, samples, context);
  }
  Eigen::Index batch_size() const override { return model_.batch_size(); }
  double difference_step() const override { return model_.difference_step(); }

 private:
  const Model& model_;
  std::shared_ptr<const SampleRegion> region_;
};

}  // namespace mottle::model
