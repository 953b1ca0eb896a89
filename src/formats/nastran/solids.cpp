// PSOLID, CHEXA, CPENTA, CPYRAM, CTETRA.
#include <algorithm>
#include <array>
#include <span>

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

/// The shape without mid-edge nodes and the one with some or all of them.
struct SolidForm {
  SolidShape linear, quadratic;
};

void add_solid(ModelBuilder& builder, const Card& card, const SolidForm& form) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  SolidElement element;
  element.id = id;
  element.property_id = card.is_blank(2) ? id : card.id(2, "PID");
  const SolidProperty& property = builder.property<SolidProperty>(card, element.property_id, "PSOLID");
  element.material = property.material;
  element.material_system = property.material_system;
  const int corners = node_count(form.linear), nodes = node_count(form.quadratic);
  builder.read_corners(card, 3, corners, element.nodes.data());
  builder.read_middles(card, 3, corners, nodes, element.nodes.data());
  const auto middles = std::span(element.nodes).subspan(static_cast<std::size_t>(corners));
  const bool has_middles =
      std::ranges::any_of(middles.first(static_cast<std::size_t>(nodes - corners)), [](int node) { return node >= 0; });
  element.shape = has_middles ? form.quadratic : form.linear;
  builder.add_element(card, element);
}

void read_chexa(ModelBuilder& builder, const Card& card) {
  add_solid(builder, card, {SolidShape::hexahedron8, SolidShape::hexahedron20});
}

void read_cpenta(ModelBuilder& builder, const Card& card) {
  add_solid(builder, card, {SolidShape::wedge6, SolidShape::wedge15});
}

void read_cpyram(ModelBuilder& builder, const Card& card) {
  add_solid(builder, card, {SolidShape::pyramid5, SolidShape::pyramid13});
}

void read_ctetra(ModelBuilder& builder, const Card& card) {
  add_solid(builder, card, {SolidShape::tetrahedron4, SolidShape::tetrahedron10});
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
