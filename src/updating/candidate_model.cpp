#include "candidate_model.hpp"

#include <Eigen/SVD>
#include <cmath>
#include <map>

namespace mottle {

std::vector<ShapeSign> shape_signs(const std::vector<Output>& outputs, const Eigen::Ref<const Eigen::MatrixXd>& tests) {
  std::map<std::string, std::vector<Eigen::Index>> shapes;
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const std::string& name = outputs[k].name;
    const std::size_t colon = name.find(':');
    if (name.starts_with("phi") && colon != std::string::npos) {
      shapes[name.substr(0, colon)].push_back(static_cast<Eigen::Index>(k));
    }
  }
  std::vector<ShapeSign> signs;
  for (auto& [name, columns] : shapes) {
    const Eigen::MatrixXd measured =
        tests(Eigen::all, columns).unaryExpr([](double value) { return std::isnan(value) ? 0.0 : value; });
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(measured, Eigen::ComputeThinV);
    Eigen::VectorXd towards = svd.matrixV().col(0);
    if ((measured * towards).sum() < 0.0) towards = -towards;
    signs.push_back({std::move(columns), std::move(towards)});
  }
  return signs;
}

void turn_shapes(const std::vector<ShapeSign>& signs, Eigen::MatrixXd& outputs) {
  for (const ShapeSign& sign : signs) {
    for (Eigen::Index s = 0; s < outputs.rows(); ++s) {
      double along = 0.0;
      for (std::size_t k = 0; k < sign.outputs.size(); ++k) {
        const double value = outputs(s, sign.outputs[k]);
        if (!std::isnan(value)) along += value * sign.towards(static_cast<Eigen::Index>(k));
      }
      if (along >= 0.0) continue;
      for (const Eigen::Index k : sign.outputs) outputs(s, k) = -outputs(s, k);
    }
  }
}

Evaluation HeldModel::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const {
  Eigen::MatrixXd all = nominal_.transpose().replicate(samples.rows(), 1);
  all(Eigen::all, members_) = samples;
  Evaluation evaluation = full_.evaluate(all, context);
  turn_shapes(signs_, evaluation.outputs);
  return evaluation;
}

ParameterSpace part_of(const ParameterSpace& space, const std::vector<Eigen::Index>& members) {
  std::vector<Parameter> parameters;
  for (const Eigen::Index i : members) parameters.push_back(space.parameters()[static_cast<std::size_t>(i)]);
  return {std::move(parameters), JointDistribution::multivariate_normal(space.prior().mean()(members),
                                                                        space.prior().covariance()(members, members))};
}

}  // namespace mottle
