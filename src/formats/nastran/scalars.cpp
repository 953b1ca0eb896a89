// CELAS1..4, CMASS1..4, CDAMP1..4 with PELAS, PMASS, PDAMP.
#include <array>
#include <bit>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"

namespace mottle::formats::nastran {
namespace {

using Kind = ScalarElement::Kind;

std::string_view number_name(Kind kind) {
  return kind == Kind::spring ? "K" : kind == Kind::mass ? "M" : "B";
}

std::string_view property_name(Kind kind) {
  return kind == Kind::spring ? "PELAS" : kind == Kind::mass ? "PMASS" : "PDAMP";
}

/// Several properties a card, each `width` fields wide: an id, a number and what is not needed here.
void read_properties(ModelBuilder& builder, const Card& card, Kind kind, int width) {
  for (int first = 1; first <= 8; first += width) {
    if (first > 1 && !card.has_any(first, first + width - 1)) continue;
    const int id = card.id(first, "PID");
    if (!builder.is_first(card, id, IdSpace::own, first, width)) continue;
    builder.properties<FieldIndex>(property_name(kind))[id] =
        builder.read_field(card, first + 1, number_name(kind), id);
  }
}

void read_pelas(ModelBuilder& builder, const Card& card) {
  read_properties(builder, card, Kind::spring, 4);
}

void read_pmass(ModelBuilder& builder, const Card& card) {
  read_properties(builder, card, Kind::mass, 2);
}

void read_pdamp(ModelBuilder& builder, const Card& card) {
  read_properties(builder, card, Kind::damper, 2);
}

void read_end(ModelBuilder& builder, const Card& card, int n, bool has_component, std::size_t end,
              ScalarElement& element) {
  const std::string_view grid_name = end == 0 ? "G1" : "G2";
  const std::string_view component_name = end == 0 ? "C1" : "C2";
  const Components component = has_component ? card.components(n + 1, component_name) : Components{0};
  if (std::popcount(component) > 1)
    card.fail(fmt::format("{} names several components, one is needed", component_name));
  if (card.integer_or(n, grid_name, 0) == 0) return;  // ground
  element.nodes[end] = builder.node(card, n, grid_name);
  const bool is_scalar = builder.model.nodes[static_cast<std::size_t>(element.nodes[end])].is_scalar;
  if (is_scalar && component > 1)
    card.fail(fmt::format("{} must be blank or 0: a scalar point has one", component_name));
  if (!is_scalar && component == 0)
    card.fail(fmt::format("{} is blank, a component from 1 to 6 is needed", component_name));
  element.components[end] = component == 0 ? 0 : std::countr_zero(component);
}

/// @param has_property  field 2 is PID, not the number itself
/// @param is_short      both ends are scalar points: S1, S2 in fields 3 and 4
void add_scalar(ModelBuilder& builder, const Card& card, Kind kind, bool has_property, bool is_short) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  ScalarElement element;
  element.kind = kind;
  element.id = id;
  read_end(builder, card, 3, !is_short, 0, element);
  read_end(builder, card, is_short ? 4 : 5, !is_short, 1, element);
  if (element.nodes[0] < 0) {  // the grounded end second
    std::swap(element.nodes[0], element.nodes[1]);
    std::swap(element.components[0], element.components[1]);
  }
  if (element.nodes[0] < 0) card.fail("both ends are grounded; one must be a point");
  if (element.nodes[0] == element.nodes[1] && element.components[0] == element.components[1]) {
    card.fail("both ends are the same degree of freedom");
  }
  if (has_property) {
    const int property = card.is_blank(2) ? id : card.id(2, "PID");
    element.value = builder.property<FieldIndex>(card, property, property_name(kind));
  } else {
    element.value = builder.read_field(card, 2, number_name(kind), id);
  }
  builder.add_element(card, element);
}

template <Kind kind, bool has_property, bool is_short>
void read_scalar(ModelBuilder& builder, const Card& card) {
  add_scalar(builder, card, kind, has_property, is_short);
}

constexpr std::array<CardRule, 15> k_scalar_rules = {{
    {"PELAS", Phase::properties, read_pelas, 8, "K"},
    {"PMASS", Phase::properties, read_pmass, 8, "M"},
    {"PDAMP", Phase::properties, read_pdamp, 8},
    {"CELAS1", Phase::elements, read_scalar<Kind::spring, true, false>, 6},
    {"CELAS2", Phase::elements, read_scalar<Kind::spring, false, false>, 8, "K"},
    {"CELAS3", Phase::elements, read_scalar<Kind::spring, true, true>, 4},
    {"CELAS4", Phase::elements, read_scalar<Kind::spring, false, true>, 4, "K"},
    {"CMASS1", Phase::elements, read_scalar<Kind::mass, true, false>, 6},
    {"CMASS2", Phase::elements, read_scalar<Kind::mass, false, false>, 6, "M"},
    {"CMASS3", Phase::elements, read_scalar<Kind::mass, true, true>, 4},
    {"CMASS4", Phase::elements, read_scalar<Kind::mass, false, true>, 4, "M"},
    {"CDAMP1", Phase::elements, read_scalar<Kind::damper, true, false>, 6},
    {"CDAMP2", Phase::elements, read_scalar<Kind::damper, false, false>, 6},
    {"CDAMP3", Phase::elements, read_scalar<Kind::damper, true, true>, 4},
    {"CDAMP4", Phase::elements, read_scalar<Kind::damper, false, true>, 4},
}};

}  // namespace

CardFamily scalar_cards() {
  return {"CELAS1-4, CMASS1-4, CDAMP1-4", k_scalar_rules};
}

}  // namespace mottle::formats::nastran
