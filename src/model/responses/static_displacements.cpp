#include "model/responses/static_displacements.hpp"

#include "mottle/core/subject.hpp"

namespace mottle::model {
namespace {

/// "static.2.forces" of the second load.
Subject subject_of(std::size_t load, const char* part) {
  return {Subject::Kind::outputs, fmt::format("static.{}{}", load + 1, part)};
}

std::vector<int> find_movable(const Structure& structure, const std::vector<std::string>& names,
                              const Subject& subject) {
  std::vector<int> numbers = find_degrees_of_freedom(structure, names, subject);
  const ObservationMatrix observation = structure.observation(numbers);
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const ObservationMatrix::InnerIterator first(observation, static_cast<Eigen::Index>(k));
    require_of(static_cast<bool>(first), subject, "'{}' is fixed: it does not move, and a force on it moves nothing",
               names[k]);
  }
  return numbers;
}

/// f of one load [equation].
Eigen::VectorXd force_vector(const Structure& structure, const StaticLoad& load, const Subject& subject) {
  std::vector<std::string> names;
  Eigen::VectorXd values(static_cast<Eigen::Index>(load.forces.size()));
  for (const auto& [name, value] : load.forces) {
    values(static_cast<Eigen::Index>(names.size())) = value;
    names.push_back(name);
  }
  require_of((values.array() != 0.0).any(), subject,
             "the load has no force that is not 0; give for example forces = {{ \"101:+Z\" = -100.0 }}");
  Eigen::VectorXd force = structure.observation(find_movable(structure, names, subject)).transpose() * values;
  require_of(!force.isZero(0.0), subject, "the forces cancel one another: they move nothing");
  return force;
}

}  // namespace

StaticDisplacements::StaticDisplacements(const std::vector<StaticLoad>& loads, const UnitNames& units,
                                         const Structure& structure) {
  require_of(
      structure.has_stiffness(), {Subject::Kind::outputs, "static"},
      "the model's modes come from runs of a program, which leave no stiffness matrix to put loads on (a CalculiX "
      "deck has one where its parameters are such that the matrices can be fitted)");
  for (std::size_t number = 0; number < loads.size(); ++number) {
    const StaticLoad& load = loads[number];
    const Eigen::VectorXd force = force_vector(structure, load, subject_of(number, ".forces"));
    loads_.conservativeResize(force.size(), loads_.cols() + 1);
    loads_.rightCols(1) = force;
    const std::vector<int> numbers = find_movable(structure, load.degrees_of_freedom, subject_of(number, ".dofs"));
    degrees_of_freedom_.insert(degrees_of_freedom_.end(), numbers.begin(), numbers.end());
    for (const std::string& name : load.degrees_of_freedom) {
      const bool is_turn = is_rotation(name);
      quantities_.push_back({.kind = is_turn ? QuantityKind::static_rotation : QuantityKind::static_displacement,
                             .number = static_cast<int>(loads_.cols()),
                             .location = name,
                             .unit = is_turn ? "rad" : units.length});
    }
  }
}

std::string StaticDisplacements::fill(const NumberedSolution& solution, Row row) const {
  for (Eigen::Index k = 0; k < row.size(); ++k) {
    row(k) = solution.static_displacement(quantities_[static_cast<std::size_t>(k)].number - 1, k);
  }
  return {};
}

Eigen::MatrixXd StaticDisplacements::derivatives(const SolvedPoint& point) const {
  const ObservationMatrix observation = point.solver.structure().observation(degrees_of_freedom_);
  const std::vector<Eigen::MatrixXd> moved = point.solver.static_derivatives(point.parameters, loads_, observation);
  Eigen::MatrixXd derivatives(observation.rows(), point.parameters.size());
  for (Eigen::Index row = 0; row < derivatives.rows(); ++row) {
    const int load = quantities_[static_cast<std::size_t>(row)].number - 1;
    derivatives.row(row) = moved[static_cast<std::size_t>(load)].row(row);
  }
  return derivatives;
}

}  // namespace mottle::model
