#include "updating/diagnosis/candidate_model.hpp"

#include <Eigen/Core>
#include <cmath>
#include <map>

#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::updating {

std::vector<ShapeSign> shape_signs(const std::vector<Quantity>& outputs,
                                   const Eigen::Ref<const Eigen::MatrixXd>& tests) {
  std::map<int, std::vector<Eigen::Index>> shapes;
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const bool is_shape = outputs[k].kind == QuantityKind::displacement || outputs[k].kind == QuantityKind::rotation;
    if (is_shape) shapes[outputs[k].number].push_back(static_cast<Eigen::Index>(k));
  }
  std::vector<ShapeSign> signs;
  for (auto& [mode, columns] : shapes) {
    const Eigen::MatrixXd measured =
        tests(Eigen::all, columns).unaryExpr([](double value) { return std::isnan(value) ? 0.0 : value; });
    const SingularValues svd(measured, Eigen::ComputeThinV);
    Eigen::VectorXd towards = svd.right().col(0);
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

Eigen::MatrixXd FixedParameterModel::all_parameters(const Eigen::Ref<const Eigen::MatrixXd>& samples) const {
  Eigen::MatrixXd all = nominal_.transpose().replicate(samples.rows(), 1);
  all(Eigen::all, members_) = samples;
  return all;
}

const DifferentiableModel* FixedParameterModel::derivatives() const {
  // Which way a shape is turned is read off the model itself: not off one that journals, several threads ask here.
  const bool has_signs = signs_.empty() || dynamic_cast<const Model*>(full_derivatives_) != nullptr;
  if (full_derivatives_ == nullptr || !has_signs) return nullptr;
  // The Jacobian of the full matrices costs nearly the same for any number of parameters, a reduced model of many of
  // them more than it saves.
  constexpr std::size_t k_many = 12;
  return full_derivatives_->has_cheap_jacobian() || members_.size() > k_many ? this : nullptr;
}

Eigen::MatrixXd FixedParameterModel::jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const Eigen::MatrixXd sample = all_parameters(parameters.transpose());
  Eigen::MatrixXd jacobian = full_derivatives_->jacobian(sample.row(0).transpose())(Eigen::all, members_);
  if (signs_.empty()) return jacobian;
  const Eigen::MatrixXd outputs = dynamic_cast<const Model&>(*full_derivatives_).evaluate(sample, {}).outputs;
  Eigen::MatrixXd turned = outputs;
  turn_shapes(signs_, turned);
  for (Eigen::Index k = 0; k < jacobian.rows(); ++k) {
    if (turned(0, k) != outputs(0, k)) jacobian.row(k) = -jacobian.row(k);
  }
  return jacobian;
}

Evaluation FixedParameterModel::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                         const RunContext& context) const {
  Evaluation evaluation = full_.evaluate(all_parameters(samples), context);
  turn_shapes(signs_, evaluation.outputs);
  return evaluation;
}

ParameterSpace part_of(const ParameterSpace& space, const std::vector<Eigen::Index>& members) {
  std::vector<Parameter> parameters;
  for (const Eigen::Index i : members) parameters.push_back(space.parameters()[static_cast<std::size_t>(i)]);
  return {std::move(parameters), JointDistribution::multivariate_normal(space.prior().mean()(members),
                                                                        space.prior().covariance()(members, members))};
}

}  // namespace mottle::updating
