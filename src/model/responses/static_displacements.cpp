#include "model/responses/static_displacements.hpp"

#include "mottle/core/subject.hpp"

namespace mottle::model {
namespace {

const Subject k_subject{Subject::Kind::outputs, "static"};

std::vector<int> find_movable(const Structure& structure, const std::vector<std::string>& names) {
  const std::vector<int> numbers = find_degrees_of_freedom(structure, names, k_subject);
  const ObservationMatrix observation = structure.observation(numbers);
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const ObservationMatrix::InnerIterator first(observation, static_cast<Eigen::Index>(k));
    require_of(static_cast<bool>(first), k_subject, "'{}' is fixed: it does not move, and a force on it moves nothing",
               names[k]);
  }
  return numbers;
}

/// f of one load [equation].
Eigen::VectorXd force_vector(const Structure& structure, const StaticLoad& load) {
  std::vector<std::string> names;
  Eigen::VectorXd values(static_cast<Eigen::Index>(load.forces.size()));
  for (const auto& [name, value] : load.forces) {
    values(static_cast<Eigen::Index>(names.size())) = value;
    names.push_back(name);
  }
  require_of((values.array() != 0.0).any(), k_subject,
             "a load has no force that is not 0; give for example forces = {{ \"101:+Z\" = -100.0 }}");
  return structure.observation(find_movable(structure, names)).transpose() * values;
}

}  // namespace

StaticDisplacements::StaticDisplacements(const std::vector<StaticLoad>& loads, const UnitNames& units,
                                         const Structure& structure) {
  require_of(structure.has_stiffness(), k_subject,
             "the model is a program's modes, without a stiffness matrix to put loads on; a model of kind nastran, "
             "calculix, matrices or mass-spring has one");
  for (const StaticLoad& load : loads) {
    const Eigen::VectorXd force = force_vector(structure, load);
    loads_.conservativeResize(force.size(), loads_.cols() + 1);
    loads_.rightCols(1) = force;
    const std::vector<int> numbers = find_movable(structure, load.degrees_of_freedom);
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
  Eigen::MatrixXd derivatives(observation.rows(), point.parameters.size());
  Eigen::Index row = 0;
  for (Eigen::Index load = 0; load < loads_.cols(); ++load) {
    const Eigen::MatrixXd moved = observation * point.solver.static_derivatives(point.parameters, loads_.col(load));
    for (; row < moved.rows() && quantities_[static_cast<std::size_t>(row)].number == load + 1; ++row) {
      derivatives.row(row) = moved.row(row);
    }
  }
  return derivatives;
}

}  // namespace mottle::model
