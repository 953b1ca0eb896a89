// Table of the assignment of each specimen's measured modes to the model's modes.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/structure_model.hpp"
#include "study/tests/measured_modes.hpp"

namespace mottle::study {

/// One specimen's modes, its shapes in the axes that were settled on.
struct PairedSpecimen {
  MeasuredModes modes;
  std::map<int, Eigen::Index> assigned;  ///< measured mode of each of the reference's, both counted from 0
};

/// Specimens as values of the model's outputs, and how they came about.
struct PairedModes {
  Eigen::MatrixXd values = {};          ///< [specimen x StructureModel::measured()]; nan: not measured
  std::string table = {};               ///< CSV: a row for each mode of the outputs and each measured mode that is none
  std::vector<std::string> notes = {};  ///< what is missing, doubtful or left out
  std::string mistaken_sensors = {};    ///< a sentence, see mistaken_sensors(); empty: none are
  std::vector<PairedSpecimen> specimens = {};
};

/// Pairs every specimen's modes with the reference's by MAC at the measured components and optimal assignment, or by
/// rank in frequency.
///
/// A pair whose MAC is below `minimum_mac` of the outputs is none, unless the two belong to close modes whose shapes
/// have mixed (close_modes()). A pair is doubtful where its MAC is below 0.8, where another mode comes within 0.1 of
/// it, or where the modal phase collinearity is below 0.9. Shapes get the reference's sign; where their size is free
/// they are scaled to the reference by least squares, where it is data those without modal mass are not used. An
/// output's component is taken where the measured directions at its node span it.
///
/// Where a file has nodes with axes of their own, its numbers are in those axes by the format, but global in the files
/// of some programs: the sum of MAC decides, and a note says so.
///
/// Throws InvalidInput: no measured component is in the model, by MAC a specimen without shapes.
PairedModes pair_modes(const StructureModel& model, const std::vector<MeasuredModes>& specimens, bool by_mac);

}  // namespace mottle::study
