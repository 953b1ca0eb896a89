// The order in which cards become a model: each card by its rule, the rules by their phase.
#include "mottle/formats/nastran/model.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "formats/nastran/card_table.hpp"
#include "formats/nastran/rows.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/text_lines.hpp"

namespace mottle::formats {
namespace nastran {
namespace {

const std::vector<CardRule>& all_rules() {
  static const std::vector<CardRule> k_all = [] {
    std::vector<CardRule> rules;
    for (const CardFamily& family : card_families()) {
      rules.insert(rules.end(), family.rules.begin(), family.rules.end());
    }
    return rules;
  }();
  return k_all;
}

/// Cards by the phase in which they are read.
class CardSorter {
 public:
  explicit CardSorter(ModelBuilder& builder) : builder_(builder), rules_(all_rules()) {
    for (std::size_t rule = 0; rule < rules_.size(); ++rule) rule_of_[rules_[rule].name] = static_cast<int>(rule);
    for (const BulkCard& card : builder.deck.cards) sort(card);
  }

  void read(Phase phase) {
    for (const auto& [card, rule] : sorted_[static_cast<std::size_t>(phase)]) {
      const CardRule& reader = rules_[static_cast<std::size_t>(rule)];
      const Card view = builder_.card_of(*card);
      if (reader.max_fields > 0 && view.size() > reader.max_fields) {
        view.fail(fmt::format("field {} holds '{}', but the card has {} fields", view.size(),
                              shown(view.at(view.size())), reader.max_fields));
      }
      builder_.rule = rule;
      try {
        reader.read(builder_, view);
      } catch (const UnreadReference& reference) {
        set_aside(phase, view, reference);
      }
    }
  }

  /// All kinds of cards that must be refused, as far as they are known by now.
  std::vector<UnreadCards> refused() const {
    std::vector<UnreadCards> all = refused_;
    for (const auto& [name, cards] : needed_) all.push_back(cards);
    return all;
  }

  void handle_the_others() {
    for (const auto& [name, times] : ignored_) {
      builder_.note(fmt::format("{} {} cards were left out, as model.ignore_cards asks", times, name));
    }
    std::vector<UnreadCards> unread;
    for (const auto& [name, cards] : unread_) unread.push_back(cards);
    refused_ = find_refused_cards(builder_, unread);
  }

 private:
  void sort(const BulkCard& card) {
    if (card.name != last_name_) {  // cards of one kind stand together
      last_name_ = card.name;
      const auto found = rule_of_.find(card.name);
      last_rule_ = found == rule_of_.end() ? -1 : found->second;
      is_last_ignored_ = builder_.options.ignore_cards.contains(std::string(card.name));
    }
    if (is_last_ignored_) {
      ++ignored_[card.name];
    } else if (last_rule_ >= 0) {
      const Phase phase = rules_[static_cast<std::size_t>(last_rule_)].phase;
      sorted_[static_cast<std::size_t>(phase)].emplace_back(&card, last_rule_);
    } else {
      remember_unread(builder_, card);
      ++unread_.try_emplace(card.name, UnreadCards{&card, 0}).first->second.count;
    }
  }

  /// A property of a material that is not read matters only where an element names it.
  void set_aside(Phase phase, const Card& card, UnreadReference reference) {
    if (phase == Phase::properties) {
      reference.property = &card.bulk();
      builder_.unread_properties[card.id(1, "PID")] = reference;
      return;
    }
    UnreadCards& needed = needed_[reference.unread->name];
    if (needed.count++ > 0) return;
    needed.first = reference.unread;
    needed.user = fmt::format("{} {} at {}", card.name(), shown(card.at(1)), card.location());
    if (reference.property != nullptr) {
      const Card property = builder_.card_of(*reference.property);
      needed.user += fmt::format(" (with {} {})", property.name(), shown(property.at(1)));
    }
  }

