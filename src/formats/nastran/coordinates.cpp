// CORD1R, CORD1C, CORD1S, CORD2R, CORD2C, CORD2S.
#include "formats/nastran/coordinates.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "formats/nastran/card_table.hpp"

namespace mottle::formats::nastran {
namespace {

CoordinateSystem::Kind kind_of(std::string_view name) {
  switch (name.back()) {
    case 'C':
      return CoordinateSystem::Kind::cylindrical;
    case 'S':
      return CoordinateSystem::Kind::spherical;
    default:
      return CoordinateSystem::Kind::rectangular;
  }
}

void add_system(ModelBuilder& builder, const RawSystem& system) {
  builder.systems[system.id] = static_cast<int>(builder.raw_systems.size());
  builder.raw_systems.push_back(system);
}

/// Two systems a card: CIDA G1A G2A G3A CIDB G1B G2B G3B.
void read_cord1(ModelBuilder& builder, const Card& card) {
  for (int first = 1; first <= 5; first += 4) {
    if (first == 5 && !card.has_any(5, 8)) return;
    const int id = card.id(first, "CID");
    if (!builder.is_first(card, id, IdSpace::coordinate_system, first, 4)) continue;
    RawSystem system;
    system.id = id;
    system.kind = kind_of(card.name());
    system.is_by_grids = true;
    system.card = &card.bulk();
    system.grids = {card.id(first + 1, "G1"), card.id(first + 2, "G2"), card.id(first + 3, "G3")};
    add_system(builder, system);
  }
}

/// CID RID A1 A2 A3 B1 B2 B3 / C1 C2 C3.
void read_cord2(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "CID");
  if (!builder.is_first(card, id, IdSpace::coordinate_system)) return;
  RawSystem system;
  system.id = id;
  system.kind = kind_of(card.name());
  system.card = &card.bulk();
  system.reference = card.integer_or(2, "RID", 0);
  constexpr std::array<std::string_view, 9> k_names = {"A1", "A2", "A3", "B1", "B2", "B3", "C1", "C2", "C3"};
  for (int i = 0; i < 9; ++i) {
    system.points[static_cast<std::size_t>(i / 3)](i % 3) =
        builder.real(card, 3 + i, k_names[static_cast<std::size_t>(i)], 0.0);
  }
  add_system(builder, system);
}

/// Resolves systems depth first with a stack of its own: chains may be long.
class SystemResolver {
 public:
  explicit SystemResolver(ModelBuilder& builder) : builder_(builder), states_(builder.raw_systems.size()) {}

  void resolve_all() {
    builder_.model.coordinate_systems.resize(states_.size());
    for (int system = 0; system < static_cast<int>(states_.size()); ++system) {
      if (state(system) == State::untouched) resolve(system);
    }
  }

 private:
  enum class State : std::uint8_t { untouched, open, done };

  State& state(int system) { return states_[static_cast<std::size_t>(system)]; }
  const RawSystem& raw(int system) const { return builder_.raw_systems[static_cast<std::size_t>(system)]; }

  void resolve(int wanted) {
    std::vector<int> open = {wanted};
    while (!open.empty()) {
      const int system = open.back();
      state(system) = State::open;
      const int missing = first_unresolved(system);
      if (missing < 0) {
        builder_.model.coordinate_systems[static_cast<std::size_t>(system)] = build(raw(system));
        state(system) = State::done;
        open.pop_back();
      } else if (state(missing) == State::open) {
        builder_.card_of(*raw(system).card)
            .fail(fmt::format("coordinate systems {} and {} need each other; one must be given in another system",
                              raw(system).id, raw(missing).id));
      } else {
        open.push_back(missing);
      }
    }
  }

  int index_of(const RawSystem& system, int id) const {
    const auto found = builder_.systems.find(id);
    if (found == builder_.systems.end()) {
      builder_.card_of(*system.card).fail(fmt::format("needs coordinate system {}, but no CORD card has that id", id));
    }
    return found->second;
  }

