#include "fem/elements/element_pieces.hpp"

#include <fmt/format.h>

#include "fem/assembly/constraint_equations.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {

MassKind mass_kind(const FiniteElementModel& model) {
  return model.settings.coupled_mass ? MassKind::consistent : MassKind::lumped;
}

Eigen::Matrix3Xd positions(const FiniteElementModel& model, std::span<const int> nodes) {
  Eigen::Matrix3Xd result(3, nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    result.col(static_cast<Eigen::Index>(k)) = model.nodes[static_cast<std::size_t>(nodes[k])].position;
  }
  return result;
}

void add_six_degrees_of_freedom(int node, ElementPieces& element) {
  for (int c = 0; c < 6; ++c) element.degrees_of_freedom.push_back(degree_of_freedom(node, c));
}

void visit_elements(const FiniteElementModel& model, PieceSelection selection,
                    const std::function<void(ElementPieces&)>& visit) {
  for_each_list(model.element_lists, [&](const auto& list) {
    const auto& traits = traits_of(list);
    for (const auto& element : list) {
      ElementPieces result;
      result.element = fmt::format("{} {}", traits.card(element), element.id);
      try {
        traits.add_pieces(model, element, selection, result);
      } catch (const InvalidInput& error) {
        throw InvalidInput(fmt::format("{}: {}", result.element, error.what()));
      }
      visit(result);
    }
  });
}

}  // namespace mottle::fem
