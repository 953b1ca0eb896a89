// The reduced models of one structure: one about the prior, and one about the region that was last asked for.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <optional>

#include "mottle/layers.hpp"
#include "mottle/linalg/reduced/reduced_model.hpp"
#include "mottle/model/solvers/reduced_solver.hpp"

namespace mottle::model {

/// A reduced model has two bases: all of its directions, and the leading ones.
enum class BasisPart { whole, leading };

/// What comparisons with the reference's shapes need of a basis V: Phi_ref' M V and V' M V.
struct ReducedComparison {
  ReducedComparison(const Eigen::MatrixXd& reference_products, Eigen::MatrixXd masses_between);

  /// Cosines between Phi_ref and V y of each column y of coordinates [mode x column].
  Eigen::MatrixXd cosines(const Eigen::Ref<const Eigen::MatrixXd>& coordinates) const;

  Eigen::Index modes;
  VectorRows reference;    ///< V' M Phi_ref [vector x padded mode]
  Eigen::MatrixXd mass;    ///< [vector x vector], empty where only its diagonal is not negligible
  Eigen::VectorXd masses;  ///< diagonal of V'MV
};

/// A trained model with what is computed once for its basis.
class TrainedReducedModel {
 public:
  TrainedReducedModel(const ExactSolver& exact, std::shared_ptr<const ReducedModel> model)
      : exact_(exact), model_(std::move(model)) {}

  const ReducedModel& model() const { return *model_; }
  /// @param reference_shapes  Phi_ref [equation x mode]
  std::shared_ptr<const ReducedComparison> comparison_with(const Eigen::MatrixXd& reference_shapes,
                                                           BasisPart part) const;
  /// Of its basis.
  Digest digest() const;

 private:
  const ExactSolver& exact_;
  std::shared_ptr<const ReducedModel> model_;
  mutable std::mutex mutex_;  // of the following
  mutable std::optional<Digest> digest_;
  mutable Eigen::MatrixXd shapes_;  // of the last comparison
  mutable std::shared_ptr<const ReducedComparison> whole_, leading_;
};

/// Models are trained when a batch first needs them, for one number of modes and guards at a time. They depend on the
/// structure, the settings and the region alone, never on a cloud. Where the model about the prior certifies a region's
/// samples, it serves the region too.
class TrainedReducedModels {
 public:
  TrainedReducedModels(const ExactSolver& exact, ReductionSettings settings)
      : exact_(exact), settings_(std::move(settings)) {}

  /// @param region  null: the prior
  /// @return        null where the region's centre cannot be solved
  std::shared_ptr<const TrainedReducedModel> at(const SampleRegion* region, int modes, int guards,
                                                const RunContext& context);

 private:
  std::shared_ptr<const TrainedReducedModel> train(const SampleRegion& region, int modes, int guards,
                                                   const RunContext& context) const;
  bool serves(const TrainedReducedModel& model, const SampleRegion& region, const RunContext& context) const;

  const ExactSolver& exact_;
  ReductionSettings settings_;
  std::mutex mutex_;  // of the following
  int modes_ = 0, guards_ = 0;
  std::shared_ptr<const TrainedReducedModel> prior_, latest_;
  std::optional<Digest> latest_region_;
};

/// Coefficients of the structure's terms at samples [sample x parameter].
TermCoefficients coefficients_at(const SparseStructure& structure, const Eigen::Ref<const Eigen::MatrixXd>& samples);

/// Rows whose reduced solution has an error bound above the tolerance.
struct Uncertified {
  std::vector<Eigen::Index> rows;
  std::size_t unbounded = 0;  ///< of them those without any bound, which cannot be refined

  /// In exact solutions.
  double cost() const {
    constexpr double k_refinement = 0.1;
    return k_refinement * static_cast<double>(rows.size() - unbounded) + static_cast<double>(unbounded);
  }
};

}  // namespace mottle::model
