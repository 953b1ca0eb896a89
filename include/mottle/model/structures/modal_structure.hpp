// A structure with parameters, as the modal model sees it: where modes and their derivatives come from.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "mottle/core/run_context.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/model/model.hpp"

namespace mottle {

/// What is read off the modes of every sample.
struct ModalObservation {
  ModeSet reference = {};                    ///< shapes to compare with; without shapes: no comparison
  std::vector<int> degrees_of_freedom = {};  ///< where displacements are wanted
  bool damping = false;                      ///< whether damping ratios are wanted

  bool needs_shapes() const { return reference.shapes.cols() > 0 || !degrees_of_freedom.empty() || damping; }
};

/// Modes of one sample as far as they are observed.
struct ObservedModes {
  Eigen::VectorXd eigenvalues;     ///< ascending [mode]
  Eigen::MatrixXd cosines;         ///< with the reference's shapes [reference mode x mode]
  Eigen::MatrixXd displacements;   ///< [degree of freedom x mode]
  Eigen::VectorXd damping_ratios;  ///< [mode]
};

/// K(x), M(x) and C(x) of one structure and the way its modes are found. Shapes have a row for each equation; the
/// degrees of freedom that a user names are found by number and read off by `displacements`.
class ModalStructure {
 public:
  virtual ~ModalStructure() = default;

  virtual Eigen::Index parameter_count() const = 0;
  /// The most modes there can be: the number of equations.
  virtual Eigen::Index mode_count() const = 0;
  virtual bool is_damped() const = 0;

  /// Number of a degree of freedom by its name, or -1.
  virtual int find_degree_of_freedom(const std::string& name) const = 0;
  /// "'m9' is not known here; ...": what a wrong name is answered with.
  virtual std::string unknown_degree_of_freedom(const std::string& name) const = 0;
  /// Components of shapes [equation x mode] at degrees of freedom: [degree of freedom x mode].
  virtual Eigen::MatrixXd displacements(const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                                        const std::vector<int>& degrees_of_freedom) const = 0;

  /// The lowest `modes` modes, ascending and mass-normalised, at one parameter vector; more where that costs nothing.
  /// Eigenvalues are nan where the structure has no modes.
  virtual ModeSet modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const = 0;

  /// What is done with each sample; called once a sample, by several threads at once. A failure that is not empty says
  /// why there are no modes.
  using Visitor = std::function<void(Eigen::Index sample, const ObservedModes& modes, const std::string& failure)>;

  /// The lowest `modes` modes of each row of `samples` [sample x parameter].
  ///
  /// @return  how they were found
  virtual SolverUse solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, int modes,
                          const ModalObservation& observation, const RunContext& context,
                          const Visitor& visit) const = 0;

  /// Cosines between shapes of the reference and of a sample, [reference mode x mode], within [-1, 1]; squares are the
  /// modal assurance criterion.
  virtual Eigen::MatrixXd cosines(const ModeSet& reference, const ModeSet& modes) const = 0;

  /// d lambda / dx [mode x parameter]; nan for repeated eigenvalues. See eigenvalue_sensitivity().
  virtual Eigen::MatrixXd eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                 const ModeSet& modes) const = 0;
  /// d phi / dx of one mode [equation x parameter]; nan for a repeated eigenvalue.
  virtual Eigen::MatrixXd shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters, const ModeSet& modes,
                                            int mode) const = 0;

  /// Whether derivatives are ever other than nan.
  virtual bool has_derivatives() const { return true; }
  /// See DifferentiableModel::has_cheap_jacobian().
  virtual bool has_cheap_derivatives() const { return true; }
  /// See Model::difference_step().
  virtual double difference_step() const { return k_usual_difference_step; }

  /// Modal damping ratios [mode]; nan where a mode does not oscillate.
  virtual Eigen::VectorXd damping_ratios(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                         const ModeSet& modes) const = 0;
  /// How many modes the damping ratios of the lowest `modes` rest on.
  virtual int modes_for_damping(int modes) const = 0;

  /// Samples that are evaluated before they are written down.
  virtual Eigen::Index batch_size() const = 0;

  /// Total mass at one parameter vector.
  virtual double total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const = 0;
  /// What the structure is made of and how it was understood, in lines for `check`.
  virtual std::vector<std::string> description(const Eigen::Ref<const Eigen::VectorXd>& parameters) const = 0;
  /// How a parameter enters: "linearly: no re-assembly".
  virtual std::string parameter_role(Eigen::Index parameter) const = 0;
};

}  // namespace mottle
