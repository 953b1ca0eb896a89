// MAT1, MAT2, MAT8, MAT9; every other material is refused.
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"
#include "mottle/core/error.hpp"
#include "mottle/fem/elements/laminate.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::formats::nastran {
namespace {

void keep(ModelBuilder& builder, const Card& card, Material material) {
  if (builder.model.value(material.density) < 0.0) card.fail("RHO is negative");
  builder.materials[material.id] = static_cast<int>(builder.model.materials.size());
  builder.model.materials.push_back(std::move(material));
}

void read_mat1(ModelBuilder& builder, const Card& card) {
  const int id = card.id(1, "MID");
  if (!builder.is_first(card, id, IdSpace::material)) return;
  Material material;
  material.id = id;
  material.young = builder.read_field(card, 2, "E", id);
  material.shear = builder.read_field(card, 3, "G", id);
  material.poisson = builder.read_field(card, 4, "NU", id);
  material.density = builder.read_field(card, 5, "RHO", id);
  if (material.young == k_no_field && material.shear == k_no_field) card.fail("E and G are both blank, one is needed");
  const double poisson = builder.model.value(material.poisson, 0.0);
  // With E and G given bars need no NU, whatever stands there; shells and solids test it themselves.
  const bool is_needed = material.young == k_no_field || material.shear == k_no_field;
  if (is_needed && (poisson <= -1.0 || poisson > 0.5))
    card.fail(fmt::format("NU is {}, it must lie in (-1, 0.5] unless E and G are both given", poisson));
  if (builder.model.value(material.young) < 0.0) card.fail("E is negative");
  if (builder.model.value(material.shear) < 0.0) card.fail("G is negative");
  keep(builder, card, std::move(material));
}

/// MID, the moduli one after the other (blank ones are left out), RHO; nothing where the card repeats another one.
std::optional<Material> read_by_moduli(ModelBuilder& builder, const Card& card, Material::Kind kind,
                                       std::span<const std::string_view> names) {
  const int id = card.id(1, "MID");
  if (!builder.is_first(card, id, IdSpace::material)) return std::nullopt;
  Material material{.id = id, .kind = kind};
  int field = 2;
  for (const std::string_view name : names) material.moduli.push_back(builder.read_field(card, field++, name, id));
  material.density = builder.read_field(card, field, "RHO", id);
  return material;
}

/// Refuses moduli by which some strain would give energy away.
void require_semidefinite(const ModelBuilder& builder, const Card& card, const Material& material, int size) {
  Eigen::MatrixXd matrix(size, size);
  auto next = material.moduli.begin();
  for (int i = 0; i < size; ++i) {
    for (int j = i; j < size; ++j) matrix(i, j) = matrix(j, i) = builder.model.value(*next++);
  }
  const Eigen::VectorXd eigenvalues = SymmetricEigen(matrix).eigenvalues();
  if (eigenvalues(size - 1) > 0.0 && eigenvalues(0) >= -1e-9 * eigenvalues(size - 1)) return;
  card.fail(
      fmt::format("the matrix of G11, G12... has the eigenvalues {:.4g} to {:.4g}; none may be negative, and not "
                  "all zero",
                  eigenvalues(0), eigenvalues(size - 1)));
}

/// MID G11 G12 G13 G22 G23 G33 RHO / A1 ... SS / MCSID.
void read_mat2(ModelBuilder& builder, const Card& card) {
  static constexpr std::string_view k_names[] = {"G11", "G12", "G13", "G22", "G23", "G33"};
  std::optional<Material> material = read_by_moduli(builder, card, Material::Kind::anisotropic_shell, k_names);
  if (!material) return;
  require_semidefinite(builder, card, *material, 3);
  keep(builder, card, *std::move(material));
}

/// MID E1 E2 NU12 G12 G1Z G2Z RHO / A1 A2 TREF Xt Xc Yt Yc S / GE F12 STRN.
void read_mat8(ModelBuilder& builder, const Card& card) {
  static constexpr std::string_view k_names[] = {"E1", "E2", "NU12", "G12", "G1Z", "G2Z"};
  std::optional<Material> material = read_by_moduli(builder, card, Material::Kind::orthotropic_shell, k_names);
  if (!material) return;
  const auto at = [&](std::size_t i) { return builder.model.value(material->moduli[i]); };
  try {
    orthotropic_plane_stress(at(0), at(1), at(2), at(3));
  } catch (const InvalidInput& error) {
    card.fail(error.what());
  }
  for (const std::size_t i : {4U, 5U}) {
    if (at(i) < 0.0) card.fail(fmt::format("{} is negative", k_names[i]));
  }
  keep(builder, card, *std::move(material));
}

/// MID G11 G12 ... G66 (the upper triangle by rows, 21 numbers) RHO / A1...
void read_mat9(ModelBuilder& builder, const Card& card) {
  static constexpr std::string_view k_names[] = {"G11", "G12", "G13", "G14", "G15", "G16", "G22",
                                                 "G23", "G24", "G25", "G26", "G33", "G34", "G35",
                                                 "G36", "G44", "G45", "G46", "G55", "G56", "G66"};
  std::optional<Material> material = read_by_moduli(builder, card, Material::Kind::anisotropic_solid, k_names);
  if (!material) return;
  require_semidefinite(builder, card, *material, 6);
  keep(builder, card, *std::move(material));
}

constexpr std::array<CardRule, 4> k_material_rules = {{
    {"MAT1", Phase::materials, read_mat1, 12, "E G RHO"},
    {"MAT2", Phase::materials, read_mat2, 17, "G11 G22 G33 RHO"},
    {"MAT8", Phase::materials, read_mat8, 0, "E1 E2 G12 G1Z G2Z RHO"},
    {"MAT9", Phase::materials, read_mat9, 32, "G11 G22 G33 G44 G55 G66 RHO"},
}};

}  // namespace

CardFamily material_cards() {
  return {"MAT1, MAT2, MAT8, MAT9", k_material_rules};
}

}  // namespace mottle::formats::nastran
