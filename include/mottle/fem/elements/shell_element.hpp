// Shell elements and their properties as the cards describe them; their matrices are in shell.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mottle/fem/card_field.hpp"
#include "mottle/fem/elements/element_traits.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// A ply of a PCOMP or PCOMPG.
struct ShellPly {
  int material = -1;
  FieldIndex thickness = k_no_field;
  FieldIndex angle = k_no_field;  ///< THETA, degrees, from the element's material x axis
};

/// PCOMP, PCOMPG.
struct LaminateProperty {
  enum class Option : std::uint8_t {
    whole,     ///< all stiffness (LAM blank, and LAM = SYM, whose plies are written out)
    membrane,  ///< LAM = MEM: no bending
    bending,   ///< LAM = BEND: no membrane, no coupling
    smeared,   ///< LAM = SMEAR: the order of the plies is left aside, rigid in shear
  };

  std::vector<ShellPly> plies = {};  ///< from the bottom, towards the side of the normal
  FieldIndex bottom = k_no_field;    ///< Z0; absent: half the thickness below the nodes
  Option option = Option::whole;
};

/// PSHELL; PCOMP and PCOMPG, of which only the laminate and the nonstructural mass are used. A material of -1 leaves
/// that stiffness out (MID2 blank: no bending; MID3 blank: no shear flexibility).
struct ShellProperty {
  int id = 0;
  int membrane_material = -1, bending_material = -1, shear_material = -1;
  int coupling_material = -1;  ///< MID4: the coupling of membrane and bending is -T^2 G4
  FieldIndex thickness = k_no_field;
  double bending_ratio = 1.0;      ///< 12 I / T^3
  double shear_ratio = 5.0 / 6.0;  ///< TS / T
  FieldIndex nonstructural_mass = k_no_field;
  LaminateProperty laminate = {};  ///< without plies: a PSHELL
};

/// CQUAD4, CQUADR (4 nodes), CTRIA3, CTRIAR (3), CQUAD8 (8), CTRIA6 (6).
struct ShellElement {
  static constexpr int k_by_angle = -2;

  int id = 0;
  int node_count = 4;
  std::array<int, 8> nodes = {};  ///< corners, then the middles of the edges; -1: a middle that is left out
  int property = -1;
  double offset = 0.0;          ///< ZOFFS, along the element's normal
  double material_angle = 0.0;  ///< THETA, degrees, from the side between the first two nodes
  /// MCID: index of the system whose x axis, projected, is the material's x; k_by_angle: THETA says it; -1: basic
  int material_system = k_by_angle;
  /// E T^2 (12 I/T^3) / (G TS/T) of the deck as given, by which the edges share their deformation between bending and
  /// shear while T, E and G move: the share is a choice of the element for this mesh, and T stays separable. 0: taken
  /// at the current values, on which the matrices then depend.
  double bending_over_shear = 0.0;
  /// E T^2 (12 I/T^3) of bending / E of the membrane, of the deck as given: with it the bubbles of curved shells follow
  /// their nodes while T, E and G move. 0: taken at the current values.
  double bending_over_membrane = 0.0;
  const char* card = nullptr;         ///< where it is not CQUAD4, CTRIA3, CQUAD8 or CTRIA6 by the number of nodes
  FieldIndex thickness = k_no_field;  ///< own thickness (mean of T1..T4 where given), else the property's

  static const ElementTraits<ShellElement> k_traits;
};

/// Sets bending_over_shear and bending_over_membrane from the current values; 0 where the PSHELL is rigid in shear or
/// has no such material, and of laminates.
/// @throws InvalidInput  a material that cannot be
void hold_ratios(const FiniteElementModel& model, ShellElement& element);

}  // namespace mottle::fem
