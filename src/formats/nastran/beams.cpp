// CBAR, CBEAM with BAROR, BEAMOR: ends, orientation and offsets in basic coordinates.
#include <Eigen/Geometry>
#include <array>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"
#include "formats/nastran/rows.hpp"

namespace mottle::formats::nastran {
namespace {

void keep_defaults(ModelBuilder& builder, const Card& card, const BulkCard*& first) {
  if (first != nullptr) {
    card.fail(fmt::format("a second {}; the first one is at {}", card.name(), builder.deck.location_of(*first)));
  }
  first = &card.bulk();
}

void read_baror(ModelBuilder& builder, const Card& card) {
  keep_defaults(builder, card, builder.bar_defaults);
}

void read_beamor(ModelBuilder& builder, const Card& card) {
  keep_defaults(builder, card, builder.beam_defaults);
}

/// Reads one CBAR or CBEAM; its defaults card has the same layout.
class BeamReader {
 public:
  BeamReader(ModelBuilder& builder, const Card& card, const BulkCard* defaults)
      : builder_(builder), card_(card), defaults_(defaults == nullptr ? card : builder.card_of(*defaults)) {}

  /// EID PID GA GB X1 X2 X3 OFFT / PA PB W1A W2A W3A W1B W2B W3B.
  BeamElement read(std::string_view kinds) {
    BeamElement beam;
    beam.card = card_.name();
    beam.id = card_.id(1, "EID");
    beam.has_torsional_inertia = card_.name() != "CBAR";
    const Card& property = card_.is_blank(2) ? defaults_ : card_;
    beam.property = builder_.property<int>(card_, property.is_blank(2) ? beam.id : property.id(2, "PID"), kinds);
    nodes_ = {builder_.grid(card_, 3, "GA"), builder_.grid(card_, 4, "GB")};
    beam.nodes = nodes_;
    if (nodes_[0] == nodes_[1]) card_.fail("GA and GB are the same grid point");
    read_offset_type();
    beam.orientation = orientation();
    beam.pins = {card_.components(9, "PA"), card_.components(10, "PB")};
    beam.offsets = {offset(0, 11, beam.orientation), offset(1, 14, beam.orientation)};
    require_axes(position(1) + beam.offsets[1] - position(0) - beam.offsets[0], beam.orientation);
    return beam;
  }

 private:
  Eigen::Vector3d position(std::size_t end) const { return builder_.position(nodes_[end]); }

  /// "GGO": system of the orientation vector (G: displacement system of GA, B: basic), of the offsets at A and B
  /// (G: displacement system of that end, O: along the beam). Old decks have a CBAR's flag F there: 1 where a vector
  /// stands in fields 5 to 7, 2 where field 5 names a grid point.
  void read_offset_type() {
    const std::string_view text = card_.is_blank(8) ? defaults_.at(8) : card_.at(8);
    if (text.empty()) return;
    if (card_.name() == "CBAR" && (text == "1" || text == "2")) {
      orientation_flag_ = text[0];
      return;
    }
    const bool is_known = text.size() == 3 && (text[0] == 'G' || text[0] == 'B') &&
                          (text[1] == 'G' || text[1] == 'O') && (text[2] == 'G' || text[2] == 'O');
    if (!is_known) {
      card_.fail(fmt::format("OFFT is '{}'; allowed are GGG, BGG, GGO, BGO, GOG, BOG, GOO, BOO", shown(text)));
    }
    offset_type_ = text;
  }

  Eigen::Vector3d orientation() {
    const Card& source = card_.has_any(5, 7) ? card_ : defaults_;
    const bool is_grid_alone = source.is_integer(5) && !source.has_any(6, 7);
    if (orientation_flag_ == '2' || (orientation_flag_ == ' ' && is_grid_alone)) {
      const int other = builder_.grid(source, 5, "G0");
      return builder_.position(other) - position(0);
    }
    if (!source.has_any(5, 7)) card_.fail("X1, X2, X3 (or G0) are blank; the orientation vector is needed");
    const Eigen::Vector3d given(builder_.real(source, 5, "X1", 0.0), builder_.real(source, 6, "X2", 0.0),
                                builder_.real(source, 7, "X3", 0.0));
    return offset_type_[0] == 'B' ? given : Eigen::Vector3d(builder_.displacement_axes(nodes_[0]) * given);
  }

  Eigen::Vector3d offset(std::size_t end, int n, const Eigen::Vector3d& v) {
    Eigen::Vector3d given(builder_.real(card_, n, "W1", 0.0), builder_.real(card_, n + 1, "W2", 0.0),
                          builder_.real(card_, n + 2, "W3", 0.0));
    if (given.isZero(0.0)) return given;
    if (offset_type_[1 + end] == 'G') return builder_.displacement_axes(nodes_[end]) * given;
    const Eigen::Vector3d x = position(1) - position(0);
    require_axes(x, v);
    Eigen::Matrix3d axes;
    axes.col(0) = x.normalized();
    axes.col(2) = axes.col(0).cross(v).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    return axes * given;
  }

  void require_axes(const Eigen::Vector3d& x, const Eigen::Vector3d& v) const {
    constexpr double k_parallel = 1e-6;  // sine of the angle below which the fem layer finds no plane either
    const double size = position(0).norm() + position(1).norm();
    if (!(x.norm() > 1e-12 * size)) card_.fail("the beam has no length");
    if (!(x.normalized().cross(v).norm() > k_parallel * v.norm())) {
      card_.fail("the orientation vector is zero or parallel to the beam");
    }
  }

  ModelBuilder& builder_;
  const Card& card_;
  const Card defaults_;  ///< the card itself where there are none
  std::array<int, 2> nodes_ = {-1, -1};
  std::string offset_type_ = "GGG";
  char orientation_flag_ = ' ';
};

void read_cbar(ModelBuilder& builder, const Card& card) {
  if (!builder.is_first(card, card.id(1, "EID"))) return;
  BeamReader reader(builder, card, builder.bar_defaults);
  builder.add_element(card, reader.read("PBAR or PBARL"));
}

void read_cbeam(ModelBuilder& builder, const Card& card) {
  if (!builder.is_first(card, card.id(1, "EID"))) return;
  if (card.has_any(17, 18)) builder.count("{} CBEAM cards name warping points (SA, SB), which were ignored");
  BeamReader reader(builder, card, builder.beam_defaults);
  builder.add_element(card, reader.read("PBEAM or PBEAML"));
}

constexpr std::array<CardRule, 4> k_beam_rules = {{
    {"BAROR", Phase::defaults, read_baror, 8},
    {"BEAMOR", Phase::defaults, read_beamor, 8},
    {"CBAR", Phase::elements, read_cbar, 16},
    {"CBEAM", Phase::elements, read_cbeam, 18},
}};

}  // namespace

CardFamily beam_cards() {
  return {"CBAR, CBEAM", k_beam_rules};
}

}  // namespace mottle::formats::nastran
