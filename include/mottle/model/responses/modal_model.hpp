// The model whose outputs are modal: natural frequencies, shapes and damping ratios of a structure. Knows which modes
// are which; how they are found is the structure's business.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/model/model.hpp"
#include "mottle/model/structures/affine_matrices.hpp"
#include "mottle/model/structures/modal_structure.hpp"

namespace mottle {

/// How a sample's modes are matched with the reference's mode numbers.
enum class ModeTracking {
  order,  ///< by rank in frequency
  mac,    ///< by MAC with the reference shapes and optimal assignment
};

/// Which modal quantities are outputs. Mode numbers count from 1, in the order of the reference structure.
struct ModalOutputs {
  std::vector<int> frequencies = {};
  std::vector<int> shape_modes = {};
  std::vector<std::string> shape_degrees_of_freedom = {};
  std::vector<int> damping = {};
  ModeTracking tracking = ModeTracking::order;
  std::string frequency_unit = "Hz";      ///< of 1 / (time unit of the matrices)
  std::string shape_unit = "1/sqrt(kg)";  ///< of a mass-normalised shape
  double minimum_mac =
      0.5;  ///< a tracked mode with less, alone and with those it mixed with, is lost: its sample fails
};

/// Modes of K(x), M(x), C(x). Shapes are mass-normalised with the sign of the reference's.
class ModalModel final : public Model, public DifferentiableModel {
 public:
  /// @param reference  parameters at which mode numbers and signs are defined [parameter]
  /// Throws InvalidInput: a mode number or degree of freedom that the structure does not have (says which it has),
  /// a repeated one, no output at all, damping ratios of an undamped structure, a reference structure that is
  /// unstable or has no modes.
  ModalModel(std::unique_ptr<ModalStructure> structure, ModalOutputs selection, const Eigen::VectorXd& reference);
  /// The same of a small structure with full matrices.
  ModalModel(AffineStructure structure, ModalOutputs selection, const Eigen::VectorXd& reference);

  Eigen::Index parameter_count() const override { return reference_parameters_.size(); }
  const std::vector<Output>& outputs() const override { return outputs_; }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override;
  Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;

  bool has_cheap_jacobian() const override { return structure_->has_cheap_derivatives(); }
  Eigen::Index batch_size() const override { return structure_->batch_size(); }
  double difference_step() const override { return structure_->difference_step(); }

  /// The modes at other parameters as the reference numbers them.
  struct FollowedModes {
    ModeSet modes;            ///< column k is the reference's mode k + 1
    std::vector<int> rank;    ///< by frequency among the modes there, counted from 0
    std::vector<double> mac;  ///< with the reference's mode
  };
  /// Throws InvalidInput where a mode is lost.
  FollowedModes follow(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

  /// Whether a mode of the reference, counted from 0, is among the outputs.
  bool is_output(int mode) const { return is_output_[static_cast<std::size_t>(mode)]; }
  int highest_mode() const { return highest_mode_; }
  const ModalOutputs& selection() const { return selection_; }
  /// Shapes of the reference at the degrees of freedom of the outputs [degree of freedom x mode 1..highest].
  Eigen::MatrixXd reference_displacements() const;

  const ModalStructure& structure() const { return *structure_; }
  /// Modes at the reference parameters, by which mode numbers are defined.
  const ModeSet& reference_modes() const { return reference_; }

 private:
  bool needs_shapes() const;
  int solved_modes() const;
  void check_selection() const;
  void name_outputs();
  struct Match;
  Match match_modes(Eigen::Index found, const Eigen::MatrixXd& cosines) const;
  Match match_all(const ModeSet& modes) const;
  ModalObservation observation() const;
  ModeSet numbered_modes() const;
  std::string fill_outputs(const ObservedModes& modes, const Match& match,
                           Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) const;

  std::unique_ptr<ModalStructure> structure_;
  ModalOutputs selection_;
  Eigen::VectorXd reference_parameters_;
  ModeSet reference_;
  std::vector<int> shape_rows_;
  std::vector<Output> outputs_;
  int highest_mode_ = 0;
  std::vector<bool> is_output_;  // by mode; the others only keep the outputs' modes apart
};

}  // namespace mottle
