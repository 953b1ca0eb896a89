// A model from matrices in files.
#pragma once

#include <string>
#include <vector>

#include "mottle/model/structures/matrix_structure.hpp"
#include "mottle/study/input/study.hpp"

namespace mottle {

/// @param files  those that were read are added
/// @throws InvalidInput, FormatError  as read_symmetric_matrix and bind_parameters
MatrixModel read_matrices(const StudyModelSource& source, const std::vector<ParameterTargets>& targets,
                          const Eigen::VectorXd& prior_mean, std::vector<std::string>& files);

}  // namespace mottle
