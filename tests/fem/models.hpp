// Finite-element models put together by hand for the tests of assembly, constraints and whole structures.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "mottle/fem/assembly/assembly.hpp"
#include "mottle/fem/finite_element_model.hpp"

namespace mottle::test {

using namespace fem;  // of which these are the tests

/// A model that grows card by card; ids of nodes must ascend.
struct ModelMaker {
  FiniteElementModel model;

  FieldIndex field(const std::string& card, int id, const std::string& name, double value) {
    model.fields.push_back({card, id, name, value});
    return static_cast<FieldIndex>(model.fields.size()) - 1;
  }
  int node(int id, const Eigen::Vector3d& position, int system = -1) {
    model.nodes.push_back({id, position, system, false});
    return static_cast<int>(model.nodes.size()) - 1;
  }
  int scalar_point(int id) {
    model.nodes.push_back({.id = id, .is_scalar = true});
    return static_cast<int>(model.nodes.size()) - 1;
  }
  int material(int id, double young, double poisson, double density) {
    model.materials.push_back({id, field("MAT1", id, "E", young), k_no_field, field("MAT1", id, "NU", poisson),
                               field("MAT1", id, "RHO", density)});
    return static_cast<int>(model.materials.size()) - 1;
  }
  int shell_property(int id, int material, double thickness) {
    model.shell_properties.push_back({.id = id,
                                      .membrane_material = material,
                                      .bending_material = material,
                                      .shear_material = material,
                                      .thickness = field("PSHELL", id, "T", thickness)});
    return static_cast<int>(model.shell_properties.size()) - 1;
  }
  int beam_property(int id, int material, double area, double inertia_1, double inertia_2, double torsion) {
    BeamProperty property;
    property.card = "PBAR";
    property.id = id;
    property.material = material;
    property.area = field("PBAR", id, "A", area);
    property.inertia_1 = field("PBAR", id, "I1", inertia_1);
    property.inertia_2 = field("PBAR", id, "I2", inertia_2);
    property.torsion = field("PBAR", id, "J", torsion);
    model.beam_properties.push_back(property);
    return static_cast<int>(model.beam_properties.size()) - 1;
  }
  void beam(int id, int a, int b, int property, const Eigen::Vector3d& orientation = Eigen::Vector3d::UnitY()) {
    model.elements<BeamElement>().push_back(
        {.card = "CBAR", .id = id, .nodes = {a, b}, .property = property, .orientation = orientation});
  }
  void rod(int id, int a, int b, int material, FieldIndex area) {
    model.elements<RodElement>().push_back({.id = id, .nodes = {a, b}, .material = material, .area = area});
  }
  /// A spring (or mass) with a number of its own; b = -1: to ground.
  void spring(int id, int a, int component_a, int b, int component_b, double stiffness) {
    model.elements<ScalarElement>().push_back(
        {ScalarElement::Kind::spring, id, {a, b}, {component_a, component_b}, field("CELAS2", id, "K", stiffness)});
  }
  void mass(int id, int a, int component, double mass) {
    model.elements<ScalarElement>().push_back(
        {ScalarElement::Kind::mass, id, {a, -1}, {component, 0}, field("CMASS2", id, "M", mass)});
  }
  PointMassElement& point_mass(int id, int at, double mass) {
    model.elements<PointMassElement>().push_back(
        {.card = "CONM2", .id = id, .node = at, .mass = field("CONM2", id, "M", mass)});
    return model.elements<PointMassElement>().back();
  }
};

inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  return (Eigen::Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}

/// Components of all nodes, each in its displacement system, for unit rigid motions about the basic origin:
/// [6 node + component x 6].
inline Eigen::MatrixXd rigid_motions(const FiniteElementModel& model) {
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(6 * model.nodes.size()), 6);
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    const Node& node = model.nodes[n];
    const auto row = static_cast<Eigen::Index>(6 * n);
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    if (node.displacement_system >= 0) {
      axes = model.coordinate_systems[static_cast<std::size_t>(node.displacement_system)].directions_at(node.position);
    }
    motions.block<3, 3>(row, 0) = axes.transpose();
    motions.block<3, 3>(row, 3) = -axes.transpose() * cross_matrix(node.position);
    motions.block<3, 3>(row + 3, 3) = axes.transpose();
  }
  return motions;
}

/// Rows of the equations of an assembled model out of rows of all slots.
inline Eigen::MatrixXd at_equations(const AssembledModel& assembled, const Eigen::MatrixXd& slots) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(assembled.equations.size()), slots.cols());
  for (Eigen::Index k = 0; k < rows.rows(); ++k) {
    const Equation& equation = assembled.equations[static_cast<std::size_t>(k)];
    rows.row(k) = slots.row(6 * equation.node + equation.component);
  }
  return rows;
}

/// A whole symmetric matrix from its lower triangle.
inline Eigen::MatrixXd dense(const SparseMatrix& lower) {
  return Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
}

/// Largest entry of a - b against the geometric mean of a's diagonal entries: small terms count as much as large ones.
inline double scaled_difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  if (a.rows() != b.rows()) return HUGE_VAL;
  double largest = 0.0;
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    for (Eigen::Index j = 0; j < a.cols(); ++j) {
      const double scale = std::sqrt(std::abs(a(i, i) * a(j, j)));
      const double difference = std::abs(a(i, j) - b(i, j));
      if (difference > 0.0) largest = std::max(largest, difference / scale);
    }
  }
  return largest;
}

/// The model with its fields at what the parameters say.
inline FiniteElementModel moved(FiniteElementModel model, const std::vector<FieldParameter>& parameters,
                                const Eigen::VectorXd& x) {
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    for (const FieldIndex field : parameters[p].fields) {
      double& value = model.fields[static_cast<std::size_t>(field)].value;
      value = x(static_cast<Eigen::Index>(p)) * (parameters[p].is_factor ? value : 1.0);
    }
  }
  return model;
}

/// The field of a card by name; the model has it.
inline FieldIndex field_of(const FiniteElementModel& model, const std::string& card, int id, const std::string& name) {
  for (std::size_t k = 0; k < model.fields.size(); ++k) {
    const CardField& field = model.fields[k];
    if (field.card == card && field.id == id && field.name == name) return static_cast<FieldIndex>(k);
  }
  return k_no_field;
}

}  // namespace mottle::test
