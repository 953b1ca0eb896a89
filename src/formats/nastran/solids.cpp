// PSOLID, CHEXA, CPENTA, CPYRAM, CTETRA.
#include <array>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"
#include "formats/nastran/rows.hpp"

namespace mottle::formats::nastran {
namespace {

struct SolidProperty {
  int material = -1;
  int material_system = -1;
};

void read_psolid(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "PID");
  if (!builder.is_first(card, id)) return;
  if (!card.is_blank(7) && card.at(7) != "SMECH") {
    card.fail(fmt::format("FCTN is '{}'; only structural solids (SMECH) are supported", shown(card.at(7))));
  }
  SolidProperty property{.material = builder.material(card, 2, "MID", solid_materials())};
  const bool is_isotropic =
      builder.model.materials[static_cast<std::size_t>(property.material)].kind == Material::Kind::isotropic;
  if (!is_isotropic) {
    if (card.at(3) == "-1")
      card.fail("CORDM is -1 (axes of each element), which is not supported; name a coordinate system");
    property.material_system = builder.system(card, 3, "CORDM");
  }
  builder.properties<SolidProperty>("PSOLID")[id] = property;
}

void add_solid(ModelBuilder& builder, const Card& card, SolidShape shape, int corners) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  SolidElement element;
  element.id = id;
  element.shape = shape;
  element.property_id = card.is_blank(2) ? id : card.id(2, "PID");
  const SolidProperty& property = builder.property<SolidProperty>(card, element.property_id, "PSOLID");
  element.material = property.material;
  element.material_system = property.material_system;
  builder.read_corners(card, 3, corners, element.nodes.data());
  builder.add_element(card, element);
}

void refuse_midside_nodes(const Card& card, int corners, int last) {
  if (!card.has_any(3 + corners, last)) return;
  for (int n = 3 + corners; n <= last; ++n) {
    card.require_absent(n, fmt::format("G{}", n - 2),
                        fmt::format("midside nodes of {} are not supported", card.name()));
  }
}

void read_chexa(ModelBuilder& builder, const Card& card) {
  refuse_midside_nodes(card, 8, 22);
  add_solid(builder, card, SolidShape::hexahedron8, 8);
}

void read_cpenta(ModelBuilder& builder, const Card& card) {
  refuse_midside_nodes(card, 6, 17);
  add_solid(builder, card, SolidShape::wedge6, 6);
}

void read_cpyram(ModelBuilder& builder, const Card& card) {
  refuse_midside_nodes(card, 5, 15);
  add_solid(builder, card, SolidShape::pyramid5, 5);
}

void read_ctetra(ModelBuilder& builder, const Card& card) {
  const bool has_midsides = card.has_any(7, 12);
  add_solid(builder, card, has_midsides ? SolidShape::tetrahedron10 : SolidShape::tetrahedron4, has_midsides ? 10 : 4);
}

constexpr std::array<CardRule, 5> k_solid_rules = {{
    {"PSOLID", Phase::properties, read_psolid, 8},
    {"CHEXA", Phase::elements, read_chexa, 22},
    {"CPENTA", Phase::elements, read_cpenta, 17},
    {"CPYRAM", Phase::elements, read_cpyram, 15},
    {"CTETRA", Phase::elements, read_ctetra, 12},
}};

}  // namespace

CardFamily solid_cards() {
  return {"CHEXA, CPENTA, CPYRAM, CTETRA", k_solid_rules};
}

}  // namespace mottle::formats::nastran
