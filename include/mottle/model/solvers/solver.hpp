// Interface of the solvers: modes and static solutions of a structure, and their derivatives.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "mottle/core/run_context.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"
#include "mottle/model/structures/structure.hpp"

namespace mottle::model {

/// The results requested for every sample.
struct SolutionRequest {
  int modes = 0;  ///< the lowest so many; 0: none
  /// The lowest of these whose errors matter where `keeps_to_certain` says so of a sample's cosines: the others are for
  /// comparison. 0: all.
  int certain = 0;
  std::function<bool(const Eigen::MatrixXd& cosines)> keeps_to_certain = {};
  ModeSet reference = {};              ///< shapes to compare with; without shapes: no comparison
  ObservationMatrix observation = {};  ///< where displacements are wanted [degree of freedom x equation]
  Eigen::MatrixXd loads = {};          ///< whose static solutions are wanted [equation x load]
  bool damping = false;                ///< whether damping ratios are wanted
  /// Where the samples lie, for solvers that approximate; null: somewhere in the prior.
  const SampleRegion* region = nullptr;

  bool needs_shapes() const { return modes > 0 && (reference.shapes.cols() > 0 || observation.rows() > 0 || damping); }
};

/// The requested results of one sample.
struct Solution {
  Eigen::VectorXd eigenvalues = {};           ///< ascending [mode]
  Eigen::MatrixXd cosines = {};               ///< with the reference's shapes [reference mode x mode]
  Eigen::MatrixXd displacements = {};         ///< [degree of freedom x mode]
  Eigen::VectorXd damping_ratios = {};        ///< nan where a mode does not oscillate [mode]
  Eigen::MatrixXd static_displacements = {};  ///< u of K u = f [degree of freedom x load]
};

/// The way in which one structure's equations are solved.
class Solver {
 public:
  virtual ~Solver() = default;

  virtual const Structure& structure() const = 0;

  /// The lowest `modes` modes, ascending and mass-normalised, at one parameter vector; more where that costs nothing.
  /// Eigenvalues are nan where the structure has no modes.
  virtual ModeSet modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const = 0;

  /// What is done with each sample; called once a sample, by several threads at once. A failure that is not empty says
  /// why there is no solution.
  using Visitor = std::function<void(Eigen::Index sample, const Solution& solution, const std::string& failure)>;

  /// Solves each row of `samples` [sample x parameter].
  ///
  /// @return  how they were solved
  virtual SolverUse solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                          const RunContext& context, const Visitor& visit) const = 0;

  /// Cosines between shapes of the reference and of a sample, [reference mode x mode], within [-1, 1]; squares are the
  /// modal assurance criterion.
  virtual Eigen::MatrixXd cosines(const ModeSet& reference, const ModeSet& modes) const = 0;

  /// How large an eigenvalue rounding may leave of a rigid-body motion; 0: not known.
  ///
  /// @param modes  at the parameters, with their shapes
  virtual double eigenvalue_rounding(const Eigen::Ref<const Eigen::VectorXd>& /*parameters*/,
                                     const ModeSet& /*modes*/) const {
    return 0.0;
  }

  /// Whether derivatives are ever other than nan.
  virtual bool has_derivatives() const { return true; }
  /// d lambda / dx [mode x parameter]; nan for repeated eigenvalues. See eigenvalue_sensitivity().
  virtual Eigen::MatrixXd eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                 const ModeSet& modes) const = 0;
  /// d phi / dx of one mode [equation x parameter]; nan for a repeated eigenvalue.
  virtual Eigen::MatrixXd shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters, const ModeSet& modes,
                                            int mode) const = 0;
  /// B du / dx of the static solutions K u = f: of each load a matrix [observed row x parameter].
  ///
  /// @param loads        f [equation x load]
  /// @param observation  B [observed row x equation]
  /// @throws InvalidInput  K is singular there
  virtual std::vector<Eigen::MatrixXd> static_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                          const Eigen::MatrixXd& loads,
                                                          const ObservationMatrix& observation) const = 0;

  /// Number of modes needed for the damping ratios of the lowest `modes`.
  virtual int modes_for_damping(int modes) const { return modes; }

  /// See DifferentiableModel::has_cheap_jacobian().
  virtual bool has_cheap_derivatives() const { return true; }
  /// See Model::difference_step().
  virtual double difference_step() const { return k_usual_difference_step; }
  /// See Model::adapts_to_regions().
  virtual bool adapts_to_regions() const { return false; }
  /// Samples that are evaluated before they are written down.
  virtual Eigen::Index batch_size() const = 0;
};

}  // namespace mottle::model
