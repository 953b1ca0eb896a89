// SPC, SPC1, SPCADD, MPC, MPCADD: the sets that the case control section selects.
#include <array>
#include <bit>
#include <charconv>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"
#include "formats/nastran/lists.hpp"
#include "formats/nastran/rows.hpp"
#include "mottle/core/error.hpp"

namespace mottle::formats::nastran {
namespace {

/// The sets of one kind that a deck holds.
struct SetNames {
  std::string_view command;               ///< "SPC"
  std::array<std::string_view, 2> cards;  ///< "SPC", "SPC1"
  std::string_view sum;                   ///< "SPCADD"
};

constexpr SetNames k_spc = {"SPC", {"SPC", "SPC1"}, "SPCADD"};
constexpr SetNames k_mpc = {"MPC", {"MPC", "MPC"}, "MPCADD"};

class SetSelector {
 public:
  SetSelector(ModelBuilder& builder, const SetNames& names) : builder_(builder), names_(names) {
    for (const BulkCard& bulk : builder.deck.cards) {
      const bool is_plain = bulk.name == names.cards[0] || bulk.name == names.cards[1];
      if ((!is_plain && bulk.name != names.sum) || builder.options.ignore_cards.contains(std::string(bulk.name)))
        continue;
      const int id = builder.card_of(bulk).id(1, "SID");
      if (is_plain) plain_.insert(id);
      if (!is_plain) sums_[id].push_back(&bulk);
    }
  }

  std::unordered_set<int> select() {
    const auto& deck = builder_.deck;
    if (const CaseCommand* command = deck.find_command(names_.command, builder_.subcase)) return select_by(*command);
    const std::vector<int> roots = independent_sets();
    if (roots.empty()) return {};
    if (!deck.case_control.empty() || !deck.subcases.empty()) {
      builder_.note(fmt::format("the case control section selects no {} set: the {} in the deck hold nothing",
                                names_.command, roots.size()));
      return {};
    }
    if (roots.size() > 1) {
      throw FormatError(deck.files.front(), 0,
                        fmt::format("holds {} {} sets and no case control section that selects one; write for instance "
                                    "the lines 'CEND', '{} = {}', 'BEGIN BULK' in front of the cards",
                                    roots.size(), names_.command, names_.command, roots.front()));
    }
    builder_.note(
        fmt::format("no case control section: the only {} set, {}, was taken", names_.command, roots.front()));
    return with_parts(roots.front());
  }

 private:
  bool exists(int id) const { return plain_.contains(id) || sums_.contains(id); }

  std::unordered_set<int> select_by(const CaseCommand& command) {
    int id = 0;
    const std::string& value = command.value;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), id);
    const SourceLocation location{builder_.deck.files[static_cast<std::size_t>(command.file)], command.line};
    if (error != std::errc{} || end != value.data() + value.size() || id < 0) {
      fail(location, fmt::format("{} = '{}': the id of a set is needed", command.name, shown(value)));
    }
    if (id == 0) return {};
    if (!exists(id)) fail(location, fmt::format("{} = {}: no {} card has that id", command.name, id, known_cards()));
    return with_parts(id);
  }

  std::string known_cards() const {
    return fmt::format("{}{} or {}", names_.cards[0],
                       names_.cards[1] == names_.cards[0] ? "" : fmt::format(", {}", names_.cards[1]), names_.sum);
  }

  /// Sets that are no part of a sum.
  std::vector<int> independent_sets() const {
    std::unordered_set<int> parts;
    for (const auto& [id, cards] : sums_) {
      for (const BulkCard* bulk : cards) {
        const Card card = builder_.card_of(*bulk);
        for (int n = 2; n <= card.size(); ++n) {
          if (!card.is_blank(n) && card.id(n, "S") != id) parts.insert(card.id(n, "S"));
        }
      }
    }
    std::set<int> roots;
    for (const int id : plain_) {
      if (!parts.contains(id)) roots.insert(id);
    }
    for (const auto& [id, cards] : sums_) {
      if (!parts.contains(id)) roots.insert(id);
    }
    return {roots.begin(), roots.end()};
  }

  /// A set and everything that its sums add up.
  std::unordered_set<int> with_parts(int root) {
    std::unordered_set<int> found = {root};
    std::vector<int> open = {root};
    while (!open.empty()) {
      const int id = open.back();
      open.pop_back();
      const auto sum = sums_.find(id);
      if (sum == sums_.end()) continue;
      for (const BulkCard* bulk : sum->second) add_parts(builder_.card_of(*bulk), found, open);
    }
    return found;
  }

