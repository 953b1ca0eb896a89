// A surrogate, fitted to the runs of an expensive model, as a model.
#pragma once

#include <memory>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"
#include "mottle/model/parameters/parameter_space.hpp"
#include "mottle/stats/surrogates/surrogate.hpp"

namespace mottle::model {

/// Outputs of a model as surrogates fitted over the transformed parameters.
class SurrogateModel final : public Model {
 public:
  /// @param model  whose outputs are imitated; it and `space` must outlive this one
  SurrogateModel(const Model& model, const ParameterSpace& space) : model_(model), transforms_(space.transforms()) {}

  /// @param samples  possible parameters [run x parameter]
  /// @param outputs  [run x output], none nan
  /// @throws  as Surrogate
  void train(SurrogateKind kind, const Eigen::Ref<const Eigen::MatrixXd>& samples,
             const Eigen::Ref<const Eigen::MatrixXd>& outputs);

  const Surrogate& surrogate() const { return *surrogate_; }

  Eigen::Index parameter_count() const override { return model_.parameter_count(); }
  const std::vector<Quantity>& outputs() const override { return model_.outputs(); }
  /// Needs train(). Samples where a parameter's transform is not defined (at a logit's bounds, at zero of a logarithm)
  /// fail.
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override;

 private:
  const Model& model_;
  std::vector<ParameterTransform> transforms_;
  std::unique_ptr<const Surrogate> surrogate_;
};

}  // namespace mottle::model
