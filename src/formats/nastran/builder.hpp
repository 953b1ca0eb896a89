// State shared by the card readers while a model is built: the model, tables from ids to indices, and the rules that
// say which function reads which card, and in which phase.
#pragma once

#include <any>
#include <array>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "formats/nastran/fields.hpp"
#include "mottle/formats/nastran/model.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats::nastran {

/// GRID or SPOINT before coordinate systems are known.
struct RawPoint {
  int id = 0;
  Eigen::Vector3d coordinates = Eigen::Vector3d::Zero();
  int position_system = 0, displacement_system = 0;
  Components fixed = 0;
  bool is_scalar = false;
  const BulkCard* card = nullptr;
};

/// CORD1x or CORD2x before it is resolved.
struct RawSystem {
  int id = 0;
  CoordinateSystem::Kind kind = CoordinateSystem::Kind::rectangular;
  bool is_by_grids = false;
  int reference = 0;                           ///< CORD2x: RID
  std::array<Eigen::Vector3d, 3> points = {};  ///< CORD2x: A, B, C
  std::array<int, 3> grids = {};               ///< CORD1x: G1, G2, G3
  const BulkCard* card = nullptr;
};

/// Kinds of ids that several cards share; a card of its own kind uses its rule's number instead.
enum class IdSpace : int {
  own = -1,
  bar_property = 100000,
  beam_property,
  rod_property,
  shell_property,
  material,
  point,
  coordinate_system,
  method
};

/// Kinds of material that a card may refer to.
struct MaterialChoice {
  std::span<const Material::Kind> kinds;
  std::string_view names;  ///< "MAT1, MAT2 or MAT8"
};
MaterialChoice isotropic_materials();
MaterialChoice shell_materials();
MaterialChoice solid_materials();

/// Cards that give a shell its property, for ModelBuilder::properties.
inline constexpr std::string_view k_shell_properties = "PSHELL, PCOMP or PCOMPG";

/// A card cannot be used, because what it refers to is a property or a material that no rule reads.
struct UnreadReference : std::exception {
  const BulkCard* unread = nullptr;    ///< what no rule reads
  const BulkCard* property = nullptr;  ///< that names the material; none: the card itself does

  const char* what() const noexcept override { return "refers to a card that is not read"; }
};

class ModelBuilder {
 public:
  ModelBuilder(const NastranDeck& the_deck, const NastranOptions& the_options)
      : deck(the_deck), options(the_options), model(result.model) {}
  ModelBuilder(const ModelBuilder&) = delete;
  ModelBuilder& operator=(const ModelBuilder&) = delete;

  const NastranDeck& deck;
  const NastranOptions& options;
  NastranModel result;
  FiniteElementModel& model;

  /// EIGRL, EIGR.
  struct Method {
    int id = 0;
    double lowest = -1.0, highest = -1.0;  ///< Hz; negative: not given
    int modes = 0;
  };

  std::vector<Method> methods;
  std::vector<int> node_ids;  ///< ascending, as model.nodes
  std::vector<RawPoint> raw_points;
  std::vector<RawSystem> raw_systems;
  std::unordered_map<int, int> systems, materials;
  std::unordered_map<int, UnreadReference> unread_properties, unread_materials;  ///< by id
  const BulkCard* grid_defaults = nullptr;
  const BulkCard* bar_defaults = nullptr;
  const BulkCard* beam_defaults = nullptr;
  std::unordered_set<int> spc_sets, mpc_sets;            ///< the selected ones
  std::vector<Components> fixed;                         ///< of every node
  std::vector<std::pair<int, Components>> boundary_set;  ///< BSET, CSET, SUPORT: part of any analysis set
  bool has_component_modes = false;                      ///< QSET
  int subcase = -1;                                      ///< index into deck.subcases
  int rule = 0;                                          ///< number of the rule that is at work
  int points_of_ranges = 0;                              ///< that SPOINT cards made by THRU
  int unknown_kinds = 0;                                 ///< of cards so far
  std::int64_t listed_points = 0;                        ///< by THRU ranges so far

  Card card_of(const BulkCard& card) const { return {deck, card}; }
  void note(std::string text) { result.notes.push_back(std::move(text)); }
  /// Counts what is worth one note at the end: "{} ...".
  void count(const std::string& message, int times = 1) { counts_[message] += times; }
  void write_counted_notes();

  FieldIndex add_field(std::string_view card, int id, std::string_view name, double value);
  /// A field for the number in field n, k_no_field where it is blank. `id` is that of the card.
  FieldIndex read_field(const Card& card, int n, std::string_view name, int id);
  double real(const Card& card, int n, std::string_view what, double otherwise);

  /// Whether this is the first card with that id. False, with a note, where it repeats an earlier one word for word.
  /// Compares the fields first..first + count - 1 (count -1: all). @throws FormatError where the two differ.
  bool is_first(const Card& card, int id, IdSpace space = IdSpace::own, int first = 1, int count = -1);

