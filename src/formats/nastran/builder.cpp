#include "formats/nastran/builder.hpp"

#include <algorithm>

#include "formats/nastran/rows.hpp"

namespace mottle::formats::nastran {
namespace {

constexpr std::array<std::string_view, 20> k_node_names = {"G1",  "G2",  "G3",  "G4",  "G5",  "G6",  "G7",
                                                           "G8",  "G9",  "G10", "G11", "G12", "G13", "G14",
                                                           "G15", "G16", "G17", "G18", "G19", "G20"};

constexpr std::array<std::string_view, 4> k_material_cards = {"MAT1", "MAT2", "MAT8", "MAT9"};  // as Material::Kind

bool is_same_field(std::string_view a, std::string_view b) {
  double value_a = 0.0;
  double value_b = 0.0;
  return a == b || (parse_real(a, value_a) && parse_real(b, value_b) && value_a == value_b);
}

}  // namespace

MaterialChoice isotropic_materials() {
  static constexpr std::array k_kinds = {Material::Kind::isotropic};
  return {k_kinds, "MAT1"};
}

MaterialChoice shell_materials() {
  static constexpr std::array k_kinds = {Material::Kind::isotropic, Material::Kind::anisotropic_shell,
                                         Material::Kind::orthotropic_shell};
  return {k_kinds, "MAT1, MAT2 or MAT8"};
}

MaterialChoice solid_materials() {
  static constexpr std::array k_kinds = {Material::Kind::isotropic, Material::Kind::anisotropic_solid};
  return {k_kinds, "MAT1 or MAT9"};
}

void ModelBuilder::write_counted_notes() {
  for (const auto& [message, times] : counts_) note(fmt::format(fmt::runtime(message), times));
}

FieldIndex ModelBuilder::add_field(std::string_view card, int id, std::string_view name, double value) {
  model.fields.push_back({std::string(card), id, std::string(name), value});
  return static_cast<FieldIndex>(model.fields.size()) - 1;
}

double ModelBuilder::real(const Card& card, int n, std::string_view what, double otherwise) {
  if (card.is_integer(n) && card.at(n) != "0")
    count("{} integers were read where a real number (with a point) belongs");
  return card.real_or(n, what, otherwise);
}

FieldIndex ModelBuilder::read_field(const Card& card, int n, std::string_view name, int id) {
  return card.is_blank(n) ? k_no_field : add_field(card.name(), id, name, real(card, n, name, 0.0));
}

bool ModelBuilder::is_first(const Card& card, int id, IdSpace space, int first, int count_of_fields) {
  const int kind = space == IdSpace::own ? rule : static_cast<int>(space);
  const std::uint64_t key = (static_cast<std::uint64_t>(kind) << 32U) | static_cast<std::uint32_t>(id);
  const auto [found, is_new] = claims_.try_emplace(key, Claim{&card.bulk(), first});
  if (is_new) return true;
  const Card earlier = card_of(*found->second.card);
  const int fields = count_of_fields < 0 ? std::max(card.size(), earlier.size()) : count_of_fields;
  bool is_same = earlier.name() == card.name();
  for (int i = 0; is_same && i < fields; ++i) {
    is_same = is_same_field(card.at(first + i), earlier.at(found->second.first + i));
  }
  if (!is_same) {
    card.fail(fmt::format("id {} is used already by {} at {}, with other content; ids must be unique", id,
                          earlier.name(), earlier.location()));
  }
  count(fmt::format("{{}} {} cards stand twice with equal content; read once", card.name()));
  return false;
}

int ModelBuilder::find_node(int id) const {
  const auto found = std::lower_bound(node_ids.begin(), node_ids.end(), id);
  return found != node_ids.end() && *found == id ? static_cast<int>(found - node_ids.begin()) : -1;
}

int ModelBuilder::node(const Card& card, int n, std::string_view what) const {
  const int id = card.id(n, what);
  const int index = find_node(id);
  if (index < 0) card.fail(fmt::format("{} is {}, but no GRID or SPOINT card has that id", what, id));
  return index;
}

int ModelBuilder::grid(const Card& card, int n, std::string_view what) const {
  const int index = node(card, n, what);
  if (model.nodes[static_cast<std::size_t>(index)].is_scalar) {
    card.fail(fmt::format("{} is {}, a scalar point; a grid point is needed", what, shown(card.at(n))));
  }
  return index;
}

void ModelBuilder::read_corners(const Card& card, int first, int count_of_nodes, int* nodes) const {
  for (int i = 0; i < count_of_nodes; ++i) read_corner(card, first, i, nodes);
}

void ModelBuilder::read_middles(const Card& card, int first, int corners, int count_of_nodes, int* nodes) const {
  for (int i = corners; i < count_of_nodes; ++i) {
    nodes[i] = -1;
    if (!card.is_blank(first + i) && card.at(first + i) != "0") read_corner(card, first, i, nodes);
  }
}

void ModelBuilder::read_corner(const Card& card, int first, int i, int* nodes) const {
  nodes[i] = grid(card, first + i, k_node_names[static_cast<std::size_t>(i)]);
  for (int j = 0; j < i; ++j) {
    if (nodes[j] == nodes[i]) {
      card.fail(fmt::format("G{} and G{} are both grid point {}; every corner needs its own", j + 1, i + 1,
                            shown(card.at(first + i))));
    }
  }
}

int ModelBuilder::system(const Card& card, int n, std::string_view what) const {
  const int id = card.integer_or(n, what, 0);
  if (id == 0) return -1;
  const auto found = systems.find(id);
  if (found == systems.end()) card.fail(fmt::format("{} is {}, but no CORD card has that id", what, id));
  return found->second;
}

int ModelBuilder::material(const Card& card, int n, std::string_view what, const MaterialChoice& choice) const {
  const int id = card.id(n, what);
  const auto found = materials.find(id);
  if (const auto unread = unread_materials.find(id); found == materials.end() && unread != unread_materials.end()) {
    throw UnreadReference(unread->second);
  }
  if (found == materials.end()) card.fail(fmt::format("{} is {}, but no {} card has that id", what, id, choice.names));
  const Material::Kind kind = model.materials[static_cast<std::size_t>(found->second)].kind;
  if (std::ranges::find(choice.kinds, kind) == choice.kinds.end()) {
    card.fail(fmt::format("{} is {}, a {}; {} is needed here", what, id,
                          k_material_cards[static_cast<std::size_t>(kind)], choice.names));
  }
  return found->second;
}

void ModelBuilder::refuse_property(const Card& card, int id, std::string_view kinds) const {
  if (const auto unread = unread_properties.find(id); unread != unread_properties.end()) {
    throw UnreadReference(unread->second);
  }
  card.fail(fmt::format("property {} has no {} card", id, kinds));
}

Eigen::Matrix3d ModelBuilder::axes_at(int system_index, const Eigen::Vector3d& point) const {
  if (system_index < 0) return Eigen::Matrix3d::Identity();
  return model.coordinate_systems[static_cast<std::size_t>(system_index)].directions_at(point);
}

Eigen::Matrix3d ModelBuilder::displacement_axes(int node_index) const {
  const Node& at = model.nodes[static_cast<std::size_t>(node_index)];
  return axes_at(at.displacement_system, at.position);
}

}  // namespace mottle::formats::nastran
