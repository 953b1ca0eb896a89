// The matrices of a shell element whatever its form: flat with three or four nodes, or curved with mid-edge nodes.
#pragma once

#include <Eigen/Core>
#include <span>

#include "fem/elements/element_pieces.hpp"
#include "mottle/fem/elements/shell.hpp"
#include "mottle/fem/elements/shell_element.hpp"
#include "mottle/fem/finite_element_model.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// All nodes, -1 where a mid-edge node is left out.
std::span<const int> shell_nodes(const ShellElement& element);

/// Lets the element act on all six degrees of freedom of the nodes that are there.
void add_degrees_of_freedom(const ShellElement& element, ElementPieces& result);

/// Whether a curved shell, whose bubbles follow its nodes by the deck's values.
bool is_curved(const ShellElement& element);

/// [6 node x 6 node], of the nodes that are there.
struct ShellStiffness {
  Eigen::MatrixXd membrane, bending, shear, drilling;
};

/// Of a section without coupling. @throws InvalidInput  a form or direction that cannot be
ShellStiffness plate_stiffness(const FiniteElementModel& model, const ShellElement& element,
                               const ShellSection& section);

struct LaminateStiffness {
  Eigen::MatrixXd section, drilling;
};

LaminateStiffness laminate_stiffness(const FiniteElementModel& model, const ShellElement& element,
                                     const ShellSection& section);

/// At unit mass per area, of the kind that the model's settings ask for.
Eigen::MatrixXd unit_mass(const FiniteElementModel& model, const ShellElement& element);

ElementQuality shell_quality_of(const FiniteElementModel& model, const ShellElement& element);

}  // namespace mottle::fem
