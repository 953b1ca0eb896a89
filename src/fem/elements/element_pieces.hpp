// Every element's matrices as constant matrices times products of card fields: what makes a model parameter-separable.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "mottle/fem/elements/solid.hpp"
#include "mottle/fem/finite_element_model.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// One card field raised to a power.
struct FieldPower {
  FieldIndex field = k_no_field;
  int power = 1;
};

/// factor * product of field^power * matrix
struct ElementPiece {
  enum class Kind : std::uint8_t { stiffness, mass, damping };

  Kind kind = Kind::stiffness;
  double factor = 1.0;
  std::vector<FieldPower> coefficient = {};
  std::vector<FieldIndex> matrix_fields = {};  ///< fields on which `matrix` itself depends: made anew when they change
  Eigen::MatrixXd matrix = {};
};

/// All that one element adds.
struct ElementPieces {
  std::string element;                  ///< "CHEXA 12", for messages
  std::vector<int> degrees_of_freedom;  ///< slots of constraint_equations.hpp; may repeat
  bool is_basic = true;                 ///< by threes in basic axes, to be turned into the nodes' own
  std::vector<ElementPiece> pieces;
};

/// Which pieces are wanted.
enum class PieceSelection : std::uint8_t { all, mass };

/// What the model's settings make of masses.
MassKind mass_kind(const FiniteElementModel& model);

/// Basic coordinates of nodes: [3 x node].
Eigen::Matrix3Xd positions(const FiniteElementModel& model, std::span<const int> nodes);

/// Lets an element act on all six degrees of freedom of a node.
void add_six_degrees_of_freedom(int node, ElementPieces& element);

/// Calls `visit` for every element, in the model's order. The object may be changed by the visitor.
///
/// Throws InvalidInput: an element whose form or section cannot be (message starts with the card and its id).
void visit_elements(const FiniteElementModel& model, PieceSelection selection,
                    const std::function<void(ElementPieces&)>& visit);

}  // namespace mottle::fem