  void add_parts(const Card& card, std::unordered_set<int>& found, std::vector<int>& open) const {
    for (int n = 2; n <= card.size(); ++n) {
      if (card.is_blank(n)) continue;
      const int id = card.id(n, "S");
      if (!exists(id)) card.fail(fmt::format("adds up set {}, but no {} card has that id", id, known_cards()));
      if (found.insert(id).second) open.push_back(id);
    }
  }

  ModelBuilder& builder_;
  const SetNames& names_;
  std::unordered_set<int> plain_;
  std::unordered_map<int, std::vector<const BulkCard*>> sums_;
};

void fix(ModelBuilder& builder, const Card& card, int node, Components components) {
  const bool is_scalar = builder.model.nodes[static_cast<std::size_t>(node)].is_scalar;
  const int id = builder.node_ids[static_cast<std::size_t>(node)];
  if (is_scalar && components > 1) card.fail(fmt::format("scalar point {} has no component but 0", id));
  if (!is_scalar && components == 0) card.fail(fmt::format("C is blank, but {} is a grid point: digits 1 to 6", id));
  builder.fixed[static_cast<std::size_t>(node)] |= is_scalar ? Components{1} : components;
}

/// SID G1 C1 D1 G2 C2 D2.
void read_spc(ModelBuilder& builder, const Card& card) {
  if (!builder.spc_sets.contains(card.id(1, "SID"))) return;
  for (const int n : {2, 5}) {
    if (n == 5 && card.is_blank(n)) continue;
    fix(builder, card, builder.node(card, n, "G"), card.components(n + 1, "C"));
    if (builder.real(card, n + 2, "D", 0.0) != 0.0) {
      builder.count("{} SPC displacements other than zero were read as zero (natural modes do not know them)");
    }
  }
}

/// SID C G1 G2 ... or SID C G1 THRU G2.
void read_spc1(ModelBuilder& builder, const Card& card) {
  if (!builder.spc_sets.contains(card.id(1, "SID"))) return;
  const Components components = card.components(2, "C");
  for_each_listed_node(builder, card, 3, card.size(), [&](int node) { fix(builder, card, node, components); });
}

/// SID G1 C1 A1 G2 C2 A2 - / - G3 C3 A3 ...
void read_mpc(ModelBuilder& builder, const Card& card) {
  if (!builder.mpc_sets.contains(card.id(1, "SID"))) return;
  MultipointEquation equation;
  for (int n = 2; n <= card.size(); n += n % 8 == 2 ? 3 : 5) {
    if (!card.has_any(n, n + 2)) continue;
    MultipointEquation::Term term;
    term.node = builder.node(card, n, "G");
    const Components component = card.components(n + 1, "C");
    const bool is_scalar = builder.model.nodes[static_cast<std::size_t>(term.node)].is_scalar;
    if (std::popcount(component) > 1 || (!is_scalar && component == 0) || (is_scalar && component > 1)) {
      card.fail(fmt::format("C is '{}' for point {}; one component is needed (0 for a scalar point)",
                            shown(card.at(n + 1)), shown(card.at(n))));
    }
    term.component = component == 0 ? 0 : std::countr_zero(component);
    term.coefficient = builder.real(card, n + 2, "A", 0.0);
    equation.terms.push_back(term);
  }
  if (equation.terms.empty()) card.fail("holds no term");
  if (equation.terms.front().coefficient == 0.0) card.fail("A1, the coefficient of the dependent term, is zero");
  builder.model.multipoint_equations.push_back(std::move(equation));
}

void read_nothing(ModelBuilder&, const Card&) {}

constexpr std::array<CardRule, 5> k_constraint_rules = {{
    {"SPC", Phase::constraints, read_spc, 7},
    {"SPC1", Phase::constraints, read_spc1},
    {"SPCADD", Phase::constraints, read_nothing},
    {"MPC", Phase::constraints, read_mpc},
    {"MPCADD", Phase::constraints, read_nothing},
}};

}  // namespace

CardFamily constraint_cards() {
  return {"MPC, SPC, SPC1", k_constraint_rules};
}

void select_constraint_sets(ModelBuilder& builder) {
  builder.spc_sets = SetSelector(builder, k_spc).select();
  builder.mpc_sets = SetSelector(builder, k_mpc).select();
}

void write_fixed(ModelBuilder& builder) {
  for (std::size_t node = 0; node < builder.fixed.size(); ++node) {
    Components components = builder.fixed[node];
    if (builder.model.nodes[node].is_scalar) components &= Components{1};
    if (components != 0) builder.model.fixed.emplace_back(static_cast<int>(node), components);
  }
}

}  // namespace mottle::formats::nastran