  const RawPoint& point_of(const RawSystem& system, int id) const {
    const auto& points = builder_.raw_points;
    const auto found = std::lower_bound(points.begin(), points.end(), id,
                                        [](const RawPoint& point, int wanted) { return point.id < wanted; });
    if (found == points.end() || found->id != id || found->is_scalar) {
      builder_.card_of(*system.card).fail(fmt::format("grid point {} has no GRID card", id));
    }
    return *found;
  }

  /// A system that this one needs and that is not resolved; -1 where there is none.
  int first_unresolved(int index) {
    const RawSystem& system = raw(index);
    std::array<int, 3> needed = {system.reference, 0, 0};
    if (system.is_by_grids) {
      for (std::size_t i = 0; i < 3; ++i) needed[i] = point_of(system, system.grids[i]).position_system;
    }
    for (const int id : needed) {
      if (id == 0) continue;
      const int other = index_of(system, id);
      if (state(other) != State::done) return other;
    }
    return -1;
  }

  Eigen::Vector3d corner(const RawSystem& system, std::size_t i) const {
    const bool is_grid = system.is_by_grids;
    const int reference = is_grid ? point_of(system, system.grids[i]).position_system : system.reference;
    const Eigen::Vector3d local = is_grid ? point_of(system, system.grids[i]).coordinates : system.points[i];
    return basic_position(builder_, reference == 0 ? -1 : index_of(system, reference), local);
  }

  /// z points from A to B, x lies in the half plane of A, B and C.
  CoordinateSystem build(const RawSystem& system) const {
    const Eigen::Vector3d a = corner(system, 0);
    const Eigen::Vector3d z = corner(system, 1) - a;
    const Eigen::Vector3d towards_c = corner(system, 2) - a;
    const Card card = builder_.card_of(*system.card);
    constexpr double k_nothing = 1e-10;  // of the coordinates' own size: their rounding
    const double size = std::max({a.norm(), z.norm(), towards_c.norm()});
    if (!(z.norm() > k_nothing * size)) card.fail("degenerate: the points A and B coincide");
    const Eigen::Vector3d unit_z = z.normalized();
    const Eigen::Vector3d x = towards_c - unit_z * unit_z.dot(towards_c);
    if (!(x.norm() > k_nothing * size)) card.fail("degenerate: the point C lies on the line through A and B");
    CoordinateSystem result;
    result.id = system.id;
    result.kind = system.kind;
    result.origin = a;
    result.axes.col(0) = x.normalized();
    result.axes.col(1) = unit_z.cross(x.normalized());
    result.axes.col(2) = unit_z;
    if (!result.axes.allFinite() || !a.allFinite()) card.fail("its basic coordinates overflow");
    return result;
  }

  ModelBuilder& builder_;
  std::vector<State> states_;
};

constexpr std::array<CardRule, 6> k_coordinate_rules = {{
    {"CORD1R", Phase::points, read_cord1, 8},
    {"CORD1C", Phase::points, read_cord1, 8},
    {"CORD1S", Phase::points, read_cord1, 8},
    {"CORD2R", Phase::points, read_cord2, 11},
    {"CORD2C", Phase::points, read_cord2, 11},
    {"CORD2S", Phase::points, read_cord2, 11},
}};

}  // namespace

CardFamily coordinate_cards() {
  return {"CORD1R/C/S, CORD2R/C/S", k_coordinate_rules};
}

Eigen::Vector3d basic_position(const ModelBuilder& builder, int system, const Eigen::Vector3d& coordinates) {
  if (system < 0) return coordinates;
  return builder.model.coordinate_systems[static_cast<std::size_t>(system)].to_basic(coordinates);
}

void resolve_systems(ModelBuilder& builder) {
  SystemResolver(builder).resolve_all();
}

}  // namespace mottle::formats::nastran
