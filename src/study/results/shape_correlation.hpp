// Modal assurance criterion of model and test shapes, before and after the update.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// MAC of every mode of the outputs with the test modes that are paired with them, over the specimens that have both.
struct ShapeCorrelation {
  struct State {
    Eigen::MatrixXd mean;     ///< of the specimens; nan: measured in none [model mode x test mode]
    Eigen::VectorXd minimum;  ///< of the specimens, of each pair [mode]
  };

  std::vector<int> modes;                     ///< of model and tests, as the user counts
  Eigen::VectorXi count;                      ///< specimens whose mode was measured and paired [mode]
  State initial;                              ///< with the shapes at the prior's mean
  std::optional<State> final = std::nullopt;  ///< at the estimate; nothing where a mode is lost there
};

/// From shapes as they were measured, in the pairs that were used for the update, where tests came as modes; else from
/// those of a table of outputs, against the mean shapes of the first and the last cloud. Pairs are those of the prior's
/// mean: a mode that was paired wrongly stays so. Nothing where no shape was measured at two components or more.
///
/// @param followed  modes at the estimate; null: not known
std::optional<ShapeCorrelation> correlate_shapes(const StructureModel& model, const StudyTests& tests,
                                                 const UpdatingResult& result,
                                                 const StructureModel::FollowedModes* followed);

/// Displacements of nodes as the tests have them [node x xyz], where nothing was measured as the model has them.
struct MeasuredShape {
  std::vector<int> nodes;  ///< index into the mesh's nodes, ascending
  Eigen::MatrixX3d displacements;
};

/// The mean of the specimens' shapes of a mode, each scaled to the model's shape by least squares.
///
/// @param shapes  of the model, whose structure has a mesh [equation x mode]
/// @param mode    of the outputs, counted from 0
MeasuredShape measured_shape(const StructureModel& model, const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                             const std::vector<PairedSpecimen>& specimens, int mode);

/// `shape_correlation` of result.json; null where there is none.
Json shape_correlation_json(const std::optional<ShapeCorrelation>& correlation);

}  // namespace mottle::study
