// Sensors that are probably exchanged, or upside down, in all measured shapes.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/responses/output_selection.hpp"

namespace mottle::study {

/// A measured shape beside the model's.
struct ComparedShape {
  int mode = 0;               ///< the model's
  Eigen::VectorXd measured;   ///< [sensor]; nan: not measured
  Eigen::VectorXd reference;  ///< [sensor]; nan: the model has no such component
};

/// The one change of sensors, of two exchanged or of one turned round, that makes the shapes of all modes agree with
/// the model, in a sentence. It is named where the mean of 1 - MAC is at least 0.02 and falls to a quarter or less. It
/// takes three sensors and two modes: of fewer, some change always fits. Where there are more than 40 sensors, those of
/// the largest differences are tried.
///
/// @return  empty: there is none
std::string mistaken_sensors(const std::vector<ComparedShape>& shapes, const std::vector<std::string>& sensors);

/// The same of the shapes in a table of tests.
///
/// @param values, reference  as of pair_tests(), paired
std::string mistaken_sensors(const Eigen::Ref<const Eigen::MatrixXd>& values, const OutputSelection& selection,
                             const Eigen::Ref<const Eigen::MatrixXd>& reference);

}  // namespace mottle::study
