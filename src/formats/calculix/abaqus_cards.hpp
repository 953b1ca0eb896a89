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
  std::string_view parameters = {};  ///< that CalculiX has or that change no modes, by commas; empty: any
  std::string_view fields = ".";
  std::size_t cycle = 1;
  bool turns = true;  ///< an instance that is rotated may have it: it has no direction
};

inline constexpr std::array k_abaqus_cards = {
    AbaqusCard{.keyword = "NODE", .place = CardPlace::mesh, .parameters = "NSET", .fields = "n."},
    AbaqusCard{.keyword = "ELEMENT", .place = CardPlace::mesh, .parameters = "TYPE,ELSET", .fields = "en"},
    AbaqusCard{.keyword = "NSET",
               .place = CardPlace::mesh,
               .parameters = "NSET,GENERATE,INSTANCE,INTERNAL,UNSORTED",
               .fields = "n"},
    AbaqusCard{.keyword = "ELSET",
               .place = CardPlace::mesh,
               .parameters = "ELSET,GENERATE,INSTANCE,INTERNAL,UNSORTED",
               .fields = "e"},
    AbaqusCard{.keyword = "SURFACE", .place = CardPlace::mesh, .parameters = "NAME,TYPE,INTERNAL", .fields = "e."},
    AbaqusCard{.keyword = "ORIENTATION", .place = CardPlace::mesh, .parameters = "NAME,SYSTEM", .turns = false},
    AbaqusCard{.keyword = "TRANSFORM", .place = CardPlace::mesh, .parameters = "NSET,TYPE", .turns = false},
    AbaqusCard{.keyword = "SOLID SECTION",
               .place = CardPlace::sections,
               .parameters = "ELSET,MATERIAL,ORIENTATION,CONTROLS,COMPOSITE"},
    AbaqusCard{.keyword = "SHELL SECTION",
               .place = CardPlace::sections,
               .parameters =
                   "ELSET,MATERIAL,ORIENTATION,OFFSET,COMPOSITE,NODAL THICKNESS,CONTROLS,POISSON,SECTION INTEGRATION"},
    AbaqusCard{.keyword = "SHELL GENERAL SECTION",
               .place = CardPlace::sections,
               .parameters = "ELSET,MATERIAL,ORIENTATION,OFFSET,CONTROLS,POISSON"},
    AbaqusCard{.keyword = "MEMBRANE SECTION",
               .place = CardPlace::sections,
               .parameters = "ELSET,MATERIAL,ORIENTATION,OFFSET,CONTROLS"},
    AbaqusCard{.keyword = "BEAM SECTION",
               .place = CardPlace::sections,
               .parameters = "ELSET,MATERIAL,SECTION,ORIENTATION,OFFSET1,OFFSET2,TEMPERATURE,POISSON",
               .turns = false},
    AbaqusCard{.keyword = "MASS", .place = CardPlace::sections, .parameters = "ELSET,ALPHA"},
    AbaqusCard{.keyword = "SPRING", .place = CardPlace::sections, .parameters = "ELSET,NONLINEAR", .turns = false},
    AbaqusCard{.keyword = "DASHPOT", .place = CardPlace::sections, .parameters = "ELSET", .turns = false},
    AbaqusCard{.keyword = "TIE",
               .place = CardPlace::sections,
               .parameters = "NAME,ADJUST,POSITION TOLERANCE,TYPE",
               .fields = "ss."},
    AbaqusCard{.keyword = "COUPLING", .place = CardPlace::sections, .parameters = "CONSTRAINT NAME,REF NODE,SURFACE"},
    AbaqusCard{.keyword = "KINEMATIC", .place = CardPlace::sections, .turns = false},
    AbaqusCard{.keyword = "DISTRIBUTING", .place = CardPlace::sections, .turns = false},
    AbaqusCard{.keyword = "RIGID BODY", .place = CardPlace::sections, .parameters = "REF NODE,ROT NODE,NSET,ELSET"},
    AbaqusCard{.keyword = "EQUATION", .place = CardPlace::sections, .fields = "n..", .cycle = 3, .turns = false},
    AbaqusCard{.keyword = "MPC", .place = CardPlace::sections, .fields = ".n"},
    AbaqusCard{.keyword = "BOUNDARY", .place = CardPlace::model, .fields = "n."},
    AbaqusCard{.keyword = "CLOAD", .place = CardPlace::model, .fields = "n."},
    AbaqusCard{.keyword = "DLOAD", .place = CardPlace::model, .fields = "e."},
    AbaqusCard{.keyword = "DSLOAD", .place = CardPlace::model, .fields = "s."},
    AbaqusCard{.keyword = "TEMPERATURE", .place = CardPlace::model, .fields = "n."},
    AbaqusCard{.keyword = "INITIAL CONDITIONS", .place = CardPlace::model, .fields = "n."}};

/// Parameters that name a set, surface or orientation of the scope that they stand in.
inline const std::set<std::string_view>& naming_parameters() {
  static const std::set<std::string_view> k_names = {"NSET",        "ELSET", "SURFACE",
                                                     "ORIENTATION", "NAME",  "CONSTRAINT NAME"};
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
