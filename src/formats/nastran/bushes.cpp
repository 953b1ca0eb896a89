// PBUSH, CBUSH.
#include <Eigen/Geometry>
#include <array>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"
#include "formats/nastran/rows.hpp"

namespace mottle::formats::nastran {
namespace {

struct BushProperty {
  std::array<FieldIndex, 6> stiffness = {-1, -1, -1, -1, -1, -1};
  std::array<FieldIndex, 6> damping = {-1, -1, -1, -1, -1, -1};
};

void read_six(ModelBuilder& builder, const Card& card, int first, char letter, int id,
              std::array<FieldIndex, 6>& fields) {
  for (std::size_t i = 0; i < 6; ++i) {
    const int n = first + static_cast<int>(i);
    if (fields[i] != k_no_field) card.fail(fmt::format("{}{} is given twice", letter, i + 1));
    if (card.at(n) == "RIGID") card.fail(fmt::format("{}{} is RIGID, which is not supported; use RBE2", letter, i + 1));
    fields[i] = builder.read_field(card, n, fmt::format("{}{}", letter, i + 1), id);
  }
}

/// PID flag v1..v6, then lines of: - flag v1..v6.
void read_pbush(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "PID");
  if (!builder.is_first(card, id)) return;
  BushProperty property;
  for (int row = 0; row < card.size(); row += 8) {
    const std::string_view flag = card.at(row + 2);
    if (flag == "K") {
      read_six(builder, card, row + 3, 'K', id, property.stiffness);
    } else if (flag == "B") {
      read_six(builder, card, row + 3, 'B', id, property.damping);
    } else if (flag == "M") {
      card.require_absent(row + 3, "M", "the mass of a bush is not supported; use CONM2");
    } else if (flag == "GE") {
      builder.count("{} PBUSH lines of structural damping (GE) were ignored");
    } else if (flag != "RCV" && flag != "T" && flag != "A" && card.has_any(row + 2, row + 8)) {
      card.fail(fmt::format("'{}' stands where K, B, GE, M or RCV must", shown(flag)));
    }
  }
  builder.properties<BushProperty>("PBUSH")[id] = property;
}

/// Reads EID PID GA GB G0/X1 X2 X3 CID / S OCID S1 S2 S3.
class BushReader {
 public:
  BushReader(ModelBuilder& builder, const Card& card) : builder_(builder), card_(card) {}

  BushElement read() {
    BushElement bush;
    bush.id = card_.id(1, "EID");
    const int id = card_.is_blank(2) ? bush.id : card_.id(2, "PID");
    const BushProperty& property = builder_.property<BushProperty>(card_, id, "PBUSH");
    bush.stiffness = property.stiffness;
    bush.damping = property.damping;
    bush.nodes[0] = builder_.grid(card_, 3, "GA");
    if (!card_.is_blank(4)) bush.nodes[1] = builder_.grid(card_, 4, "GB");
    if (bush.nodes[0] == bush.nodes[1]) card_.fail("GA and GB are the same grid point");
    a_ = builder_.position(bush.nodes[0]);
    b_ = bush.nodes[1] < 0 ? a_ : builder_.position(bush.nodes[1]);
    bush.axes = axes(bush.nodes[0], needs_plane(property));
    bush.location = location();
    if (!bush.location.allFinite()) card_.fail("S1, S2, S3 are too large");
    return bush;
  }

 private:
  /// Whether the property acts across the axis, so that the second axis matters.
  static bool needs_plane(const BushProperty& property) {
    for (const std::size_t i : {1U, 2U, 4U, 5U}) {
      if (property.stiffness[i] != k_no_field || property.damping[i] != k_no_field) return true;
    }
    return false;
  }

  Eigen::Matrix3d axes(int node_a, bool is_plane_needed) {
    if (!card_.is_blank(8)) return builder_.axes_at(builder_.system(card_, 8, "CID"), a_);
    constexpr double k_coincident = 1e-4;  // as Nastran has it, in the deck's unit of length
    const Eigen::Vector3d along = b_ - a_;
    if (!(along.norm() >= k_coincident)) {
      card_.fail("GA and GB lie at the same place (closer than .0001), or GB is grounded; CID is needed for its axes");
    }
    const Eigen::Vector3d x = along.normalized();
    const Eigen::Vector3d v = orientation(node_a, x, is_plane_needed);
    if (!(x.cross(v).norm() > 1e-6 * v.norm())) card_.fail("the orientation vector is zero or parallel to the bush");
    Eigen::Matrix3d result;
    result.col(0) = x;
    result.col(2) = x.cross(v).normalized();
    result.col(1) = result.col(2).cross(x);
    return result;
  }

  Eigen::Vector3d orientation(int node_a, const Eigen::Vector3d& x, bool is_plane_needed) {
    if (card_.is_integer(5) && !card_.has_any(6, 7)) return builder_.position(builder_.grid(card_, 5, "G0")) - a_;
    if (card_.has_any(5, 7)) {
      return builder_.displacement_axes(node_a) * Eigen::Vector3d(builder_.real(card_, 5, "X1", 0.0),
                                                                  builder_.real(card_, 6, "X2", 0.0),
                                                                  builder_.real(card_, 7, "X3", 0.0));
    }
    if (is_plane_needed)
      card_.fail("G0, X1.. and CID are blank, which is allowed only where K1, K4, B1, B4 alone are given");
    return x.unitOrthogonal();
  }

  Eigen::Vector3d location() {
    const int system = card_.integer_or(10, "OCID", -1);
    if (system < -1) card_.fail(fmt::format("OCID is {}, an id or -1 is needed", system));
    if (system == -1) {
      const double fraction = builder_.real(card_, 9, "S", 0.5);
      if (fraction < 0.0 || fraction > 1.0) card_.fail(fmt::format("S is {}, it must lie in [0, 1]", fraction));
      return a_ + fraction * (b_ - a_);
    }
    return a_ + builder_.axes_at(builder_.system(card_, 10, "OCID"), a_) *
                    Eigen::Vector3d(builder_.real(card_, 11, "S1", 0.0), builder_.real(card_, 12, "S2", 0.0),
                                    builder_.real(card_, 13, "S3", 0.0));
  }

  ModelBuilder& builder_;
  const Card& card_;
  Eigen::Vector3d a_ = Eigen::Vector3d::Zero(), b_ = Eigen::Vector3d::Zero();
};

void read_cbush(ModelBuilder& builder, const Card& card) {
  if (!builder.is_first(card, card.id(1, "EID"))) return;
  builder.add_element(card, BushReader(builder, card).read());
}

constexpr std::array<CardRule, 2> k_bush_rules = {{
    {"PBUSH", Phase::properties, read_pbush, 0, "K1 K2 K3 K4 K5 K6"},
    {"CBUSH", Phase::elements, read_cbush, 13},
}};

}  // namespace

CardFamily bush_cards() {
  return {"CBUSH", k_bush_rules};
}

}  // namespace mottle::formats::nastran
