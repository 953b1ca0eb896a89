#include "mottle/fem/elements/point_mass_element.hpp"

#include "fem/assembly/rigid_motion.hpp"
#include "fem/elements/element_pieces.hpp"
#include "mottle/fem/finite_element_model.hpp"

namespace mottle::fem {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// The two entries of a symmetric 6 x 6 matrix, or the one on its diagonal.
Eigen::MatrixXd unit_entry(const Matrix6& motion, int row, int column) {
  Matrix6 unit = Matrix6::Zero();
  unit(row, column) = unit(column, row) = 1.0;
  const Matrix6 moved = motion.transpose() * unit * motion;
  return 0.5 * (moved + moved.transpose());
}

void add_inertia(const FiniteElementModel& model, const PointMassElement& element, const Matrix6& at_center,
                 ElementPieces& result) {
  static constexpr int k_entries[6][2] = {{0, 0}, {1, 0}, {1, 1}, {2, 0}, {2, 1}, {2, 2}};
  for (std::size_t k = 0; k < 6; ++k) {
    if (element.inertia[k] == k_no_field) continue;
    // The products of inertia stand in the matrix with a minus sign.
    const double sign = k_entries[k][0] == k_entries[k][1] ? 1.0 : -1.0;
    result.pieces.push_back({ElementPiece::Kind::mass,
                             sign * model.settings.mass_factor,
                             {{element.inertia[k], 1}},
                             {},
                             unit_entry(at_center, 3 + k_entries[k][0], 3 + k_entries[k][1])});
  }
}

void add_point_mass(const FiniteElementModel& model, const PointMassElement& element, PieceSelection,
                    ElementPieces& result) {
  add_six_degrees_of_freedom(element.node, result);
  const double weigh = model.settings.mass_factor;
  if (!element.matrix.empty()) {
    const Matrix6 motion = rigid_motion(element.axes, Eigen::Vector3d::Zero());
    std::size_t entry = 0;
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column <= row; ++column, ++entry) {
        if (element.matrix[entry] == k_no_field) continue;
        result.pieces.push_back(
            {ElementPiece::Kind::mass, weigh, {{element.matrix[entry], 1}}, {}, unit_entry(motion, row, column)});
      }
    }
    return;
  }
  const Matrix6 at_center = rigid_motion(element.axes, element.axes * element.offset);
  if (element.mass != k_no_field) {
    const Eigen::MatrixXd translations = at_center.topRows<3>().transpose() * at_center.topRows<3>();
    result.pieces.push_back({ElementPiece::Kind::mass, weigh, {{element.mass, 1}}, {}, translations});
  }
  add_inertia(model, element, at_center, result);
}

const Topology& topology_of(const PointMassElement&) {
  static const Topology k_point = {.points = {0}};
  return k_point;
}

}  // namespace

const ElementTraits<PointMassElement> PointMassElement::k_traits = {
    .card = [](const PointMassElement& element) -> std::string_view { return element.card; },
    .nodes = [](const PointMassElement& element) { return std::span<const int>(&element.node, 1); },
    .topology = topology_of,
    .add_pieces = add_point_mass,
    .geometry = {.cards = {"CONM2"},
                 .names = {"X1", "X2", "X3"},
                 .at = [](PointMassElement& element, int number) -> double& { return element.offset(number); }}};

}  // namespace mottle::fem
