// RBE2, RBE3, RBAR, RBAR1.
#include <algorithm>
#include <array>
#include <bit>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"
#include "formats/nastran/lists.hpp"
#include "formats/nastran/rows.hpp"

namespace mottle::formats::nastran {
namespace {

/// A number with a point: ALPHA or a weight, where ids are integers.
bool is_real(const Card& card, int n) {
  double value = 0.0;
  return !card.is_integer(n) && parse_real(card.at(n), value);
}

Components needed_components(const Card& card, int n, std::string_view what) {
  const Components components = card.components(n, what);
  if (components == 0) card.fail(fmt::format("{} is blank, digits from 1 to 6 are needed", what));
  return components;
}

/// EID GN CM GM1 GM2 ... ALPHA.
void read_rbe2(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  RigidBody body;
  body.id = id;
  body.independent = builder.grid(card, 2, "GN");
  body.components = needed_components(card, 3, "CM");
  const int last = card.size() > 4 && is_real(card, card.size()) ? card.size() - 1 : card.size();
  for_each_listed_node(builder, card, 4, last, [&](int node) {
    if (node == body.independent) card.fail("GN stands among the dependent grid points");
    if (builder.model.nodes[static_cast<std::size_t>(node)].is_scalar) card.fail("a scalar point stands among GM");
    body.dependents.push_back(node);
  });
  if (body.dependents.empty()) card.fail("GM1 is blank, dependent grid points are needed");
  std::vector<int> sorted = body.dependents;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) {
    card.fail(fmt::format("grid point {} is given twice among GM", builder.node_ids[static_cast<std::size_t>(*twice)]));
  }
  builder.model.rigid_bodies.push_back(std::move(body));
  builder.count_element(card);
}

/// EID GA GB CNA CNB CMA CMB ALPHA.
void read_rbar(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  RigidBar bar;
  bar.id = id;
  bar.nodes = {builder.grid(card, 2, "GA"), builder.grid(card, 3, "GB")};
  if (bar.nodes[0] == bar.nodes[1]) card.fail("GA and GB are the same grid point");
  bar.independent = {card.components(4, "CNA"), card.components(5, "CNB")};
  bar.dependent = {card.components(6, "CMA"), card.components(7, "CMB")};
  const int independent = std::popcount(bar.independent[0]) + std::popcount(bar.independent[1]);
  if (independent != 6)
    card.fail(fmt::format("CNA and CNB name {} components, together they must name 6", independent));
  const bool is_rest = bar.dependent[0] == 0 && bar.dependent[1] == 0;
  for (std::size_t end = 0; end < 2; ++end) {
    if (is_rest) bar.dependent[end] = static_cast<Components>(k_all_components & ~bar.independent[end]);
    if ((bar.dependent[end] & bar.independent[end]) != 0) card.fail("a component is both independent and dependent");
  }
  builder.model.rigid_bars.push_back(bar);
  builder.count_element(card);
}

/// EID GA GB CB ALPHA: all of GA is independent.
void read_rbar1(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  RigidBar bar;
  bar.id = id;
  bar.nodes = {builder.grid(card, 2, "GA"), builder.grid(card, 3, "GB")};
  if (bar.nodes[0] == bar.nodes[1]) card.fail("GA and GB are the same grid point");
  bar.independent = {k_all_components, 0};
  bar.dependent = {0, card.is_blank(4) ? k_all_components : needed_components(card, 4, "CB")};
  builder.model.rigid_bars.push_back(bar);
  builder.count_element(card);
}

/// Walks over the fields that are not blank of EID - REFGRID REFC WT1 C1 G1,1 G1,2 ... WT2 C2 ... "UM" GM1 CM1 ...
class InterpolationReader {
 public:
  InterpolationReader(ModelBuilder& builder, const Card& card) : builder_(builder), card_(card) {}

  Interpolation read() {
    Interpolation result;
    result.id = card_.id(1, "EID");
    result.reference = builder_.grid(card_, 3, "REFGRID");
    result.reference_components = needed_components(card_, 4, "REFC");
    n_ = 5;
    skip_blank();
    while (!is_at_end()) read_group(result);
    if (result.sources.empty()) card_.fail("WT1, C1 and G1,1 are needed");
    if (card_.at(n_) == "UM") read_dependents(result);
    return result;
  }

 private:
  bool is_at_end() const {
    const std::string_view text = card_.at(n_);
    return n_ > card_.size() || text == "UM" || text == "ALPHA" || text == "TLREF";
  }

  void skip_blank() {
    while (n_ <= card_.size() && card_.is_blank(n_)) ++n_;
  }

  void advance() {
    ++n_;
    skip_blank();
  }

  void read_group(Interpolation& result) {
    const double weight = card_.real(n_, "WT");
    advance();
    const Components components = needed_components(card_, n_, "C");
    advance();
    const std::size_t before = result.sources.size();
    for (; !is_at_end() && !is_real(card_, n_); advance()) {
      const int node = builder_.grid(card_, n_, "G");
      if (node == result.reference) card_.fail("REFGRID stands among the grid points that it follows");
      result.sources.push_back({node, components, weight});
    }
    if (result.sources.size() == before) card_.fail(fmt::format("no grid point follows the weight {}", weight));
  }

  void read_dependents(Interpolation& result) {
    for (advance(); !is_at_end();) {
      const int node = builder_.grid(card_, n_, "GM");
      advance();
      result.dependents.emplace_back(node, needed_components(card_, n_, "CM"));
      advance();
    }
    if (result.dependents.empty()) card_.fail("no grid point follows UM");
  }

  ModelBuilder& builder_;
  const Card& card_;
  int n_ = 5;
};

void read_rbe3(ModelBuilder& builder, const Card& card) {
  if (!builder.is_first(card, card.id(1, "EID"))) return;
  builder.model.interpolations.push_back(InterpolationReader(builder, card).read());
  builder.count_element(card);
}

constexpr std::array<CardRule, 4> k_rigid_rules = {{
    {"RBE2", Phase::elements, read_rbe2},
    {"RBAR", Phase::elements, read_rbar, 8},
    {"RBAR1", Phase::elements, read_rbar1, 5},
    {"RBE3", Phase::elements, read_rbe3},
}};

}  // namespace

CardFamily rigid_cards() {
  return {"RBE2, RBE3, RBAR", k_rigid_rules};
}

}  // namespace mottle::formats::nastran
