// Measured shapes beside the model's, at the components that both have.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/structure_model.hpp"
#include "study/tests/measured_modes.hpp"

namespace mottle::study {

/// A measured component as a sum of the model's degrees of freedom; empty: the model does not have it.
using LinearCombination = std::vector<std::pair<int, double>>;

/// What of one specimen the model sees.
struct ShapeComparison {
  std::vector<LinearCombination> terms;  ///< [component]
  Eigen::MatrixXd reference;  ///< the model's shapes there; zero where it has no such component [component x mode]
  Eigen::Index seen = 0;      ///< components that the model has
  Eigen::MatrixXd cosines;    ///< [reference mode x measured mode]

  /// Components of a measured mode that were measured and that the model has.
  std::vector<Eigen::Index> measured_rows(const MeasuredModes& modes, Eigen::Index mode) const;
};

ShapeComparison compare_shapes(const StructureModel& model, const MeasuredModes& modes);

/// The same with other shapes of the model than its reference's [equation x mode].
ShapeComparison compare_shapes(const StructureModel& model, const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                               const MeasuredModes& modes);

}  // namespace mottle::study
