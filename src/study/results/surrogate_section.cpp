#include "study/results/surrogate_section.hpp"

namespace mottle::study {

Json surrogate_json(const SurrogateSettings& settings, const SurrogateUpdate& update) {
  Json rounds = Json::array();
  for (const SurrogateRound& round : update.rounds()) {
    rounds.push_back({{"runs", round.runs},
                      {"carried_error", to_json(round.carried_error)},
                      {"error_at_estimate", to_json(round.error_at_estimate)},
                      {"scatter_error_at_estimate", to_json(round.scatter_error_at_estimate)}});
  }
  return {{"kind", surrogate_kinds()[static_cast<std::size_t>(settings.kind)]},
          {"tolerance", settings.tolerance},
          {"within_tolerance", update.is_good()},
          {"rounds", rounds}};
}

}  // namespace mottle::study
