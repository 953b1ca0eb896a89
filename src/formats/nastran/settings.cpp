// PARAM, EIGRL, EIGR and what the case control section adds to them.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "formats/nastran/builder.hpp"
#include "formats/nastran/card_table.hpp"
#include "formats/nastran/rows.hpp"

namespace mottle::formats::nastran {
namespace {

/// A PARAM from the bulk data or the case control section.
struct Parameter {
  std::string_view name, value;
  SourceLocation location;
};

double number_of(const Parameter& parameter) {
  double value = 0.0;
  if (!parse_real(parameter.value, value)) {
    fail(parameter.location,
         fmt::format("PARAM {}: '{}' stands where a number is needed", parameter.name, shown(parameter.value)));
  }
  return value;
}

bool is_yes(const Parameter& parameter) {
  if (parameter.value == "YES" || parameter.value == "Y") return true;
  if (parameter.value == "NO" || parameter.value == "N") return false;
  fail(parameter.location,
       fmt::format("PARAM {}: '{}' stands where YES or NO is needed", parameter.name, shown(parameter.value)));
}

void set_reference_node(ModelBuilder& builder, const Parameter& parameter) {
  const double id = number_of(parameter);
  if (id != std::floor(id) || std::abs(id) > 2e9) fail(parameter.location, "PARAM GRDPNT: a grid point's id is needed");
  builder.model.settings.reference_node = id > 0.0 ? builder.find_node(static_cast<int>(id)) : -1;
  if (id > 0.0 && builder.model.settings.reference_node < 0) {
    builder.note(
        fmt::format("PARAM GRDPNT names grid point {}, which does not exist; the basic origin stands for it", id));
  }
}

void apply(ModelBuilder& builder, const Parameter& parameter) {
  AnalysisSettings& settings = builder.model.settings;
  if (parameter.name == "AUTOSPC") {
    settings.automatic_constraints = is_yes(parameter) ? AutomaticConstraints::soft : AutomaticConstraints::null;
  }
  if (parameter.name == "COUPMASS") settings.coupled_mass = number_of(parameter) > 0.0;
  if (parameter.name == "WTMASS") settings.mass_factor = number_of(parameter);
  if (parameter.name == "K6ROT") settings.drilling = number_of(parameter);
  if (parameter.name == "GRDPNT") set_reference_node(builder, parameter);
  if (settings.mass_factor <= 0.0) fail(parameter.location, "PARAM WTMASS: a positive number is needed");
  if (settings.drilling < 0.0) fail(parameter.location, "PARAM K6ROT: a number from 0 is needed");
}

void read_param(ModelBuilder& builder, const Card& card) {
  if (card.is_blank(1)) card.fail("the parameter's name is missing");
  apply(builder,
        {card.at(1), card.at(2), {builder.deck.files[static_cast<std::size_t>(card.bulk().file)], card.bulk().line}});
}

void add_method(ModelBuilder& builder, const Card& card, ModelBuilder::Method method) {
  if (!builder.is_first(card, method.id, IdSpace::method)) return;
  if (method.modes < 0) card.fail(fmt::format("ND is {}, a number of modes from 1 is needed", method.modes));
  builder.methods.push_back(method);
}

/// SID V1 V2 ND.
void read_eigrl(ModelBuilder& builder, const Card& card) {
  add_method(builder, card,
             {card.id(1, "SID"), builder.real(card, 2, "V1", -1.0), builder.real(card, 3, "V2", -1.0),
              card.integer_or(4, "ND", 0)});
}

/// SID METHOD F1 F2 NE ND.
void read_eigr(ModelBuilder& builder, const Card& card) {
  add_method(builder, card,
             {card.id(1, "SID"), builder.real(card, 3, "F1", -1.0), builder.real(card, 4, "F2", -1.0),
              card.integer_or(6, "ND", 0)});
}

const ModelBuilder::Method* find_method(ModelBuilder& builder) {
  const CaseCommand* command = builder.deck.find_command("METHOD", builder.subcase);
  if (command == nullptr) {
    const bool is_only_one = builder.methods.size() == 1;
    if (is_only_one) builder.note(fmt::format("no METHOD command: the only one, {}, was taken", builder.methods[0].id));
    return is_only_one ? &builder.methods[0] : nullptr;
  }
  int id = 0;
  const std::string& value = command->value;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), id);
  const auto found = std::find_if(builder.methods.begin(), builder.methods.end(),
                                  [&](const ModelBuilder::Method& method) { return method.id == id; });
  if (error != std::errc{} || end != value.data() + value.size() || found == builder.methods.end()) {
    fail({builder.deck.files[static_cast<std::size_t>(command->file)], command->line},
         fmt::format("METHOD = '{}': no EIGRL or EIGR card has that id", shown(value)));
  }
  return &*found;
}

constexpr std::array<CardRule, 3> k_settings_rules = {{
    {"PARAM", Phase::settings, read_param},
    {"EIGRL", Phase::settings, read_eigrl},
    {"EIGR", Phase::settings, read_eigr},
}};

}  // namespace

CardFamily settings_cards() {
  return {"", k_settings_rules};
}

void read_case_settings(ModelBuilder& builder) {
  if (const ModelBuilder::Method* method = find_method(builder)) {
    builder.model.settings.modes = method->modes;
    builder.model.settings.lowest_frequency = method->lowest;
    builder.model.settings.highest_frequency = method->highest;
  }
  for (const CaseCommand& command : builder.deck.case_control) {
    const bool holds = command.subcase < 0 || command.subcase == builder.subcase;
    if (command.name != "PARAM" || !holds) continue;
    const std::string_view text = command.value;
    const std::size_t comma = std::min(text.find(','), text.size());
    apply(builder, {text.substr(0, comma),
                    comma < text.size() ? text.substr(comma + 1) : std::string_view{},
                    {builder.deck.files[static_cast<std::size_t>(command.file)], command.line}});
  }
}

}  // namespace mottle::formats::nastran
