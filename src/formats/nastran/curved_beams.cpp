// CBEND with PBEND.
#include <array>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"

namespace mottle::formats::nastran {
namespace {

/// PID MID A I1 I2 J RB THETAB / C1 ... F2 / K1 K2 NSM RC ZC DELTAN.
void read_pbend(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "PID");
  if (!builder.is_first(card, id)) return;
  if (card.is_integer(3)) {
    card.fail("the form for pipes (FSI, RM, T) is not supported; give A, I1, I2 and J");
  }
  CurvedBeamElement property;
  property.material = builder.material(card, 2, "MID");
  property.area = builder.read_field(card, 3, "A", id);
  property.inertia_1 = builder.read_field(card, 4, "I1", id);
  property.inertia_2 = builder.read_field(card, 5, "I2", id);
  property.torsion = builder.read_field(card, 6, "J", id);
  for (const FieldIndex number : {property.area, property.inertia_1, property.inertia_2, property.torsion}) {
    if (!(builder.model.value(number) > 0.0)) card.fail("A, I1, I2 and J must be positive");
  }
  property.radius = builder.real(card, 7, "RB", 0.0);
  property.angle = builder.real(card, 8, "THETAB", 0.0);
  property.shear_1 = builder.real(card, 17, "K1", 0.0);
  property.shear_2 = builder.real(card, 18, "K2", 0.0);
  if (property.shear_1 < 0.0 || property.shear_2 < 0.0) card.fail("K1 and K2 must be 0 or positive");
  property.nonstructural_mass = builder.read_field(card, 19, "NSM", id);
  property.radial_offset = builder.real(card, 20, "RC", 0.0);
  property.normal_offset = builder.real(card, 21, "ZC", 0.0);
  const double neutral = builder.real(card, 22, "DELTAN", 0.0);
  if (neutral < 0.0) card.fail("DELTAN is negative; the neutral axis lies between the centroid and the centre");
  if (neutral > 0.0) property.neutral_offset = neutral;
  builder.properties<CurvedBeamElement>("PBEND")[id] = property;
}

Eigen::Vector3d read_orientation(ModelBuilder& builder, const Card& card, int node_a) {
  if (card.is_integer(5) && !card.has_any(6, 7)) {
    return builder.position(builder.grid(card, 5, "G0")) - builder.position(node_a);
  }
  if (!card.has_any(5, 7)) card.fail("X1, X2, X3 (or G0) are blank; the orientation vector is needed");
  return builder.displacement_axes(node_a) * Eigen::Vector3d(builder.real(card, 5, "X1", 0.0),
                                                             builder.real(card, 6, "X2", 0.0),
                                                             builder.real(card, 7, "X3", 0.0));
}

/// EID PID GA GB X1 X2 X3 GEOM.
void read_cbend(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  CurvedBeamElement beam =
      builder.property<CurvedBeamElement>(card, card.is_blank(2) ? id : card.id(2, "PID"), "PBEND");
  beam.id = id;
  beam.nodes = {builder.grid(card, 3, "GA"), builder.grid(card, 4, "GB")};
  if (beam.nodes[0] == beam.nodes[1]) card.fail("GA and GB are the same grid point");
  beam.orientation = read_orientation(builder, card, beam.nodes[0]);
  constexpr std::array<ArcRule, 4> k_rules = {ArcRule::center, ArcRule::tangent, ArcRule::radius, ArcRule::angle};
  const int geometry = card.integer(8, "GEOM");
  if (geometry < 1 || geometry > 4) card.fail(fmt::format("GEOM is {}, it must be 1, 2, 3 or 4", geometry));
  beam.rule = k_rules[static_cast<std::size_t>(geometry) - 1];
  if (beam.rule == ArcRule::radius && !(beam.radius > 0.0)) card.fail("GEOM is 3, which needs RB of its PBEND");
  if (beam.rule == ArcRule::angle && !(beam.angle > 0.0)) card.fail("GEOM is 4, which needs THETAB of its PBEND");
  builder.add_element(card, beam);
}

constexpr std::array<CardRule, 2> k_curved_beam_rules = {{
    {"PBEND", Phase::properties, read_pbend, 22, "A I1 I2 J"},
    {"CBEND", Phase::elements, read_cbend, 8},
}};

}  // namespace

CardFamily curved_beam_cards() {
  return {"CBEND", k_curved_beam_rules};
}

}  // namespace mottle::formats::nastran
