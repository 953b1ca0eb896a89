#include "mottle/fem/assembly/mass_spring.hpp"

#include <cmath>
#include <set>

#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

void require_new_name(const std::string& kind, const std::string& name, std::set<std::string>& known) {
  require(!name.empty(), "{}: a name is missing", kind);
  require(known.insert(name).second, "{} '{}': the name is used twice", kind, name);
}

void validate_connectors(const std::vector<Connector>& connectors, const std::string& kind, int masses) {
  std::set<std::string> names;
  for (const Connector& connector : connectors) {
    require_new_name(kind, connector.name, names);
    const auto is_end = [masses](int index) { return k_ground <= index && index < masses; };
    require(is_end(connector.first) && is_end(connector.second), "{} '{}': it ends on a mass that is not there", kind,
            connector.name);
    require(connector.first != connector.second, "{} '{}': both ends are on the same point, so it acts on nothing",
            kind, connector.name);
    require(std::isfinite(connector.value) && connector.value >= 0.0,
            "{} '{}': {} is not allowed, a value >= 0 is needed", kind, connector.name, connector.value);
  }
}

}  // namespace

void MassSpringSystem::validate() const {
  require(!masses.empty(), "masses: there is none, at least one is needed");
  std::set<std::string> names{"ground"};
  for (const PointMass& point : masses) {
    require(point.name != "ground", "mass 'ground': the name stands for the fixed point, choose another");
    require_new_name("mass", point.name, names);
    require(std::isfinite(point.mass) && point.mass > 0.0, "mass '{}': {} is not allowed, a value > 0 is needed",
            point.name, point.mass);
  }
  validate_connectors(springs, "spring", static_cast<int>(masses.size()));
  validate_connectors(dampers, "damper", static_cast<int>(masses.size()));
}

Eigen::MatrixXd unit_connector_matrix(const Connector& connector, Eigen::Index degrees_of_freedom) {
  Eigen::VectorXd elongation = Eigen::VectorXd::Zero(degrees_of_freedom);
  if (connector.first != k_ground) elongation(connector.first) += 1.0;
  if (connector.second != k_ground) elongation(connector.second) -= 1.0;
  return elongation * elongation.transpose();
}

Eigen::MatrixXd unit_mass_matrix(Eigen::Index index, Eigen::Index degrees_of_freedom) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(degrees_of_freedom, degrees_of_freedom);
  matrix(index, index) = 1.0;
  return matrix;
}

}  // namespace mottle::fem
