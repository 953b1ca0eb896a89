// The table of elements: every kind that a model may hold. A kind is added by naming it here.
#pragma once

#include <tuple>
#include <vector>

#include "mottle/fem/elements/beam_element.hpp"
#include "mottle/fem/elements/bush_element.hpp"
#include "mottle/fem/elements/curved_beam_element.hpp"
#include "mottle/fem/elements/general_element.hpp"
#include "mottle/fem/elements/point_mass_element.hpp"
#include "mottle/fem/elements/rod_element.hpp"
#include "mottle/fem/elements/scalar_element.hpp"
#include "mottle/fem/elements/shear_panel_element.hpp"
#include "mottle/fem/elements/shell_element.hpp"
#include "mottle/fem/elements/solid_element.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

template <typename... Elements>
using ListsOf = std::tuple<std::vector<Elements>...>;

/// The elements of a model, in the order in which the assembly adds them up.
using ElementLists = ListsOf<SolidElement, ShellElement, ShearPanelElement, BeamElement, CurvedBeamElement, RodElement,
                             ScalarElement, BushElement, GeneralElement, PointMassElement>;

/// Calls `action` with the list of each kind in turn.
template <typename Lists, typename Action>
void for_each_list(Lists& lists, const Action& action) {
  std::apply([&action](auto&... list) { (action(list), ...); }, lists);
}

/// The traits of the elements of a list.
template <typename List>
const auto& traits_of(const List&) {
  return List::value_type::k_traits;
}

}  // namespace mottle::fem
