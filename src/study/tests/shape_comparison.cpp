#include "study/tests/shape_comparison.hpp"

#include <fmt/format.h>

#include <cmath>

#include "mottle/dynamics/modes/mac.hpp"
#include "mottle/fem/finite_element_model.hpp"

namespace mottle::study {
namespace {

/// Directions of the model's components at a node, which the file gives in the global frame.
Eigen::Matrix3d model_directions(const StructureModel& model, int node) {
  const FiniteElementModel* mesh = model.structure().mesh();
  const int index = mesh == nullptr ? -1 : mesh->find_node(node);
  if (index < 0) return Eigen::Matrix3d::Identity();
  const Node& point = mesh->nodes[static_cast<std::size_t>(index)];
  if (point.displacement_system < 0) return Eigen::Matrix3d::Identity();
  return mesh->coordinate_systems[static_cast<std::size_t>(point.displacement_system)].directions_at(point.position);
}

LinearCombination terms_of(const StructureModel& model, const MeasuredComponent& component) {
  constexpr double k_rounding = 1e-5;  // of axes written with six digits
  LinearCombination terms;
  if (!component.name.empty()) {
    const int slot = model.structure().find_degree_of_freedom(component.name);
    if (slot >= 0) terms.emplace_back(slot, component.sign);
    return terms;
  }
  const Eigen::Vector3d weights = model_directions(model, component.node).transpose() * component.direction;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(weights(axis)) < k_rounding) continue;
    const int slot = model.structure().find_degree_of_freedom(
        fmt::format("{}:+{}{}", component.node, component.is_rotation ? "R" : "", "XYZ"[axis]));
    if (slot < 0) return {};
    terms.emplace_back(slot, weights(axis));
  }
  return terms;
}

}  // namespace

std::vector<Eigen::Index> ShapeComparison::measured_rows(const MeasuredModes& modes, Eigen::Index mode) const {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index k = 0; k < modes.shapes.rows(); ++k) {
    if (!terms[static_cast<std::size_t>(k)].empty() && !std::isnan(modes.shapes(k, mode))) rows.push_back(k);
  }
  return rows;
}

ShapeComparison compare_shapes(const StructureModel& model, const MeasuredModes& modes) {
  return compare_shapes(model, model.reference_modes().shapes, modes);
}

ShapeComparison compare_shapes(const StructureModel& model, const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                               const MeasuredModes& modes) {
  ShapeComparison comparison;
  comparison.reference = Eigen::MatrixXd::Zero(modes.shapes.rows(), shapes.cols());
  for (Eigen::Index k = 0; k < modes.shapes.rows(); ++k) {
    comparison.terms.push_back(terms_of(model, modes.components[static_cast<std::size_t>(k)]));
    comparison.seen += comparison.terms.back().empty() ? 0 : 1;
    for (const auto& [slot, weight] : comparison.terms.back()) {
      comparison.reference.row(k) += weight * model.structure().displacements(shapes, {slot});
    }
  }
  comparison.cosines.resize(shapes.cols(), modes.shapes.cols());
  for (Eigen::Index t = 0; t < modes.shapes.cols(); ++t) {
    const std::vector<Eigen::Index> rows = comparison.measured_rows(modes, t);
    comparison.cosines.col(t) = shape_cosines(comparison.reference(rows, Eigen::all), modes.shapes(rows, t));
  }
  return comparison;
}

}  // namespace mottle::study
