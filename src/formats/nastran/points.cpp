// GRID, GRDSET, SPOINT, and the positions of nodes once the coordinate systems are known.
#include <algorithm>
#include <array>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"
#include "formats/nastran/coordinates.hpp"
#include "formats/nastran/rows.hpp"
#include "mottle/core/error.hpp"

namespace mottle::formats::nastran {
namespace {

constexpr int k_max_points_of_ranges = 1'000'000;
constexpr double k_farthest = 1e100;  // differences and squares of coordinates stay finite

void read_grdset(ModelBuilder& builder, const Card& card) {
  if (builder.grid_defaults != nullptr) {
    card.fail(fmt::format("a second GRDSET; the first one is at {}", builder.deck.location_of(*builder.grid_defaults)));
  }
  builder.grid_defaults = &card.bulk();
}

/// A field of the GRID card, or of GRDSET where that is blank.
int with_default(const ModelBuilder& builder, const Card& card, int n, std::string_view what) {
  if (!card.is_blank(n) || builder.grid_defaults == nullptr) return card.integer_or(n, what, 0);
  return builder.card_of(*builder.grid_defaults).integer_or(n, what, 0);
}

void add_point(ModelBuilder& builder, const Card& card, RawPoint point) {
  point.card = &card.bulk();
  builder.raw_points.push_back(point);
}

void read_grid(ModelBuilder& builder, const Card& card) {
  RawPoint point;
  point.id = card.id(1, "ID");
  point.position_system = with_default(builder, card, 2, "CP");
  point.coordinates = {builder.real(card, 3, "X1", 0.0), builder.real(card, 4, "X2", 0.0),
                       builder.real(card, 5, "X3", 0.0)};
  point.displacement_system = with_default(builder, card, 6, "CD");
  point.fixed = card.components(7, "PS");
  if (card.is_blank(7) && builder.grid_defaults != nullptr) {
    point.fixed = builder.card_of(*builder.grid_defaults).components(7, "PS");
  }
  if (with_default(builder, card, 8, "SEID") != 0) {
    builder.count(
        "{} grid points belong to superelements (SEID), which are not formed: the structure is solved as one");
  }
  add_point(builder, card, point);
}

void add_scalar_point(ModelBuilder& builder, const Card& card, int id) {
  RawPoint point;
  point.id = id;
  point.is_scalar = true;
  add_point(builder, card, point);
}

void read_spoint(ModelBuilder& builder, const Card& card) {
  if (card.at(2) != "THRU") {
    for (int n = 1; n <= card.size(); ++n) {
      if (!card.is_blank(n)) add_scalar_point(builder, card, card.id(n, "ID"));
    }
    return;
  }
  const int first = card.id(1, "ID1");
  const int last = card.id(3, "ID2");
  if (last < first) card.fail(fmt::format("ID2 is {}, it must not be below ID1 = {}", last, first));
  if (last - first >= k_max_points_of_ranges - builder.points_of_ranges) {
    card.fail(fmt::format("{} THRU {}: more than {} scalar points in all ranges", first, last, k_max_points_of_ranges));
  }
  builder.points_of_ranges += last - first + 1;
  for (int id = first; id < last; ++id) add_scalar_point(builder, card, id);
  add_scalar_point(builder, card, last);
}

/// Scalar elements make the scalar points that they name.
void add_implied_points(ModelBuilder& builder) {
  std::vector<RawPoint> implied;
  for (const BulkCard& bulk : builder.deck.cards) {
    const bool is_of_points =
        bulk.name.starts_with("CELAS") || bulk.name.starts_with("CMASS") || bulk.name.starts_with("CDAMP");
    if (!is_of_points || builder.options.ignore_cards.contains(std::string(bulk.name))) continue;
    const Card card = builder.card_of(bulk);
    const bool is_short = bulk.name.ends_with('3') || bulk.name.ends_with('4');
    for (const int n : {3, is_short ? 4 : 5}) {
      int id = 0;
      const bool is_scalar = is_short || card.is_blank(n + 1) || card.at(n + 1) == "0";
      if (!is_scalar || !parse_integer(card.at(n), id) || id < 1) continue;
      implied.push_back({.id = id, .is_scalar = true, .card = &bulk});
    }
  }
  const auto is_before = [](const RawPoint& a, const RawPoint& b) { return a.id < b.id; };
  std::stable_sort(implied.begin(), implied.end(), is_before);
  const std::size_t given = builder.raw_points.size();
  for (const RawPoint& point : implied) {
    const auto end = builder.raw_points.begin() + static_cast<std::ptrdiff_t>(given);
    const auto found = std::lower_bound(builder.raw_points.begin(), end, point, is_before);
    const bool is_given = found != end && found->id == point.id;
    const bool is_added = builder.raw_points.size() > given && builder.raw_points.back().id == point.id;
    if (!is_given && !is_added) builder.raw_points.push_back(point);
  }
  std::inplace_merge(builder.raw_points.begin(), builder.raw_points.begin() + static_cast<std::ptrdiff_t>(given),
                     builder.raw_points.end(), is_before);
}

bool is_same_point(const RawPoint& a, const RawPoint& b) {
  return a.coordinates == b.coordinates && a.position_system == b.position_system &&
         a.displacement_system == b.displacement_system && a.fixed == b.fixed && a.is_scalar == b.is_scalar;
}

void sort_points(ModelBuilder& builder) {
  std::vector<RawPoint>& points = builder.raw_points;
  std::stable_sort(points.begin(), points.end(), [](const RawPoint& a, const RawPoint& b) { return a.id < b.id; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (kept > 0 && points[kept - 1].id == points[i].id) {
      if (!is_same_point(points[kept - 1], points[i])) {
        builder.card_of(*points[i].card)
            .fail(fmt::format("point {} is given already at {}, with other content; ids must be unique", points[i].id,
                              builder.deck.location_of(*points[kept - 1].card)));
      }
      builder.count("{} points stand twice with equal content; read once");
    } else {
      points[kept++] = points[i];
    }
  }
  points.resize(kept);
}

int system_of(const ModelBuilder& builder, const RawPoint& point, int id, std::string_view what) {
  if (id == 0) return -1;
  const auto found = builder.systems.find(id);
  if (found == builder.systems.end()) {
    builder.card_of(*point.card).fail(fmt::format("{} is {}, but no CORD card has that id", what, id));
  }
  return found->second;
}

void place_nodes(ModelBuilder& builder) {
  builder.model.nodes.reserve(builder.raw_points.size());
  builder.node_ids.reserve(builder.raw_points.size());
  for (const RawPoint& point : builder.raw_points) {
    Node node;
    node.id = point.id;
    node.is_scalar = point.is_scalar;
    node.displacement_system = system_of(builder, point, point.displacement_system, "CD");
    const int system = system_of(builder, point, point.position_system, "CP");
    node.position = basic_position(builder, system, point.coordinates);
    if (!(node.position.cwiseAbs().maxCoeff() < k_farthest)) {
      builder.card_of(*point.card).fail(fmt::format("its basic coordinates are not below {:g}", k_farthest));
    }
    builder.model.nodes.push_back(node);
    builder.node_ids.push_back(point.id);
    builder.fixed.push_back(point.fixed);
  }
}

constexpr std::array<CardRule, 3> k_point_rules = {{
    {"GRDSET", Phase::defaults, read_grdset, 8},
    {"GRID", Phase::points, read_grid, 8},
    {"SPOINT", Phase::points, read_spoint},
}};

}  // namespace

CardFamily point_cards() {
  return {"GRID, SPOINT", k_point_rules};
}

void resolve_points(ModelBuilder& builder) {
  sort_points(builder);
  add_implied_points(builder);
  resolve_systems(builder);
  place_nodes(builder);
  if (builder.model.nodes.empty()) {
    throw FormatError(builder.deck.files.front(), 0, "holds no GRID card; a model needs grid points");
  }
}

}  // namespace mottle::formats::nastran
