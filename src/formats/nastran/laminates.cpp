// PCOMP, PCOMPG: shells of plies.
#include <array>
#include <cmath>
#include <vector>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"
#include "formats/nastran/rows.hpp"

namespace mottle::formats::nastran {
namespace {

/// Where a ply's fields stand on the card.
struct PlyLayout {
  int width = 4;     ///< fields from one ply to the next
  int material = 0;  ///< field of MID from the first of the ply; T, THETA, SOUT follow
};

/// Reads plies from field 9 on; a ply whose fields are all blank does not exist. MID and T are those of the ply before
/// where they are blank.
std::vector<ShellPly> read_plies(ModelBuilder& builder, const Card& card, int id, const PlyLayout& layout) {
  std::vector<ShellPly> plies;
  for (int first = 9; first <= card.size(); first += layout.width) {
    if (!card.has_any(first, first + layout.width - 1)) continue;
    const int n = first + layout.material, number = static_cast<int>(plies.size()) + 1;
    ShellPly ply;
    if (!plies.empty()) ply = {.material = plies.back().material, .thickness = plies.back().thickness};
    if (plies.empty() || !card.is_blank(n))
      ply.material = builder.material(card, n, fmt::format("MID{}", number), shell_materials());
    const std::string name = fmt::format("T{}", number);
    if (!card.is_blank(n + 1)) ply.thickness = builder.read_field(card, n + 1, name, id);
    if (ply.thickness == k_no_field) card.fail("T1 is blank, the first ply needs a thickness");
    const double thickness = builder.model.value(ply.thickness);
    if (!(thickness > 0.0)) card.fail(fmt::format("{} is {}, it must be positive", name, thickness));
    ply.angle = builder.read_field(card, n + 2, fmt::format("THETA{}", number), id);
    plies.push_back(ply);
  }
  if (plies.empty()) card.fail("there is no ply; MID1 and T1 are needed at least");
  return plies;
}

/// LAM. SYM writes out the plies of the other half.
void read_option(const Card& card, LaminateProperty& laminate) {
  const std::string_view option = card.at(8);
  using enum LaminateProperty::Option;
  if (option == "SYM") {
    const std::vector<ShellPly> half = laminate.plies;
    laminate.plies.insert(laminate.plies.end(), half.rbegin(), half.rend());
  } else if (option == "MEM") {
    laminate.option = membrane;
  } else if (option == "BEND") {
    laminate.option = bending;
  } else if (option == "SMEAR") {
    laminate.option = smeared;
  } else if (!option.empty()) {
    card.fail(fmt::format("LAM is '{}'; read are blank, SYM, MEM, BEND and SMEAR (write the plies of SMCORE out)",
                          shown(option)));
  }
}

/// Smearing leaves the height of the plies aside, so that they must lie on both sides of the nodes alike.
void require_middle(const ModelBuilder& builder, const Card& card, LaminateProperty& laminate) {
  if (laminate.option != LaminateProperty::Option::smeared || laminate.bottom == k_no_field) return;
  double thickness = 0.0;
  for (const ShellPly& ply : laminate.plies) thickness += builder.model.value(ply.thickness);
  const double bottom = builder.model.value(laminate.bottom);
  if (std::abs(bottom + 0.5 * thickness) > 1e-3 * thickness) {
    card.fail(fmt::format("Z0 is {}, LAM = SMEAR needs -T/2 = {} (leave Z0 blank and use ZOFFS of the elements)",
                          bottom, -0.5 * thickness));
  }
  laminate.bottom = k_no_field;
}

/// PID Z0 NSM SB FT TREF GE LAM / plies.
void read_laminate(ModelBuilder& builder, const Card& card, const PlyLayout& layout) {
  const int id = card.id(1, "PID");
  if (!builder.is_first(card, id, IdSpace::shell_property)) return;
  ShellProperty property;
  property.id = id;
  property.laminate.bottom = builder.read_field(card, 2, "Z0", id);
  property.nonstructural_mass = builder.read_field(card, 3, "NSM", id);
  property.laminate.plies = read_plies(builder, card, id, layout);
  read_option(card, property.laminate);
  require_middle(builder, card, property.laminate);
  builder.properties<int>(k_shell_properties)[id] = static_cast<int>(builder.model.shell_properties.size());
  builder.model.shell_properties.push_back(std::move(property));
}

/// MID1 T1 THETA1 SOUT1 MID2...
void read_pcomp(ModelBuilder& builder, const Card& card) {
  read_laminate(builder, card, {.width = 4, .material = 0});
}

/// GPLYID1 MID1 T1 THETA1 SOUT1 - - - / GPLYID2...
void read_pcompg(ModelBuilder& builder, const Card& card) {
  read_laminate(builder, card, {.width = 8, .material = 1});
}

constexpr std::array<CardRule, 2> k_laminate_rules = {{
    {"PCOMP", Phase::properties, read_pcomp, 0, "T*"},
    {"PCOMPG", Phase::properties, read_pcompg, 0, "T*"},
}};

}  // namespace

CardFamily laminate_cards() {
  return {"", k_laminate_rules};
}

}  // namespace mottle::formats::nastran
