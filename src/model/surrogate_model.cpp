#include "mottle/model/surrogate_model.hpp"

#include <limits>

namespace mottle::model {

void SurrogateModel::train(SurrogateKind kind, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                           const Eigen::Ref<const Eigen::MatrixXd>& outputs) {
  surrogate_ = std::make_unique<const Surrogate>(kind, from_variables(transforms_, samples), outputs);
}

Evaluation SurrogateModel::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const {
  context.throw_if_stopped();
  const Eigen::MatrixXd points = from_variables(transforms_, samples);
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  Evaluation evaluation{
      Eigen::MatrixXd::Constant(points.rows(), static_cast<Eigen::Index>(model_.outputs().size()), k_nan), {}};
  std::vector<Eigen::Index> within;
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    if (points.row(s).allFinite()) {
      within.push_back(s);
    } else {
      evaluation.failures.push_back({s, "a parameter lies beyond the ends of its scale, where there is no surrogate"});
    }
  }
  evaluation.outputs(within, Eigen::all) = (*surrogate_)(points(within, Eigen::all));
  return evaluation;
}

}  // namespace mottle::model
