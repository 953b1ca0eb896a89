// MAT1, and the refusal of every other material.
#include <array>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"

namespace mottle::formats::nastran {
namespace {

void read_mat1(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "MID");
  if (!builder.is_first(card, id)) return;
  Material material;
  material.id = id;
  material.young = builder.read_field(card, 2, "E", id);
  material.shear = builder.read_field(card, 3, "G", id);
  material.poisson = builder.read_field(card, 4, "NU", id);
  material.density = builder.read_field(card, 5, "RHO", id);
  if (material.young == k_no_field && material.shear == k_no_field) card.fail("E and G are both blank, one is needed");
  const double poisson = builder.model.value(material.poisson, 0.0);
  if (poisson <= -1.0 || poisson > 0.5) card.fail(fmt::format("NU is {}, it must lie in (-1, 0.5]", poisson));
  if (builder.model.value(material.young) < 0.0) card.fail("E is negative");
  if (builder.model.value(material.shear) < 0.0) card.fail("G is negative");
  if (builder.model.value(material.density) < 0.0) card.fail("RHO is negative");
  builder.materials[id] = static_cast<int>(builder.model.materials.size());
  builder.model.materials.push_back(material);
}

constexpr std::array<CardRule, 1> k_material_rules = {{
    {"MAT1", Phase::materials, read_mat1, 12, "E G RHO"},
}};

}  // namespace

CardFamily material_cards() {
  return {"MAT1", k_material_rules};
}

}  // namespace mottle::formats::nastran
