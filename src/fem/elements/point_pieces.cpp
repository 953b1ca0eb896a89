#include "fem/elements/point_pieces.hpp"

#include <fmt/format.h>

#include "fem/assembly/constraint_equations.hpp"
#include "fem/assembly/rigid_motion.hpp"

namespace mottle {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

void place(int node, ElementPieces& result) {
  for (int c = 0; c < 6; ++c) result.degrees_of_freedom.push_back(degree_of_freedom(node, c));
}

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

}  // namespace

std::string scalar_name(const ScalarElement& element) {
  static constexpr const char* k_names[] = {"CELAS", "CMASS", "CDAMP"};
  return fmt::format("{} {}", k_names[static_cast<std::size_t>(element.kind)], element.id);
}

void add_scalar(const FiniteElementModel& model, const ScalarElement& element, PieceSelection selection,
                ElementPieces& result) {
  static constexpr ElementPiece::Kind k_kinds[] = {ElementPiece::Kind::stiffness, ElementPiece::Kind::mass,
                                                   ElementPiece::Kind::damping};
  const ElementPiece::Kind kind = k_kinds[static_cast<std::size_t>(element.kind)];
  if (selection == PieceSelection::mass && kind != ElementPiece::Kind::mass) return;
  if (element.value == k_no_field) return;  // blank is zero
  result.is_basic = false;
  for (std::size_t end = 0; end < 2; ++end) {
    if (element.nodes[end] >= 0) {
      result.degrees_of_freedom.push_back(degree_of_freedom(element.nodes[end], element.components[end]));
    }
  }
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Ones(1, 1);
  if (result.degrees_of_freedom.size() == 2) {
    matrix.resize(2, 2);
    matrix << 1.0, -1.0, -1.0, 1.0;
  }
  const double factor = kind == ElementPiece::Kind::mass ? model.settings.mass_factor : 1.0;
  result.pieces.push_back({kind, factor, {{element.value, 1}}, {}, matrix});
}

void add_bush(const FiniteElementModel& model, const BushElement& element, PieceSelection selection,
              ElementPieces& result) {
  if (selection == PieceSelection::mass) return;
  const auto arm = [&](int node) {
    return Eigen::Vector3d(element.location - model.nodes[static_cast<std::size_t>(node)].position);
  };
  place(element.nodes[0], result);
  Eigen::MatrixXd motion = -rigid_motion(element.axes, arm(element.nodes[0]));
  if (element.nodes[1] >= 0) {
    place(element.nodes[1], result);
    motion.conservativeResize(6, 12);
    motion.rightCols(6) = rigid_motion(element.axes, arm(element.nodes[1]));
  }
  for (Eigen::Index c = 0; c < 6; ++c) {
    const auto k = static_cast<std::size_t>(c);
    const Eigen::MatrixXd matrix = motion.row(c).transpose() * motion.row(c);
    if (element.stiffness[k] != k_no_field) {
      result.pieces.push_back({ElementPiece::Kind::stiffness, 1.0, {{element.stiffness[k], 1}}, {}, matrix});
    }
    if (element.damping[k] != k_no_field) {
      result.pieces.push_back({ElementPiece::Kind::damping, 1.0, {{element.damping[k], 1}}, {}, matrix});
    }
  }
}

void add_point_mass(const FiniteElementModel& model, const PointMassElement& element, ElementPieces& result) {
  place(element.node, result);
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

}  // namespace mottle
