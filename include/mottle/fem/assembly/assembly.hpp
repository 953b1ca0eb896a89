// Stiffness, mass and damping of a finite-element model as terms in the parameters, constraints eliminated.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "mottle/fem/assembly/separable_matrix.hpp"
#include "mottle/fem/finite_element_model.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// The card fields that one parameter acts on: all set to its value, or all multiplied by it.
struct FieldParameter {
  std::vector<FieldIndex> fields;
  bool is_factor = false;
};

/// A row of the assembled matrices: a component of a node in its displacement system.
struct Equation {
  int node = 0;
  int component = 0;  ///< 0..5
};

/// A degree of freedom that was constrained automatically because it has no stiffness, see AutomaticConstraints.
struct AutomaticConstraint {
  int node = 0;
  int component = 0;
};

/// K(x), M(x) and C(x) of the free degrees of freedom. K and M have one pattern.
struct AssembledModel {
  SeparableMatrix stiffness;
  SeparableMatrix mass;
  SeparableMatrix damping;
  std::vector<Equation> equations;
  std::vector<AutomaticConstraint> automatic_constraints;
  std::vector<bool> is_separable;  ///< by parameter; false: the terms hold only at the card's values of its fields
  int dependent_degrees_of_freedom = 0;
  std::vector<bool> is_omitted;  ///< by equation, by a static reduction of which K, M and C know nothing; empty: none
  /// Displacement components [6 node + component] from the equations, dependent ones included.
  Eigen::SparseMatrix<double, Eigen::RowMajor> expansion;
};

/// Assembles the model, each element's matrices times the powers of what the parameters move.
///
/// Rigid and interpolation elements and multipoint constraints are eliminated exactly (u = T u_free), fixed components
/// removed. With AutomaticConstraints::soft, a direction of a node's translations or rotations in which the stiffness
/// is below 1e-8 of the node's largest is constrained at the component nearest to it, and counted; with `null`,
/// equations whose rows of K(x) and M(x) are zero at every x.
///
/// @param parameters     by number; a field belongs to one parameter at most
/// @throws InvalidInput  an element or constraint that cannot be (its name in front), a degree of freedom that is
///                       dependent twice or dependent and fixed, one in the analysis or omitted set that is not free,
///                       equations that depend on each other in a circle, a model without a free degree of freedom
AssembledModel assemble(const FiniteElementModel& model, const std::vector<FieldParameter>& parameters);

/// "101:+Z", "101:+RX"; "7" for a scalar point: how an equation is named.
std::string degree_of_freedom_name(const FiniteElementModel& model, int node, int component);

}  // namespace mottle::fem