  ModelBuilder& builder_;
  const std::vector<CardRule>& rules_;
  std::unordered_map<std::string_view, int> rule_of_;
  std::array<std::vector<std::pair<const BulkCard*, int>>, k_phases> sorted_;
  std::map<std::string_view, int> ignored_;
  std::map<std::string_view, UnreadCards> unread_;
  std::map<std::string_view, UnreadCards> needed_;  ///< properties and materials of elements
  std::vector<UnreadCards> refused_;
  std::string_view last_name_;
  int last_rule_ = -1;
  bool is_last_ignored_ = false;
};

/// The first subcase that asks for modes itself; the first one where none does.
int subcase_of_modes(const NastranDeck& deck) {
  for (int subcase = 0; subcase < static_cast<int>(deck.subcases.size()); ++subcase) {
    const CaseCommand* method = deck.find_command("METHOD", subcase);
    const CaseCommand* analysis = deck.find_command("ANALYSIS", subcase);
    if (analysis != nullptr && capitals(analysis->value).starts_with("MODE")) return subcase;
    if (method != nullptr && method->subcase == subcase && analysis == nullptr) return subcase;
  }
  return 0;
}

void note_subcase(ModelBuilder& builder) {
  const std::vector<int>& subcases = builder.deck.subcases;
  std::vector<std::string> holds;
  for (const char* name : {"SPC", "MPC", "METHOD"}) {
    const CaseCommand* command = builder.deck.find_command(name, builder.subcase);
    if (command != nullptr) holds.push_back(fmt::format("{} {}", name, shown(command->value)));
  }
  builder.note(fmt::format("the deck has {} subcases; {} was taken{}", subcases.size(),
                           subcases[static_cast<std::size_t>(builder.subcase)],
                           holds.empty() ? "" : fmt::format(" ({})", join(holds))));
}

/// Modes about a loaded state need its differential stiffness.
void refuse_preload(const ModelBuilder& builder) {
  constexpr const char* k_reason =
      "modes of a preloaded structure need its differential stiffness, which is not read here";
  const CaseCommand* preload = builder.deck.find_command("STATSUB", builder.subcase);
  if (preload != nullptr && !builder.options.ignore_cards.contains("STATSUB")) {
    fail({builder.deck.files[static_cast<std::size_t>(preload->file)], preload->line},
         fmt::format("STATSUB = {}: {}; model.ignore_cards = [\"STATSUB\"] goes on with the unloaded structure",
                     shown(preload->value), k_reason));
  }
  require(builder.deck.solution != "13", "{}: SOL 13: {}; SOL 103 stands for the unloaded structure",
          builder.deck.files.front(), k_reason);
}

void choose_subcase(ModelBuilder& builder) {
  const std::vector<int>& subcases = builder.deck.subcases;
  if (!builder.options.subcase) {
    builder.subcase = subcases.empty() ? -1 : subcase_of_modes(builder.deck);
    if (subcases.size() > 1) note_subcase(builder);
    return;
  }
  const auto found = std::find(subcases.begin(), subcases.end(), *builder.options.subcase);
  require(found != subcases.end(), "{}: there is no subcase {}; the deck has {}", builder.deck.files.front(),
          *builder.options.subcase, subcases.empty() ? "none" : fmt::format("{}", fmt::join(subcases, ", ")));
  builder.subcase = static_cast<int>(found - subcases.begin());
}

void read_structure(ModelBuilder& builder, CardSorter& sorter) {
  sorter.read(Phase::defaults);
  sorter.read(Phase::points);
  resolve_points(builder);
  sorter.read(Phase::materials);
  sorter.read(Phase::properties);
  sorter.read(Phase::elements);
}

void build(ModelBuilder& builder) {
  choose_subcase(builder);
  refuse_preload(builder);
  refuse_matrix_commands(builder);
  CardSorter sorter(builder);
  sorter.handle_the_others();
  try {
    read_structure(builder, sorter);
  } catch (const InvalidInput&) {
    if (sorter.refused().empty()) throw;  // else it may follow from what is not read, of which all is told first
  }
  refuse(builder, sorter.refused());
  select_constraint_sets(builder);
  sorter.read(Phase::constraints);
  write_fixed(builder);
  write_reduction(builder);
  sorter.read(Phase::settings);
  read_case_settings(builder);
  builder.write_counted_notes();
}

}  // namespace
}  // namespace nastran

NastranModel build_nastran_model(const NastranDeck& deck, const NastranOptions& options) {
  nastran::ModelBuilder builder(deck, options);
  builder.result.notes = deck.notes;
  builder.result.files = deck.files;
  nastran::build(builder);
  return std::move(builder.result);
}

bool is_design_number(const CardField& field) {
  for (const nastran::CardRule& rule : nastran::all_rules()) {
    if (rule.name != field.card) continue;
    const std::vector<std::string_view> names = words_of(rule.design_numbers);
    return std::any_of(names.begin(), names.end(), [&field](std::string_view name) {
      if (!name.ends_with('*')) return field.name == name;
      const std::string_view stem = name.substr(0, name.size() - 1),
                             number = std::string_view(field.name).substr(std::min(stem.size(), field.name.size()));
      return field.name.starts_with(stem) && number.find_first_not_of("0123456789") == std::string_view::npos;
    });
  }
  return false;
}

NastranModel read_nastran_model(const std::filesystem::path& file, const NastranOptions& options) {
  return build_nastran_model(read_nastran_deck(file), options);
}

}  // namespace mottle::formats
