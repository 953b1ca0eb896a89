// ASET, OMIT and what else divides the degrees of freedom for a static reduction.
#include <array>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"
#include "formats/nastran/lists.hpp"

namespace mottle::formats::nastran {
namespace {

using ComponentList = std::vector<std::pair<int, Components>>;

void add(const ModelBuilder& builder, const Card& card, int node, Components components, ComponentList& list) {
  const bool is_scalar = builder.model.nodes[static_cast<std::size_t>(node)].is_scalar;
  const int id = builder.node_ids[static_cast<std::size_t>(node)];
  if (is_scalar && components > 1) card.fail(fmt::format("scalar point {} has no component but 0", id));
  if (!is_scalar && components == 0) card.fail(fmt::format("C is blank, but {} is a grid point: digits 1 to 6", id));
  list.emplace_back(node, is_scalar ? Components{1} : components);
}

/// G1 C1 G2 C2 G3 C3 G4 C4.
void read_pairs(ModelBuilder& builder, const Card& card, ComponentList& list) {
  for (int n = 1; n <= card.size(); n += 2) {
    if (!card.has_any(n, n + 1)) continue;
    add(builder, card, builder.node(card, n, "G"), card.components(n + 1, "C"), list);
  }
}

/// C G1 G2 ... or C G1 THRU G2.
void read_listed(ModelBuilder& builder, const Card& card, ComponentList& list) {
  const Components components = card.components(1, "C");
  for_each_listed_node(builder, card, 2, card.size(), [&](int node) { add(builder, card, node, components, list); });
}

void read_aset(ModelBuilder& builder, const Card& card) {
  read_pairs(builder, card, builder.model.analysis_set);
}

void read_aset1(ModelBuilder& builder, const Card& card) {
  read_listed(builder, card, builder.model.analysis_set);
}

void read_omit(ModelBuilder& builder, const Card& card) {
  read_pairs(builder, card, builder.model.omitted_set);
}

void read_omit1(ModelBuilder& builder, const Card& card) {
  read_listed(builder, card, builder.model.omitted_set);
}

void read_boundary(ModelBuilder& builder, const Card& card) {
  read_pairs(builder, card, builder.boundary_set);
}

void read_boundary1(ModelBuilder& builder, const Card& card) {
  read_listed(builder, card, builder.boundary_set);
}

void read_qset(ModelBuilder& builder, const Card& /*card*/) {
  builder.has_component_modes = true;
}

constexpr std::array<CardRule, 11> k_reduction_rules = {{
    {"ASET", Phase::constraints, read_aset, 8},
    {"ASET1", Phase::constraints, read_aset1},
    {"OMIT", Phase::constraints, read_omit, 8},
    {"OMIT1", Phase::constraints, read_omit1},
    {"BSET", Phase::constraints, read_boundary, 8},
    {"BSET1", Phase::constraints, read_boundary1},
    {"CSET", Phase::constraints, read_boundary, 8},
    {"CSET1", Phase::constraints, read_boundary1},
    {"SUPORT", Phase::constraints, read_boundary, 8},
    {"QSET", Phase::constraints, read_qset},
    {"QSET1", Phase::constraints, read_qset},
}};

}  // namespace

CardFamily reduction_cards() {
  return {"ASET, OMIT", k_reduction_rules};
}

void write_reduction(ModelBuilder& builder) {
  FiniteElementModel& model = builder.model;
  if (builder.has_component_modes) {
    model.analysis_set.clear();
    model.omitted_set.clear();
    builder.note(
        "QSET cards: component modes stand for the omitted degrees of freedom there; here no reduction is made, all "
        "degrees of freedom stay");
  }
  if (!model.analysis_set.empty()) {
    model.analysis_set.insert(model.analysis_set.end(), builder.boundary_set.begin(), builder.boundary_set.end());
  }
  if (!model.analysis_set.empty() || !model.omitted_set.empty()) {
    builder.note(
        "ASET, OMIT: degrees of freedom are removed by static (Guyan) reduction, as in Nastran; model.ignore_cards "
        "with "
        "the names of these cards keeps all of them");
  }
}

}  // namespace mottle::formats::nastran
