// The mean measured shape of a mode over that of the model.
#include <cmath>
#include <map>

#include "mottle/fem/finite_element_model.hpp"
#include "study/results/modes_json.hpp"
#include "study/results/shape_correlation.hpp"
#include "study/tests/pair_modes.hpp"
#include "study/tests/specimen_pairing.hpp"

namespace mottle::study {
namespace {

/// Differences of the scaled measured shapes from the model's, summed over specimens.
struct Differences {
  std::map<int, Eigen::Vector3d> of_node;  // index into the mesh's nodes
  int specimens = 0;
};

/// Where a component was measured: node and global direction; a node of -1: a rotation, or not in the model.
std::pair<int, Eigen::Vector3d> place_of(const FiniteElementModel& mesh, const MeasuredComponent& component,
                                         const LinearCombination& terms) {
  std::pair<int, Eigen::Vector3d> nowhere{-1, Eigen::Vector3d::Zero()};
  if (terms.empty() || component.is_rotation) return nowhere;
  if (component.name.empty()) return {mesh.find_node(component.node), component.direction};
  const int node = terms.front().first / 6;
  const int axis = terms.front().first % 6;
  if (axis > 2) return nowhere;
  const Node& point = mesh.nodes[static_cast<std::size_t>(node)];
  Eigen::Vector3d direction = terms.front().second * Eigen::Vector3d::Unit(axis);
  if (point.displacement_system >= 0) {
    direction =
        mesh.coordinate_systems[static_cast<std::size_t>(point.displacement_system)].directions_at(point.position) *
        direction;
  }
  return {node, direction};
}

void add_differences(const FiniteElementModel& mesh, const ShapeComparison& comparison, const MeasuredModes& modes,
                     Eigen::Index test, int mode, Differences& differences) {
  double product = 0.0;
  double square = 0.0;
  std::vector<Eigen::Index> rows;
  for (Eigen::Index k = 0; k < modes.shapes.rows(); ++k) {
    if (comparison.terms[static_cast<std::size_t>(k)].empty() || std::isnan(modes.shapes(k, test))) continue;
    rows.push_back(k);
    product += modes.shapes(k, test) * comparison.reference(k, mode);
    square += modes.shapes(k, test) * modes.shapes(k, test);
  }
  if (!(square > 0.0)) return;
  ++differences.specimens;
  for (const Eigen::Index k : rows) {
    const auto index = static_cast<std::size_t>(k);
    const auto [node, direction] = place_of(mesh, modes.components[index], comparison.terms[index]);
    if (node < 0) continue;
    const double difference = product / square * modes.shapes(k, test) - comparison.reference(k, mode);
    differences.of_node.try_emplace(node, Eigen::Vector3d::Zero()).first->second += difference * direction;
  }
}

}  // namespace

MeasuredShape measured_shape(const StructureModel& model, const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                             const std::vector<PairedSpecimen>& specimens, int mode) {
  const FiniteElementModel& mesh = *model.structure().mesh();
  Differences differences;
  for (const PairedSpecimen& specimen : specimens) {
    const auto pair = specimen.assigned.find(mode);
    if (pair == specimen.assigned.end() || !specimen.modes.has_shape(pair->second)) continue;
    add_differences(mesh, compare_shapes(model, shapes, specimen.modes), specimen.modes, pair->second, mode,
                    differences);
  }
  MeasuredShape measured;
  if (differences.specimens == 0) return measured;
  const Eigen::MatrixX3d own = node_displacements(model.structure(), shapes.col(mode));
  measured.displacements.resize(static_cast<Eigen::Index>(differences.of_node.size()), 3);
  for (const auto& [node, sum] : differences.of_node) {
    measured.displacements.row(static_cast<Eigen::Index>(measured.nodes.size())) =
        own.row(node) + sum.transpose() / static_cast<double>(differences.specimens);
    measured.nodes.push_back(node);
  }
  return measured;
}

}  // namespace mottle::study
