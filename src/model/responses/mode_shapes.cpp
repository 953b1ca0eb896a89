#include "model/responses/mode_shapes.hpp"

#include "mottle/core/subject.hpp"

namespace mottle::model {

ModeShapes::ModeShapes(std::vector<int> modes, std::vector<std::string> degrees_of_freedom, std::string unit,
                       const Structure& structure)
    : modes_(std::move(modes)),
      names_(std::move(degrees_of_freedom)),
      degrees_of_freedom_(find_degrees_of_freedom(structure, names_, {Subject::Kind::shape_locations})),
      unit_(std::move(unit)) {}

std::vector<Quantity> ModeShapes::quantities() const {
  std::vector<Quantity> quantities;
  for (const int mode : modes_) {
    for (const std::string& name : names_) {
      const QuantityKind kind = is_rotation(name) ? QuantityKind::rotation : QuantityKind::displacement;
      quantities.push_back(shape_component(mode, name, kind, unit_));
    }
  }
  return quantities;
}

std::string ModeShapes::fill(const NumberedSolution& solution, Row row) const {
  Eigen::Index k = 0;
  for (const int mode : modes_) {
    for (Eigen::Index d = 0; d < solution.degrees_of_freedom(); ++d) row(k++) = solution.displacement(mode, d);
  }
  return {};
}

Eigen::VectorXd ModeShapes::values(const SolvedPoint& point) const {
  const Eigen::MatrixXd shapes = point.solver.structure().displacements(point.modes.shapes, degrees_of_freedom_);
  Eigen::VectorXd values(shapes.rows() * static_cast<Eigen::Index>(modes_.size()));
  Eigen::Index first = 0;
  for (const int mode : modes_) {
    values.segment(first, shapes.rows()) =
        point.match.sign[static_cast<std::size_t>(mode - 1)] * shapes.col(point.column(mode));
    first += shapes.rows();
  }
  return values;
}

Eigen::MatrixXd ModeShapes::derivatives(const SolvedPoint& point) const {
  const auto rows = static_cast<Eigen::Index>(degrees_of_freedom_.size());
  Eigen::MatrixXd derivatives(rows * static_cast<Eigen::Index>(modes_.size()), point.parameters.size());
  Eigen::Index first = 0;
  for (const int mode : modes_) {
    const Eigen::MatrixXd shape = point.solver.shape_derivatives(point.parameters, point.modes, point.column(mode));
    derivatives.middleRows(first, rows) = point.match.sign[static_cast<std::size_t>(mode - 1)] *
                                          point.solver.structure().displacements(shape, degrees_of_freedom_);
    first += rows;
  }
  return derivatives;
}

}  // namespace mottle::model
