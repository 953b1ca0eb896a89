// CONM1, CONM2.
#include <algorithm>
#include <array>
#include <cmath>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"

namespace mottle::formats::nastran {
namespace {

/// Refuses an inertia about the centre of gravity that some rotation makes negative: a principal minor of
///   [I11 -I21 -I31; -I21 I22 -I32; -I31 -I32 I33]
/// is below zero by more than the digits of a field leave open.
void require_positive_inertia(const ModelBuilder& builder, const Card& card, const PointMassElement& mass) {
  constexpr double k_rounding = 1e-6;  // relative; small fields hold seven digits
  std::array<double, 6> number;
  double largest = 0.0;
  for (std::size_t i = 0; i < 6; ++i) {
    number[i] = builder.model.value(mass.inertia[i], 0.0);
    largest = std::max(largest, std::abs(number[i]));
  }
  if (largest == 0.0) return;
  for (double& entry : number) entry /= largest;
  const auto [i11, i21, i22, i31, i32, i33] = number;
  const double determinant =
      i11 * i22 * i33 - 2.0 * i21 * i31 * i32 - i11 * i32 * i32 - i22 * i31 * i31 - i33 * i21 * i21;
  const double lowest =
      std::min({i11, i22, i33, i11 * i22 - i21 * i21, i11 * i33 - i31 * i31, i22 * i33 - i32 * i32, determinant});
  if (lowest < -k_rounding) {
    card.fail("its inertia I11 I21 I22 I31 I32 I33 is not positive semidefinite: some rotation has negative energy");
  }
}

/// EID G CID M X1 X2 X3 - / I11 I21 I22 I31 I32 I33. CID -1: X is the centre of gravity itself, in basic coordinates.
void read_conm2(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  PointMassElement mass;
  mass.card = card.name();
  mass.id = id;
  mass.node = builder.grid(card, 2, "G");
  const Eigen::Vector3d position = builder.position(mass.node);
  const Eigen::Vector3d x(builder.real(card, 5, "X1", 0.0), builder.real(card, 6, "X2", 0.0),
                          builder.real(card, 7, "X3", 0.0));
  if (card.integer_or(3, "CID", 0) == -1) {
    mass.offset = x - position;
  } else {
    mass.axes = builder.axes_at(builder.system(card, 3, "CID"), position);
    mass.offset = x;
  }
  mass.mass = builder.read_field(card, 4, "M", id);
  constexpr std::array<std::string_view, 6> k_names = {"I11", "I21", "I22", "I31", "I32", "I33"};
  for (std::size_t i = 0; i < 6; ++i) {
    mass.inertia[i] = builder.read_field(card, 9 + static_cast<int>(i), k_names[i], id);
  }
  require_positive_inertia(builder, card, mass);
  builder.add_element(card, std::move(mass));
}

/// EID G CID M11 M21 M22 M31 ... M66, by rows of the lower triangle.
void read_conm1(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "EID");
  if (!builder.is_first(card, id)) return;
  PointMassElement mass;
  mass.card = card.name();
  mass.id = id;
  mass.node = builder.grid(card, 2, "G");
  mass.axes = builder.axes_at(builder.system(card, 3, "CID"), builder.position(mass.node));
  int n = 4;
  for (int row = 1; row <= 6; ++row) {
    for (int column = 1; column <= row; ++column) {
      mass.matrix.push_back(builder.read_field(card, n++, fmt::format("M{}{}", row, column), id));
    }
  }
  builder.add_element(card, std::move(mass));
}

constexpr std::array<CardRule, 2> k_point_mass_rules = {{
    {"CONM1", Phase::elements, read_conm1, 24},
    {"CONM2", Phase::elements, read_conm2, 14, "M"},
}};

}  // namespace

CardFamily point_mass_cards() {
  return {"CONM1, CONM2", k_point_mass_rules};
}

}  // namespace mottle::formats::nastran