  /// Index of the node that field n names. @throws FormatError where there is none
  int node(const Card& card, int n, std::string_view what) const;
  int find_node(int id) const;
  /// Index of a coordinate system, -1 for basic (0 or blank).
  int system(const Card& card, int n, std::string_view what) const;
  /// Index of the material that field n names. @throws FormatError where there is none, or one of another kind
  /// @throws UnreadReference  no rule reads it
  int material(const Card& card, int n, std::string_view what,
               const MaterialChoice& choice = isotropic_materials()) const;
  /// Axes (columns) of the displacement system of a node.
  Eigen::Matrix3d displacement_axes(int node) const;
  /// Axes of a coordinate system (index, -1: basic) at a point.
  Eigen::Matrix3d axes_at(int system, const Eigen::Vector3d& position) const;
  const Eigen::Vector3d& position(int node) const { return model.nodes[static_cast<std::size_t>(node)].position; }
  /// Refuses scalar points where a grid point is needed.
  int grid(const Card& card, int n, std::string_view what) const;
  /// Reads grid points from fields first.. into nodes; refuses one that stands twice.
  void read_corners(const Card& card, int first, int count, int* nodes) const;
  /// Reads nodes[corners..count - 1] from the fields after the corners', -1 where they are left out.
  void read_middles(const Card& card, int first, int corners, int count, int* nodes) const;
  template <typename Element>
  void add_element(const Card& card, Element element) {
    model.elements<Element>().push_back(std::move(element));
    count_element(card);
  }
  void count_element(const Card& card) { ++result.element_counts[std::string(card.name())]; }

  /// Properties by id, of the cards that `kinds` names ("PBAR or PBARL"): what their readers leave for those of
  /// elements.
  template <typename Property>
  std::unordered_map<int, Property>& properties(std::string_view kinds) {
    using Table = std::unordered_map<int, Property>;
    const auto found = properties_.find(kinds);
    if (found != properties_.end()) return *std::any_cast<Table>(&found->second);
    return *std::any_cast<Table>(&properties_.emplace(kinds, Table()).first->second);
  }
  /// The property with that id; refuses one that does not exist. @throws UnreadReference  no rule reads it
  template <typename Property>
  const Property& property(const Card& card, int id, std::string_view kinds) {
    const auto& table = properties<Property>(kinds);
    const auto found = table.find(id);
    if (found == table.end()) refuse_property(card, id, kinds);
    return found->second;
  }

 private:
  void read_corner(const Card& card, int first, int i, int* nodes) const;
  [[noreturn]] void refuse_property(const Card& card, int id, std::string_view kinds) const;

  struct Claim {
    const BulkCard* card = nullptr;
    int first = 1;
  };

  std::map<std::string, int> counts_;
  std::unordered_map<std::uint64_t, Claim> claims_;
  std::map<std::string, std::any, std::less<>> properties_;
};

/// When a card is read. A card may use what an earlier phase read.
enum class Phase : std::uint8_t { defaults, points, materials, properties, elements, constraints, settings };
inline constexpr int k_phases = 7;

struct CardRule {
  std::string_view name;
  Phase phase;
  void (*read)(ModelBuilder&, const Card&);
  int max_fields = 0;                    ///< that the card may have; 0: any number
  std::string_view design_numbers = {};  ///< that models are usually wrong in: "A I1 I2 J", "DIM*"
};

/// After Phase::points: sorts the points, resolves the systems and computes the nodes' positions.
void resolve_points(ModelBuilder& builder);
/// Before Phase::constraints: which SPC and MPC sets hold.
void select_constraint_sets(ModelBuilder& builder);
/// After Phase::constraints: model.fixed from builder.fixed.
void write_fixed(ModelBuilder& builder);
/// After Phase::constraints: which degrees of freedom a static reduction keeps.
void write_reduction(ModelBuilder& builder);
/// After Phase::settings: what the case control section says about the solution.
void read_case_settings(ModelBuilder& builder);

/// Cards of one name that no rule reads.
struct UnreadCards {
  const BulkCard* first = nullptr;
  int count = 0;
  std::string user = {};  ///< the first element that needs them; empty: they change the model by themselves
};

/// Keeps a card that no rule reads for UnreadReference, if it is a property or a material.
void remember_unread(ModelBuilder& builder, const BulkCard& card);
/// Those of the cards that no rule reads which change the model by themselves; the others are skipped, with notes.
std::vector<UnreadCards> find_refused_cards(ModelBuilder& builder, std::span<const UnreadCards> unread);
/// Refuses all of them in one message; does nothing where there is none.
void refuse(const ModelBuilder& builder, std::vector<UnreadCards> refused);
/// Refuses case control commands that change the matrices in a way that is not supported.
void refuse_matrix_commands(ModelBuilder& builder);

}  // namespace mottle::formats::nastran
