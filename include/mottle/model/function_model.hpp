// A user's own model: a function from parameters to outputs.
#pragma once

#include <functional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"

namespace mottle::model {

/// A model that is a function of one parameter vector.
class FunctionModel final : public Model {
 public:
  /// Parameters [parameter] -> outputs [output]. Called from as many threads as the context allows; throws an
  /// std::exception where it has no answer: that sample has then failed, and the exception says why.
  using Function = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

  /// @param parameters  their number
  /// @param outputs     what the function's values are
  /// @throws InvalidInput  no parameter, no output, an output without a name or of a name twice
  FunctionModel(Eigen::Index parameters, std::vector<Quantity> outputs, Function function);

  Eigen::Index parameter_count() const override { return parameters_; }
  const std::vector<Quantity>& outputs() const override { return outputs_; }
  /// A value that is not finite, or a wrong number of values, fails the sample too. Lack of memory ends the batch.
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override;

 private:
  Eigen::Index parameters_;
  std::vector<Quantity> outputs_;
  Function function_;
};

}  // namespace mottle::model
