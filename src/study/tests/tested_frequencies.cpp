#include "study/tests/tested_frequencies.hpp"

#include <numbers>

#include "mottle/dynamics/modes/mode_set.hpp"

namespace mottle::study {

TestedFrequencies tested_frequencies(const StructureModel& model, const TestData& tests) {
  TestedFrequencies found;
  found.values.resize(tests.values.rows(), static_cast<Eigen::Index>(model.outputs().size()));
  for (std::size_t k = 0; k < model.outputs().size(); ++k) {
    const Quantity& output = model.outputs()[k];
    const bool is_eigenvalue = output.kind == QuantityKind::eigenvalue;
    if (!is_eigenvalue && output.kind != QuantityKind::frequency) continue;
    const Eigen::ArrayXd values = tests.values.col(static_cast<Eigen::Index>(k)).array();
    found.values.col(found.count()) = is_eigenvalue ? Eigen::ArrayXd(values.sqrt() / (2.0 * std::numbers::pi)) : values;
    found.modes.push_back(output.number);
    found.names.push_back(output.name());
  }
  found.values.conservativeResize(Eigen::NoChange, found.count());
  return found;
}

Eigen::VectorXd reference_frequencies(const StructureModel& model, const std::vector<int>& modes) {
  const Eigen::VectorXd& eigenvalues = model.reference_modes().eigenvalues;
  Eigen::VectorXd frequencies(static_cast<Eigen::Index>(modes.size()));
  for (std::size_t k = 0; k < modes.size(); ++k) {
    frequencies(static_cast<Eigen::Index>(k)) =
        natural_frequency_hz(eigenvalues(modes[k] - 1), eigenvalues.cwiseAbs().maxCoeff());
  }
  return frequencies;
}

}  // namespace mottle::study
