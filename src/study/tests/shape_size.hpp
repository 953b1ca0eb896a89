// Whether the size of measured shapes is data.
#pragma once

#include <string>

#include "mottle/layers.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/study/input/study.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::study {

/// The size that the study states, or, where it leaves that to the tests, `free` where most measured shapes have no
/// modal mass. Tests that cannot be read are for read_tests() to refuse; those that were read stay in the study.
ShapeSize shape_size_of(Study& study);

/// Note on shapes of free size: what is compared, and the shapes that miss a component by which they would be scaled.
///
/// @param measured  [specimen x StructureModel::measured()]
/// @param tests     the same as outputs
std::string free_size_note(const StructureModel& model, const Eigen::MatrixXd& measured, const TestData& tests);

}  // namespace mottle::study
