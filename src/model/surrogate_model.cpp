#include "mottle/model/surrogate_model.hpp"

namespace mottle::model {

void SurrogateModel::train(SurrogateKind kind, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                           const Eigen::Ref<const Eigen::MatrixXd>& outputs) {
  surrogate_ = std::make_unique<const Surrogate>(kind, from_variables(scales_, samples), outputs);
}

Evaluation SurrogateModel::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const {
  context.throw_if_stopped();
  return {(*surrogate_)(from_variables(scales_, samples)), {}};
}

}  // namespace mottle::model
