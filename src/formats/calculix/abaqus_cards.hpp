// Which fields of Abaqus' cards are nodes, elements and names: a table.
#pragma once

#include <array>
#include <set>
#include <string_view>

#include "mottle/layers.hpp"

namespace mottle::formats {

/// Where a card goes: CalculiX wants materials and orientations before the sections that name them.
enum class CardPlace { mesh, model, sections };

/// Fields of a data line: n node or set of nodes, e element or set of elements, s surface, '.' anything else; the last
/// `cycle` letters are repeated.
struct AbaqusCard {
  std::string_view keyword;
  CardPlace place = CardPlace::model;
  std::string_view fields = ".";
  std::size_t cycle = 1;
  bool turns = true;  ///< an instance that is rotated may have it: it has no direction
};

inline constexpr std::array k_abaqus_cards = {AbaqusCard{"NODE", CardPlace::mesh, "n."},
                                              AbaqusCard{"ELEMENT", CardPlace::mesh, "en"},
                                              AbaqusCard{"NSET", CardPlace::mesh, "n"},
                                              AbaqusCard{"ELSET", CardPlace::mesh, "e"},
                                              AbaqusCard{"SURFACE", CardPlace::mesh, "e."},
                                              AbaqusCard{"ORIENTATION", CardPlace::mesh, ".", 1, false},
                                              AbaqusCard{"TRANSFORM", CardPlace::mesh, ".", 1, false},
                                              AbaqusCard{"SOLID SECTION", CardPlace::sections},
                                              AbaqusCard{"SHELL SECTION", CardPlace::sections},
                                              AbaqusCard{"SHELL GENERAL SECTION", CardPlace::sections},
                                              AbaqusCard{"MEMBRANE SECTION", CardPlace::sections},
                                              AbaqusCard{"BEAM SECTION", CardPlace::sections, ".", 1, false},
                                              AbaqusCard{"MASS", CardPlace::sections},
                                              AbaqusCard{"SPRING", CardPlace::sections, ".", 1, false},
                                              AbaqusCard{"DASHPOT", CardPlace::sections, ".", 1, false},
                                              AbaqusCard{"TIE", CardPlace::sections, "ss."},
                                              AbaqusCard{"COUPLING", CardPlace::sections},
                                              AbaqusCard{"KINEMATIC", CardPlace::sections, ".", 1, false},
                                              AbaqusCard{"DISTRIBUTING", CardPlace::sections, ".", 1, false},
                                              AbaqusCard{"RIGID BODY", CardPlace::sections},
                                              AbaqusCard{"EQUATION", CardPlace::sections, "n..", 3, false},
                                              AbaqusCard{"MPC", CardPlace::sections, ".n"},
                                              AbaqusCard{"BOUNDARY", CardPlace::model, "n."},
                                              AbaqusCard{"CLOAD", CardPlace::model, "n."},
                                              AbaqusCard{"DLOAD", CardPlace::model, "e."},
                                              AbaqusCard{"DSLOAD", CardPlace::model, "s."},
                                              AbaqusCard{"TEMPERATURE", CardPlace::model, "n."},
                                              AbaqusCard{"INITIAL CONDITIONS", CardPlace::model, "n."}};

/// Parameters that name a set, surface or orientation of the scope that they stand in.
inline const std::set<std::string_view>& naming_parameters() {
  static const std::set<std::string_view> k_names = {"NSET",     "ELSET", "SURFACE",  "ORIENTATION",
                                                     "TIE NSET", "NAME",  "PIN NSET", "CONSTRAINT NAME"};
  return k_names;
}

/// Elements of Abaqus that CalculiX does not have, or has by the same name as something that is not like it.
struct ElementName {
  std::string_view abaqus, calculix;
  std::string_view note;  ///< what a reader should know; empty: they are the same
};

inline constexpr std::array k_element_names = {
    ElementName{"S4R", "S4",
                "S4R is solved as CalculiX's S4, since its S4R has no stiffness in bending but for hourglass control"},
    ElementName{"S3R", "S3", "S3R is solved as CalculiX's S3, which is much too stiff in bending on coarse meshes"},
    ElementName{"S3", "S3", "S3 is much too stiff in bending on coarse meshes in CalculiX"},
    ElementName{"C3D10M", "C3D10", "C3D10M is solved as C3D10"}};

/// Requests of output, restarts and monitoring: no part of the structure.
inline const std::set<std::string_view>& output_cards() {
  static const std::set<std::string_view> k_cards = {"PREPRINT",
                                                     "OUTPUT",
                                                     "NODE OUTPUT",
                                                     "ELEMENT OUTPUT",
                                                     "ENERGY OUTPUT",
                                                     "CONTACT OUTPUT",
                                                     "MODAL OUTPUT",
                                                     "SURFACE OUTPUT",
                                                     "RESTART",
                                                     "MONITOR",
                                                     "PRINT",
                                                     "FILE FORMAT",
                                                     "NODE PRINT",
                                                     "EL PRINT",
                                                     "ENERGY PRINT",
                                                     "MODAL PRINT",
                                                     "CONTACT PRINT",
                                                     "SECTION PRINT",
                                                     "NODE FILE",
                                                     "EL FILE",
                                                     "ENERGY FILE",
                                                     "MODAL FILE",
                                                     "CONTACT FILE",
                                                     "SECTION FILE",
                                                     "ELEMENT MATRIX OUTPUT",
                                                     "FILE OUTPUT",
                                                     "DIAGNOSTICS",
                                                     "INCREMENTATION OUTPUT",
                                                     "RADIATION OUTPUT"};
  return k_cards;
}

/// Degrees of freedom that a named support fixes, first and last of each range.
struct NamedSupport {
  std::string_view name;
  std::array<std::array<int, 2>, 3> ranges;  ///< {0, 0}: none
};

inline constexpr std::array k_named_supports = {
    NamedSupport{"ENCASTRE", {{{1, 6}, {0, 0}, {0, 0}}}}, NamedSupport{"PINNED", {{{1, 3}, {0, 0}, {0, 0}}}},
    NamedSupport{"XSYMM", {{{1, 1}, {5, 6}, {0, 0}}}},    NamedSupport{"YSYMM", {{{2, 2}, {4, 4}, {6, 6}}}},
    NamedSupport{"ZSYMM", {{{3, 5}, {0, 0}, {0, 0}}}},    NamedSupport{"XASYMM", {{{2, 4}, {0, 0}, {0, 0}}}},
    NamedSupport{"YASYMM", {{{1, 1}, {3, 3}, {5, 5}}}},   NamedSupport{"ZASYMM", {{{1, 2}, {6, 6}, {0, 0}}}}};

}  // namespace mottle::formats
