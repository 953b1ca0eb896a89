#include "mottle/model/structures/affine_matrices.hpp"

#include <algorithm>
#include <map>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"

namespace mottle::model {
namespace {

/// One element of the system as a parameter sees it.
struct Element {
  double nominal = 0.0;
  AffineMatrix* destination = nullptr;
  Eigen::MatrixXd unit_matrix;
};

/// Elements by "kind:name".
std::map<std::string, Element> list_elements(const MassSpringSystem& system, AffineStructure& structure) {
  const auto n = static_cast<Eigen::Index>(system.masses.size());
  std::map<std::string, Element> elements;
  for (Eigen::Index i = 0; i < n; ++i) {
    const PointMass& point = system.masses[static_cast<std::size_t>(i)];
    elements["mass:" + point.name] = {point.mass, &structure.mass, unit_mass_matrix(i, n)};
  }
  for (const Connector& spring : system.springs) {
    elements["spring:" + spring.name] = {spring.value, &structure.stiffness, unit_connector_matrix(spring, n)};
  }
  for (const Connector& damper : system.dampers) {
    elements["damper:" + damper.name] = {damper.value, &structure.damping, unit_connector_matrix(damper, n)};
  }
  return elements;
}

Element& find_element(std::map<std::string, Element>& elements, const std::string& parameter,
                      const std::string& target) {
  const auto found = elements.find(target);
  if (found != elements.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [name, element] : elements) known.push_back(name);
  throw SubjectError(subject_parameter(parameter),
                     "it acts on nothing: " + unknown_name_message("target", target, known));
}

void add_term(AffineMatrix& destination, Eigen::Index parameter, const Eigen::MatrixXd& matrix) {
  for (AffineMatrix::Term& term : destination.terms) {
    if (term.parameter == parameter) {
      term.matrix += matrix;
      return;
    }
  }
  destination.terms.push_back({parameter, matrix});
}

}  // namespace

Eigen::MatrixXd AffineMatrix::at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  Eigen::MatrixXd sum = constant;
  for (const Term& term : terms) sum += parameters(term.parameter) * term.matrix;
  return sum;
}

Eigen::MatrixXd AffineMatrix::derivative(Eigen::Index parameter) const {
  for (const Term& term : terms) {
    if (term.parameter == parameter) return term.matrix;
  }
  return Eigen::MatrixXd::Zero(constant.rows(), constant.cols());
}

AffineStructure separate(const MassSpringSystem& system, const std::vector<ParameterTargets>& parameters) {
  system.validate();
  const auto n = static_cast<Eigen::Index>(system.masses.size());
  AffineStructure structure;
  for (AffineMatrix* matrix : {&structure.stiffness, &structure.mass, &structure.damping}) {
    matrix->constant = Eigen::MatrixXd::Zero(n, n);
  }
  for (const PointMass& point : system.masses) structure.degree_of_freedom_names.push_back(point.name);

  std::map<std::string, Element> elements = list_elements(system, structure);
  std::map<std::string, std::string> owner;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const ParameterTargets& parameter = parameters[i];
    const Subject subject = subject_parameter(parameter.parameter);
    require_of(!parameter.targets.empty(), subject, "it has no target, so it acts on nothing");
    for (const std::string& target : parameter.targets) {
      const Element& element = find_element(elements, parameter.parameter, target);
      const auto [previous, is_new] = owner.emplace(target, parameter.parameter);
      require_of(is_new, subject, "target '{}' is already tied to parameter '{}'", target, previous->second);
      require_of(!parameter.is_factor || element.nominal != 0.0, subject,
                 "a factor on '{}', whose nominal value is 0, acts on nothing", target);
      const double factor = parameter.is_factor ? element.nominal : 1.0;
      add_term(*element.destination, static_cast<Eigen::Index>(i), factor * element.unit_matrix);
    }
  }
  for (const auto& [name, element] : elements) {
    if (!owner.contains(name)) element.destination->constant += element.nominal * element.unit_matrix;
  }
  return structure;
}

}  // namespace mottle::model
