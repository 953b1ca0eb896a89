// The natural frequencies in tests and model that their frequencies and eigenvalues stand for.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::study {

/// Outputs that are frequencies, and as sqrt(lambda) / (2 pi) those that are eigenvalues.
struct TestedFrequencies {
  std::vector<int> modes = {};          ///< by number, in the order of the outputs
  std::vector<std::string> names = {};  ///< of the outputs
  Eigen::MatrixXd values = {};          ///< [specimen x mode]; nan: not measured

  Eigen::Index count() const { return static_cast<Eigen::Index>(modes.size()); }
};

TestedFrequencies tested_frequencies(const StructureModel& model, const TestData& tests);

/// Of the model's reference, 0 of rigid-body modes [mode of `modes`].
Eigen::VectorXd reference_frequencies(const StructureModel& model, const std::vector<int>& modes);

}  // namespace mottle::study
