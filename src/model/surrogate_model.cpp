#include "mottle/model/surrogate_model.hpp"

#include <limits>

namespace mottle::model {

void SurrogateModel::train(SurrogateKind kind, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                           const Eigen::Ref<const Eigen::MatrixXd>& outputs) {
  surrogate_ = std::make_unique<const Surrogate>(kind, from_variables(scales_, samples), outputs);
}

Evaluation SurrogateModel::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const {
  context.throw_if_stopped();
  const Eigen::MatrixXd points = from_variables(scales_, samples);
  Evaluation evaluation{(*surrogate_)(points), {}};
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    if (points.row(s).allFinite()) continue;
    evaluation.outputs.row(s).setConstant(std::numeric_limits<double>::quiet_NaN());
    evaluation.failures.push_back({s, "a parameter lies beyond the ends of its scale, where there is no surrogate"});
  }
  return evaluation;
}

}  // namespace mottle::model
