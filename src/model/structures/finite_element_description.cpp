// Description of a finite-element model for `check`.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>

#include "mottle/core/text.hpp"
#include "mottle/fem/assembly/mass_properties.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"

namespace mottle::model {
namespace {

std::map<std::string, int> element_counts(const FiniteElementModel& model) {
  std::map<std::string, int> counts;
  for_each_list(model.element_lists, [&](const auto& list) {
    const auto& traits = traits_of(list);
    for (const auto& element : list) {
      ++counts[traits.counted_as != nullptr ? traits.counted_as : std::string(traits.card(element))];
    }
  });
  counts["RBE2"] = static_cast<int>(model.rigid_bodies.size());
  counts["RBE3"] = static_cast<int>(model.interpolations.size());
  counts["RBAR"] = static_cast<int>(model.rigid_bars.size());
  counts["MPC equations"] = static_cast<int>(model.multipoint_equations.size());
  std::erase_if(counts, [](const auto& count) { return count.second == 0; });
  return counts;
}

/// The elements of a family whose form is farthest from ideal.
struct WorstShape {
  double jacobian_ratio = 2.0;
  int jacobian_id = 0;
  double aspect_ratio = 0.0;
  int aspect_id = 0;
  std::optional<double> warp;

  void add(int id, const ElementQuality& quality) {
    if (quality.jacobian_ratio < jacobian_ratio) jacobian_ratio = quality.jacobian_ratio, jacobian_id = id;
    if (quality.aspect_ratio > aspect_ratio) aspect_ratio = quality.aspect_ratio, aspect_id = id;
    if (quality.warp) warp = std::max(warp.value_or(0.0), *quality.warp);
  }
  std::string text(const char* family) const {
    return fmt::format("worst {}: Jacobian ratio {:.3f} (element {}), aspect ratio {:.3g} (element {}){}", family,
                       jacobian_ratio, jacobian_id, aspect_ratio, aspect_id,
                       warp ? fmt::format(", warp {:.3g}", *warp) : "");
  }
};

std::vector<std::string> worst_shapes(const FiniteElementModel& model) {
  std::vector<std::string> lines;
  for_each_list(model.element_lists, [&](const auto& list) {
    const auto& traits = traits_of(list);
    if (traits.quality == nullptr || list.empty()) return;
    WorstShape worst;
    for (const auto& element : list) worst.add(element.id, traits.quality(model, element));
    lines.push_back(worst.text(traits.family));
  });
  return lines;
}

std::string constraint_line(AutomaticConstraints wanted, std::size_t constrained) {
  if (wanted == AutomaticConstraints::soft)
    return fmt::format(
        "AUTOSPC: {} degrees of freedom with less than 1e-8 of their node's largest stiffness are constrained",
        constrained);
  return fmt::format("AUTOSPC is off: only the {} degrees of freedom with neither stiffness nor mass are constrained",
                     constrained);
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
  lines.push_back(constraint_line(model_.settings.automatic_constraints, assembled_.automatic_constraints.size()));
  if (const auto omitted = std::ranges::count(assembled_.is_omitted, true); omitted > 0) {
    lines.push_back(fmt::format("static reduction (ASET, OMIT): {} degrees of freedom are kept, {} omitted{}",
                                std::ssize(assembled_.is_omitted) - omitted, omitted,
                                is_reduced_ ? "" : ", none of which has mass: exact"));
  }
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

}  // namespace mottle::model
