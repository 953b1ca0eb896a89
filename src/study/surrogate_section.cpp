#include "surrogate_section.hpp"

#include "study_sections.hpp"

namespace mottle {
namespace {

const std::vector<std::string> k_kinds{"quadratic", "kriging", "chaos"};  // as SurrogateKind

}  // namespace

SurrogateSettings read_surrogate(TomlReader reader) {
  SurrogateSettings settings;
  settings.kind = static_cast<SurrogateKind>(reader.choice("kind", k_kinds, static_cast<std::size_t>(settings.kind)));
  settings.runs = static_cast<int>(reader.integer_or("runs", settings.runs, {.lower = 10.0, .upper = 1e5}));
  settings.spread = reader.number_or("spread", settings.spread, {.lower = 0.5, .upper = 6.0});
  settings.rounds = static_cast<int>(reader.integer_or("rounds", settings.rounds, {.lower = 0.0, .upper = 100.0}));
  settings.tolerance = reader.number_or("tolerance", settings.tolerance, {.lower = 1e-6, .upper = 1.0});
  reader.finish();
  return settings;
}

Json surrogate_json(const SurrogateSettings& settings, const SurrogateUpdate& update) {
  Json rounds = Json::array();
  for (const SurrogateRound& round : update.rounds()) {
    rounds.push_back({{"runs", round.runs},
                      {"carried_error", to_json(round.carried_error)},
                      {"error_at_estimate", to_json(round.error_at_estimate)}});
  }
  return {{"kind", k_kinds[static_cast<std::size_t>(settings.kind)]},
          {"tolerance", settings.tolerance},
          {"within_tolerance", update.is_good()},
          {"rounds", rounds}};
}

}  // namespace mottle
