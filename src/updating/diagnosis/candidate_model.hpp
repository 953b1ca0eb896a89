// Part of a model's parameters, the others held: one model serves every set of parameters that a diagnosis tries.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// Outputs that are one mode's shape, and the sign in which it is compared.
struct ShapeSign {
  std::vector<Eigen::Index> outputs;
  Eigen::VectorXd towards;  ///< the tests' shape, 0 where never measured [of outputs]
};

/// The shapes among outputs, mode by mode, with the direction in which most of the tests' scatter
/// around zero lies: no sign of any specimen counts in it.
std::vector<ShapeSign> shape_signs(const std::vector<Quantity>& outputs,
                                   const Eigen::Ref<const Eigen::MatrixXd>& tests);

/// Turns each row's shapes to the tests' sign; nan stay.
void turn_shapes(const std::vector<ShapeSign>& signs, Eigen::MatrixXd& outputs);

/// The model with some of its parameters; the others are held, shapes have the tests' sign.
class FixedParameterModel final : public Model, public DifferentiableModel {
 public:
  /// @param full     whose model and derivatives these are
  /// @param nominal  of all parameters of `full`
  /// @param members  which of them are parameters here
  FixedParameterModel(const UpdatingProblem& full, Eigen::VectorXd nominal, std::vector<Eigen::Index> members,
                      const std::vector<ShapeSign>& signs)
      : full_(full.model),
        full_derivatives_(full.derivatives),
        nominal_(std::move(nominal)),
        members_(std::move(members)),
        signs_(signs) {}

  Eigen::Index parameter_count() const override { return static_cast<Eigen::Index>(members_.size()); }
  const std::vector<Quantity>& outputs() const override { return full_.outputs(); }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override;
  Eigen::Index batch_size() const override { return full_.batch_size(); }
  double difference_step() const override { return full_.difference_step(); }

  Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;
  /// This, where derivatives are to be had for less than their differences; else null.
  const DifferentiableModel* derivatives() const;

 private:
  Eigen::MatrixXd all_parameters(const Eigen::Ref<const Eigen::MatrixXd>& samples) const;

  const Model& full_;
  const DifferentiableModel* full_derivatives_;
  Eigen::VectorXd nominal_;
  std::vector<Eigen::Index> members_;
  const std::vector<ShapeSign>& signs_;
};

/// The members' part of a space, normal with the moments of its prior.
ParameterSpace part_of(const ParameterSpace& space, const std::vector<Eigen::Index>& members);

}  // namespace mottle::updating
