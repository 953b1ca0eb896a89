// PGAP, CGAP as springs in the state in which the deck gives them; PVISC, CVISC.
#include <Eigen/Geometry>
#include <array>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"

namespace mottle::formats::nastran {
namespace {

/// What a gap does in its state.
struct GapProperty {
  FieldIndex along = k_no_field, across = k_no_field;
  bool is_closed = true;
};

/// PID U0 F0 KA KB KT MU1 MU2 / ...: closed without a gap (U0), open with one; a preload (F0) closes it too.
void read_pgap(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "PID");
  if (!builder.is_first(card, id)) return;
  const double gap = builder.real(card, 2, "U0", 0.0), preload = builder.real(card, 3, "F0", 0.0);
  if (preload < 0.0) card.fail("F0 is negative, a preload presses the gap together");
  if (gap > 0.0 && preload > 0.0) {
    card.fail(
        fmt::format("U0 = {} says that the gap is open, F0 = {} that it is closed; a modal analysis needs one "
                    "state: leave one of them blank",
                    gap, preload));
  }
  GapProperty property{.is_closed = gap <= 0.0};
  if (!(builder.real(card, 4, "KA", 0.0) > 0.0)) card.fail("KA must be positive");
  if (property.is_closed) {
    property.along = builder.read_field(card, 4, "KA", id);
    const double friction = builder.real(card, 7, "MU1", 0.0);
    if (!card.is_blank(6)) {
      property.across = builder.read_field(card, 6, "KT", id);
    } else if (friction > 0.0) {  // Nastran's default: KT = MU1 KA
      property.across = builder.add_field(card.name(), id, "KT", friction * builder.model.value(property.along));
    }
    if (builder.model.value(property.across) == 0.0) property.across = k_no_field;
  } else {
    property.along = builder.read_field(card, 5, "KB", id);
  }
  builder.properties<GapProperty>("PGAP")[id] = property;
}

/// Axes of a line element of which only x matters.
Eigen::Matrix3d axes_along(const Eigen::Vector3d& x) {
  Eigen::Matrix3d axes;
  axes.col(0) = x.normalized();
  axes.col(1) = axes.col(0).unitOrthogonal();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

/// A line between the grid points in fields 3 and 4.
BushElement between(const ModelBuilder& builder, const Card& card, const char* name,
                    const std::array<std::string_view, 2>& ends) {
  BushElement line;
  line.card = name;
  line.id = card.id(1, "EID");
  line.nodes[0] = builder.grid(card, 3, ends[0]);
  line.nodes[1] = builder.grid(card, 4, ends[1]);
  if (line.nodes[0] == line.nodes[1]) card.fail(fmt::format("{} and {} are the same grid point", ends[0], ends[1]));
  line.location = builder.position(line.nodes[0]);
  return line;
}

/// EID PID GA GB X1 X2 X3 CID (or G0 for X1).
void read_cgap(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  const GapProperty& property = builder.property<GapProperty>(card, card.is_blank(2) ? id : card.id(2, "PID"), "PGAP");
  BushElement gap = between(builder, card, "CGAP", {"GA", "GB"});
  const Eigen::Vector3d along = builder.position(gap.nodes[1]) - gap.location;
  constexpr double k_coincident = 1e-4;  // as for bushes, in the deck's unit of length
  const bool has_length = along.norm() >= k_coincident;
  if (!card.is_blank(8)) {
    gap.axes = builder.axes_at(builder.system(card, 8, "CID"), gap.location);
  } else if (has_length) {
    gap.axes = axes_along(along);
  } else {
    card.fail("GA and GB lie at the same place (closer than .0001); CID is needed for the direction of the gap");
  }
  if (property.across != k_no_field && has_length) {
    card.fail(
        "the gap is closed with KT (or MU1) across a distance between GA and GB, whose moment no solid takes; set KT "
        "to 0. or put the points at one place");
  }
  gap.stiffness[0] = property.along;
  gap.stiffness[1] = gap.stiffness[2] = property.across;
  builder.count(property.is_closed ? "{} CGAP are closed (U0 <= 0): springs of KA along and KT across"
                                   : "{} CGAP are open (U0 > 0): springs of KB, where PGAP gives it");
  builder.add_element(card, gap);
}

/// Dampers along and about a line.
struct DamperProperty {
  FieldIndex along = k_no_field, about = k_no_field;
};

/// PID1 CE1 CR1 - PID2 CE2 CR2.
void read_pvisc(ModelBuilder& builder, const Card& card) {
  for (const int first : {1, 5}) {
    if (first > 1 && !card.has_any(first, first + 3)) continue;
    const int id = card.id(first, "PID");
    if (!builder.is_first(card, id, IdSpace::own, first, 4)) continue;
    builder.properties<DamperProperty>("PVISC")[id] = {builder.read_field(card, first + 1, "CE", id),
                                                       builder.read_field(card, first + 2, "CR", id)};
  }
}

/// EID PID G1 G2.
void read_cvisc(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  const DamperProperty& property =
      builder.property<DamperProperty>(card, card.is_blank(2) ? id : card.id(2, "PID"), "PVISC");
  BushElement damper = between(builder, card, "CVISC", {"G1", "G2"});
  const Eigen::Vector3d along = builder.position(damper.nodes[1]) - damper.location;
  if (along.isZero(0.0)) card.fail("G1 and G2 lie at the same place");
  damper.axes = axes_along(along);
  damper.damping[0] = property.along;
  damper.damping[3] = property.about;
  builder.add_element(card, damper);
}

constexpr std::array<CardRule, 4> k_gap_rules = {{
    {"PGAP", Phase::properties, read_pgap, 12, "KA KB KT"},
    {"CGAP", Phase::elements, read_cgap, 8},
    {"PVISC", Phase::properties, read_pvisc, 8},
    {"CVISC", Phase::elements, read_cvisc, 4},
}};

}  // namespace

CardFamily gap_cards() {
  return {"CGAP, CVISC", k_gap_rules};
}

}  // namespace mottle::formats::nastran
