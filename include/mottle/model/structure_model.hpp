// The model of a structure: a solver, and the responses that make outputs of its solutions.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"
#include "mottle/model/responses/output_selection.hpp"
#include "mottle/model/solvers/solver.hpp"

namespace mottle::model {

class Response;
struct AffineStructure;
struct ModeMatch;

/// Outputs of K(x), M(x), C(x). Modes, if any are needed, have the numbers, and shapes the signs, of the reference's.
class StructureModel final : public Model, public DifferentiableModel {
 public:
  /// @param reference  parameters at which mode numbers and signs are defined [parameter]
  /// Throws InvalidInput: a mode number or degree of freedom that the structure does not have (says which it has),
  /// a repeated one, no output at all, damping ratios of an undamped structure, a reference structure that is
  /// unstable, has no modes, or is not supported against its loads.
  StructureModel(std::unique_ptr<Solver> solver, OutputSelection selection, const Eigen::VectorXd& reference);
  /// The same of a small structure with full matrices.
  StructureModel(AffineStructure structure, OutputSelection selection, const Eigen::VectorXd& reference);
  StructureModel(StructureModel&&) noexcept;
  ~StructureModel() override;

  Eigen::Index parameter_count() const override { return reference_parameters_.size(); }
  const std::vector<Quantity>& outputs() const override { return outputs_; }
  /// What a test must have measured for the outputs: they themselves, but of shapes of free size all components.
  const std::vector<Quantity>& measured() const { return measured_; }
  /// Outputs of tests [specimen x output] from what they measured [specimen x measured]; nan: not measured.
  Eigen::MatrixXd outputs_of(const Eigen::Ref<const Eigen::MatrixXd>& measured) const;
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override {
    return evaluate(nullptr, samples, context);
  }
  Evaluation evaluate_in(const SampleRegion& region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                         const RunContext& context) const override {
    return evaluate(&region, samples, context);
  }
  Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;

  bool has_cheap_jacobian() const override { return solver_->has_cheap_derivatives(); }
  Eigen::Index batch_size() const override { return solver_->batch_size(); }
  double difference_step() const override { return solver_->difference_step(); }
  bool adapts_to_regions() const override { return solver_->adapts_to_regions(); }
  /// Itself, where its solver has derivatives; else null.
  const DifferentiableModel* derivatives() const { return solver_->has_derivatives() ? this : nullptr; }

  /// The modes at other parameters as the reference numbers them.
  struct FollowedModes {
    ModeSet modes;            ///< column k is the reference's mode k + 1
    std::vector<int> rank;    ///< by frequency among the modes there, counted from 0
    std::vector<double> mac;  ///< with the reference's mode
  };
  /// Throws InvalidInput where a mode is lost.
  FollowedModes follow(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

  /// Solves there, unless it is the reference. Throws InvalidInput: it has no modes there, is unstable, or not
  /// supported against its loads.
  void require_solution_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;

  /// Whether a mode of the reference, counted from 0, is among the outputs.
  bool is_output(int mode) const { return is_output_[static_cast<std::size_t>(mode)]; }
  int highest_mode() const { return static_cast<int>(is_output_.size()); }
  const OutputSelection& selection() const { return selection_; }
  /// Shapes of the reference at the degrees of freedom of the outputs' shapes [degree of freedom x mode 1..highest].
  Eigen::MatrixXd reference_displacements() const;

  const Solver& solver() const { return *solver_; }
  const Structure& structure() const { return solver_->structure(); }
  /// Modes at the reference parameters, by which mode numbers are defined.
  const ModeSet& reference_modes() const { return reference_; }
  const Eigen::VectorXd& reference_parameters() const { return reference_parameters_; }

 private:
  struct Part;

  Evaluation evaluate(const SampleRegion* region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                      const RunContext& context) const;
  void take(std::unique_ptr<Response> response, std::vector<int>& degrees_of_freedom);
  void take_outputs();
  void complete_request(const std::vector<int>& degrees_of_freedom);
  ModeSet sound_modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  double scale_of(const ModeSet& modes, const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  void require_statics_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const;
  void solve_reference();
  ModeMatch match_modes(Eigen::Index found, const Eigen::MatrixXd& cosines) const;
  ModeMatch match_all(const ModeSet& modes) const;
  ModeSet numbered_modes() const;
  std::string fill_outputs(const Solution& solution, const ModeMatch& match,
                           Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) const;

  std::unique_ptr<Solver> solver_;
  OutputSelection selection_;
  std::vector<Part> responses_;
  std::vector<Quantity> outputs_;
  std::vector<Quantity> measured_;
  Eigen::VectorXd reference_parameters_;
  ModeSet reference_;
  double largest_eigenvalue_ = 0.0;  // of the reference, or more: see scale_of()
  SolutionRequest request_;          // of all responses together
  bool compares_ = false;            // whether modes are compared with the reference's
  std::vector<bool> is_output_;      // by mode up to the highest; the others only keep the outputs' modes apart
};

}  // namespace mottle::model
