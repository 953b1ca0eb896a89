// Derivatives of a model's outputs, measured and further ones, by its parameters and by the numbers that no parameter
// moves.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "study/jobs/candidates.hpp"
#include "study/jobs/further_outputs.hpp"

namespace mottle::study {

/// Derivatives at the updated mean, of the study's outputs first, then of further ones.
struct ErrorDerivatives {
  Eigen::MatrixXd parameters;  ///< [output x parameter]
  Eigen::MatrixXd errors;      ///< by an error as large as the number [output x quantity]
  Eigen::VectorXd size;        ///< a frequency's value, of a shape its largest component [output]
  Eigen::VectorXd noise;  ///< standard deviation at which further outputs would be measured, 0 of the others [output]
  std::vector<FurtherOutputs> further;
  std::vector<std::vector<Eigen::Index>> rows;  ///< outputs of each of `further`
};

/// One more build of the model and one Jacobian, solved in full.
///
/// @param mean         the updated mean [parameter]
/// @param has_further  whether outputs that are not measured are wanted too
/// @throws InvalidInput  the model cannot be built with the numbers as parameters, or has no derivatives there
ErrorDerivatives differentiate_errors(const Study& study, const StudyModel& made, const FixedNumbers& numbers,
                                      const Eigen::VectorXd& mean, bool has_further, const RunContext& context);

}  // namespace mottle::study
