#include "mottle/model/surrogate_model.hpp"

namespace mottle {

Eigen::MatrixXd SurrogateModel::on_scales(const Eigen::Ref<const Eigen::MatrixXd>& samples) const {
  Eigen::MatrixXd t = samples;
  for (Eigen::Index i = 0; i < t.cols(); ++i) {
    const NormalScale& scale = scales_[static_cast<std::size_t>(i)];
    t.col(i) = t.col(i).unaryExpr([&](double x) { return scale.from_variable(x); });
  }
  return t;
}

void SurrogateModel::train(SurrogateKind kind, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                           const Eigen::Ref<const Eigen::MatrixXd>& outputs) {
  surrogate_ = std::make_unique<const Surrogate>(kind, on_scales(samples), outputs);
}

Evaluation SurrogateModel::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const {
  context.throw_if_stopped();
  return {(*surrogate_)(on_scales(samples)), {}};
}

}  // namespace mottle
