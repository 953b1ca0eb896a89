// A model in place of one that costs minutes: a surrogate of it, fitted to its runs.
#pragma once

#include <memory>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"
#include "mottle/model/parameters/parameter_space.hpp"
#include "mottle/stats/surrogates/surrogate.hpp"

namespace mottle::model {

/// Outputs of a model as functions fitted on the parameters' own scales.
class SurrogateModel final : public Model {
 public:
  /// @param model  whose outputs are imitated; it and `space` must outlive this one
  SurrogateModel(const Model& model, const ParameterSpace& space) : model_(model), scales_(space.scales()) {}

  /// @param samples  possible parameters [run x parameter]
  /// @param outputs  [run x output], none nan
  /// @throws  as Surrogate
  void train(SurrogateKind kind, const Eigen::Ref<const Eigen::MatrixXd>& samples,
             const Eigen::Ref<const Eigen::MatrixXd>& outputs);

  const Surrogate& surrogate() const { return *surrogate_; }

  Eigen::Index parameter_count() const override { return model_.parameter_count(); }
  const std::vector<Quantity>& outputs() const override { return model_.outputs(); }
  /// Needs train(). Samples beyond the ends of a parameter's scale (a logit's bounds, zero of a logarithm) fail.
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override;

 private:
  const Model& model_;
  std::vector<NormalScale> scales_;
  std::unique_ptr<const Surrogate> surrogate_;
};

}  // namespace mottle::model
