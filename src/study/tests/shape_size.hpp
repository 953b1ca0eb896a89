// Whether the size of measured shapes is data.
#pragma once

#include <string>

#include "mottle/layers.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/study/input/study.hpp"

namespace mottle::study {

/// The size that the study states, or, where it leaves that to the tests, `free` where most measured shapes have no
/// modal mass. Tests that cannot be read are for read_tests() to refuse.
ShapeSize shape_size_of(const Study& study);

/// Note on shapes of free size: what is compared, and the shapes that miss a component by which they would be scaled.
///
/// @param measured  [specimen x StructureModel::measured()]
/// @param outputs   the same as outputs [specimen x output]
std::string free_size_note(const StructureModel& model, const Eigen::MatrixXd& measured,
                           const Eigen::MatrixXd& outputs);

}  // namespace mottle::study
