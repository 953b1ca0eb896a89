// Why an output has no value in any specimen.
#pragma once

#include <Eigen/Core>
#include <string>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/study_objects.hpp"

namespace mottle::study {

/// What follows "output 'phi1:1:+X'": whether it was never measured, its shape has no size, or, where sizes are free,
/// which components its shape lacks; and what to do.
///
/// @param measured  [specimen x StructureModel::measured()]; nan: not measured
/// @param is_by_mac modes are paired by shape
std::string why_missing(const StructureModel& model, const Quantity& output, const Eigen::MatrixXd& measured,
                        const StudyTests& tests, bool is_by_mac);

}  // namespace mottle::study
