// GENEL.
#include <array>
#include <bit>
#include <set>
#include <utility>
#include <vector>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"
#include "formats/nastran/rows.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::formats::nastran {
namespace {

/// EID - UI1 CI1 UI2 CI2 ... / UD - UD1 CD1 ... / K or Z: lower triangle by columns / S: by rows, each from a line's
/// first field on.
class GeneralElementReader {
 public:
  GeneralElementReader(ModelBuilder& builder, const Card& card) : builder_(builder), card_(card) {}

  GeneralElement read() {
    element_.id = card_.id(1, "EID");
    find_parts();
    read_degrees_of_freedom({"UI", 1, parts_.empty() ? card_.size() : parts_.front().first - 1});
    const int independent = static_cast<int>(element_.nodes.size());
    if (independent == 0) card_.fail("UI1 and CI1 are blank, a degree of freedom is needed");
    if (const Part* dependents = part("UD")) read_degrees_of_freedom(*dependents);
    const int dependent = static_cast<int>(element_.nodes.size()) - independent;
    constexpr int k_max_size = 4000;
    if (independent + dependent > k_max_size) {
      card_.fail(fmt::format("has {} degrees of freedom; at most {} are allowed", independent + dependent, k_max_size));
    }
    read_stiffness(independent);
    read_rigid_motion(independent, dependent);
    return std::move(element_);
  }

 private:
  /// A part of the card: fields behind the letters that begin it.
  struct Part {
    std::string_view name;
    int first = 0;  ///< where the letters stand
    int last = 0;
  };

  void find_parts() {
    for (int n = 9; n <= card_.size(); n += 8) {
      const std::string_view name = card_.at(n);
      if (name.empty() || card_.is_integer(n)) continue;
      double number = 0.0;
      if (parse_real(name, number)) continue;
      if (name != "UD" && name != "K" && name != "Z" && name != "S")
        card_.fail(fmt::format("'{}' stands where UD, K, Z, S or a number must", shown(name)));
      if (part(name) != nullptr) card_.fail(fmt::format("{} stands twice", name));
      if (!parts_.empty()) parts_.back().last = n - 1;
      parts_.push_back({name, n, card_.size()});
    }
  }

  const Part* part(std::string_view name) const {
    for (const Part& one : parts_) {
      if (one.name == name) return &one;
    }
    return nullptr;
  }

  void read_degrees_of_freedom(const Part& part) {
    const std::string point = std::string(part.name), component = std::string("C") + part.name[1];
    for (int n = part.first + 2; n <= part.last; n += 2) {
      if (!card_.has_any(n, n + 1)) continue;
      const int node = builder_.node(card_, n, point);
      const Components named = card_.components(n + 1, component);
      const bool is_scalar = builder_.model.nodes[static_cast<std::size_t>(node)].is_scalar;
      if (is_scalar ? named > 1 : std::popcount(named) != 1) {
        card_.fail(
            fmt::format("{} is '{}' for point {}; {}", component, shown(card_.at(n + 1)), shown(card_.at(n)),
                        is_scalar ? "a scalar point has the component 0" : "one component from 1 to 6 is needed"));
      }
      add(node, named == 0 ? 0 : std::countr_zero(named), n);
    }
  }

  void add(int node, int component, int n) {
    if (!known_.emplace(node, component).second) {
      card_.fail(fmt::format("point {} stands twice with component {}", shown(card_.at(n)), component + 1));
    }
    element_.nodes.push_back(node);
    element_.components.push_back(component);
  }

  /// Refuses a part that has not just as many numbers; blank fields are zero, but K and Z end with a diagonal.
  void require_count(const Part& part, std::int64_t count) const {
    int last = part.last;
    while (last > part.first && card_.is_blank(last)) --last;
    const int room = part.last - part.first + 7 - (part.last - part.first) % 8;  // to the line's end
    const bool is_complete = part.name == "S" ? count <= room : count <= last - part.first;
    if (is_complete && last - part.first <= count) return;
    card_.fail(fmt::format("{} holds {} numbers, but {} are needed for {} degrees of freedom", part.name,
                           last - part.first, count, element_.nodes.size()));
  }

  void read_stiffness(int size) {
    const Part *stiffness = part("K"), *flexibility = part("Z");
    if ((stiffness == nullptr) == (flexibility == nullptr)) card_.fail("one of the matrices K and Z is needed");
    const Part& given = stiffness != nullptr ? *stiffness : *flexibility;
    require_count(given, static_cast<std::int64_t>(size) * (size + 1) / 2);
    Eigen::MatrixXd matrix(size, size);
    int n = given.first;
    for (int column = 0; column < size; ++column) {
      for (int row = column; row < size; ++row)
        matrix(row, column) = matrix(column, row) = builder_.real(card_, ++n, given.name, 0.0);
    }
    if (flexibility != nullptr) {
      const CholeskyFactor factor(matrix);
      if (!factor.is_positive_definite()) card_.fail("the flexibility Z is not positive definite; it has no stiffness");
      matrix = factor.solve(Eigen::MatrixXd::Identity(size, size));
      matrix = (0.5 * (matrix + matrix.transpose())).eval();
    }
    element_.stiffness = std::move(matrix);
  }

  void read_rigid_motion(int independent, int dependent) {
    const Part* given = part("S");
    if (given == nullptr) return require_geometry(independent, dependent);
    if (dependent == 0) card_.fail("S is given without UD");
    require_count(*given, static_cast<std::int64_t>(independent) * dependent);
    element_.rigid_motion.resize(independent, dependent);
    int n = given->first;
    for (int row = 0; row < independent; ++row) {
      for (int column = 0; column < dependent; ++column)
        element_.rigid_motion(row, column) = builder_.real(card_, ++n, "S", 0.0);
    }
  }

  /// What S must follow from where it is not given.
  void require_geometry(int independent, int dependent) const {
    constexpr int k_rigid_motions = 6;
    if (dependent == 0) return;
    if (dependent != k_rigid_motions) {
      card_.fail(fmt::format("UD holds {} degrees of freedom; without the matrix S six are needed", dependent));
    }
    for (int k = 0; k < independent + dependent; ++k) {
      const Node& node = builder_.model.nodes[static_cast<std::size_t>(element_.nodes[static_cast<std::size_t>(k)])];
      if (node.is_scalar) card_.fail(fmt::format("point {} is a scalar point; the matrix S is needed", node.id));
    }
  }

  ModelBuilder& builder_;
  const Card& card_;
  GeneralElement element_;
  std::vector<Part> parts_;
  std::set<std::pair<int, int>> known_;
};

void read_genel(ModelBuilder& builder, const Card& card) {
  if (!builder.is_first(card, card.id(1, "EID"))) return;
  builder.add_element(card, GeneralElementReader(builder, card).read());
}

constexpr std::array<CardRule, 1> k_general_element_rules = {{{"GENEL", Phase::elements, read_genel}}};

}  // namespace

CardFamily general_element_cards() {
  return {"GENEL", k_general_element_rules};
}

}  // namespace mottle::formats::nastran
