#include "mottle/model/structures/dense_structure.hpp"

#include <algorithm>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle::model {

bool DenseStructure::is_damped() const {
  return !matrices_.damping.terms.empty() || !matrices_.damping.constant.isZero(0.0);
}

int DenseStructure::find_degree_of_freedom(const std::string& name) const {
  const std::vector<std::string>& names = matrices_.degree_of_freedom_names;
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

std::string DenseStructure::unknown_degree_of_freedom(const std::string& name) const {
  if (name.empty()) return fmt::format("none is named, known: {}", join(matrices_.degree_of_freedom_names));
  return unknown_name_message("degree of freedom", name, matrices_.degree_of_freedom_names);
}

double DenseStructure::total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  return matrices_.mass.at(parameters).trace();
}

std::vector<std::string> DenseStructure::description(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  return {fmt::format("model: {} degrees of freedom, total mass {:.6g}", mode_count(), total_mass(parameters))};
}

}  // namespace mottle::model
