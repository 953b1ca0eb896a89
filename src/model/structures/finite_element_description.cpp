// What `check` says of a finite-element model.
#include <fmt/format.h>

#include <map>

#include "mottle/core/text.hpp"
#include "mottle/fem/assembly/mass_properties.hpp"
#include "mottle/fem/elements/shell.hpp"
#include "mottle/fem/elements/solid.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"

namespace mottle {
namespace {

std::map<std::string, int> element_counts(const FiniteElementModel& model) {
  std::map<std::string, int> counts;
  for (const SolidElement& e : model.solids) {
    ++counts[e.shape == SolidShape::hexahedron8 ? "CHEXA" : e.shape == SolidShape::wedge6 ? "CPENTA" : "CTETRA"];
  }
  for (const ShellElement& e : model.shells) ++counts[e.node_count == 3 ? "CTRIA3" : "CQUAD4"];
  for (const BeamElement& e : model.beams) ++counts[e.card];
  counts["CROD, CONROD"] = static_cast<int>(model.rods.size());
  for (const ScalarElement& e : model.scalars) {
    ++counts[e.kind == ScalarElement::Kind::spring ? "CELAS" : e.kind == ScalarElement::Kind::mass ? "CMASS" : "CDAMP"];
  }
  counts["CBUSH"] = static_cast<int>(model.bushes.size());
  for (const PointMassElement& e : model.point_masses) ++counts[e.card];
  counts["RBE2"] = static_cast<int>(model.rigid_bodies.size());
  counts["RBE3"] = static_cast<int>(model.interpolations.size());
  counts["RBAR"] = static_cast<int>(model.rigid_bars.size());
  counts["MPC equations"] = static_cast<int>(model.multipoint_equations.size());
  std::erase_if(counts, [](const auto& count) { return count.second == 0; });
  return counts;
}

/// The element of a family whose form is farthest from ideal.
struct Worst {
  double jacobian_ratio = 2.0;
  int jacobian_id = 0;
  double aspect_ratio = 0.0;
  int aspect_id = 0;

  void add(int id, double jacobian, double aspect) {
    if (jacobian < jacobian_ratio) jacobian_ratio = jacobian, jacobian_id = id;
    if (aspect > aspect_ratio) aspect_ratio = aspect, aspect_id = id;
  }
  std::string text(const char* family) const {
    return fmt::format("worst {}: Jacobian ratio {:.3f} (element {}), aspect ratio {:.3g} (element {})", family,
                       jacobian_ratio, jacobian_id, aspect_ratio, aspect_id);
  }
};

std::vector<std::string> worst_shapes(const FiniteElementModel& model) {
  std::vector<std::string> lines;
  Worst solids;
  for (const SolidElement& e : model.solids) {
    Eigen::Matrix3Xd nodes(3, node_count(e.shape));
    for (Eigen::Index k = 0; k < nodes.cols(); ++k) {
      nodes.col(k) = model.nodes[static_cast<std::size_t>(e.nodes[static_cast<std::size_t>(k)])].position;
    }
    const SolidQuality quality = solid_quality(e.shape, nodes);
    solids.add(e.id, quality.jacobian_ratio, quality.aspect_ratio);
  }
  if (!model.solids.empty()) lines.push_back(solids.text("solids"));
  Worst shells;
  double warp = 0.0;
  for (const ShellElement& e : model.shells) {
    ShellInput input{.node_count = e.node_count};
    for (int k = 0; k < e.node_count; ++k) {
      input.nodes.col(k) = model.nodes[static_cast<std::size_t>(e.nodes[static_cast<std::size_t>(k)])].position;
    }
    const ShellQuality quality = shell_quality(input);
    shells.add(e.id, quality.jacobian_ratio, quality.aspect);
    warp = std::max(warp, quality.warp);
  }
  if (!model.shells.empty()) lines.push_back(fmt::format("{}, warp {:.3g}", shells.text("shells"), warp));
  return lines;
}

}  // namespace

std::vector<std::string> FiniteElementStructure::description(
    const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  std::vector<std::string> lines;
  std::vector<std::string> counts;
  for (const auto& [card, count] : element_counts(model_)) counts.push_back(fmt::format("{} {}", count, card));
  lines.push_back(fmt::format("model: {} grid points, {} equations, {} dependent degrees of freedom",
                              model_.nodes.size(), assembled_.equations.size(),
                              assembled_.dependent_degrees_of_freedom));
  lines.push_back(fmt::format("elements: {}", join(counts)));
  lines.push_back(fmt::format("AUTOSPC: {} degrees of freedom without stiffness are held",
                              assembled_.automatic_constraints.size()));
  const MassProperties weight = mass_properties(model_at(model_, targets_, parameters));
  lines.push_back(fmt::format("mass: {:.6g} along x, {:.6g} along y, {:.6g} along z", weight.mass.x(), weight.mass.y(),
                              weight.mass.z()));
  lines.push_back(fmt::format("centre of gravity: {:.6g}, {:.6g}, {:.6g}", weight.center.x(), weight.center.y(),
                              weight.center.z()));
  lines.push_back(
      fmt::format("inertia about it: Ixx {:.6g}, Iyy {:.6g}, Izz {:.6g}, Ixy {:.6g}, Iyz {:.6g}, Izx {:.6g}",
                  weight.inertia(0, 0), weight.inertia(1, 1), weight.inertia(2, 2), 0.0 - weight.inertia(0, 1),
                  0.0 - weight.inertia(1, 2), 0.0 - weight.inertia(2, 0)));
  for (std::string& line : worst_shapes(model_)) lines.push_back(std::move(line));
  return lines;
}

}  // namespace mottle
