#include "updating/sampling/run_forecast.hpp"

#include <algorithm>
#include <cmath>

namespace mottle::updating {
namespace {

/// Mean moves of a finished stage, of the later half of them: a posterior that narrows may need more.
double recent_moves(const std::vector<SamplingStage>& stages) {
  const std::size_t finished = stages.size() - 1;
  const std::size_t first = finished / 2;
  double sum = 0.0;
  for (std::size_t k = first; k < finished; ++k) sum += stages[k].moves;
  return sum / static_cast<double>(finished - first);
}

/// Stages after the present one.
double missing_stages(const std::vector<SamplingStage>& stages) {
  constexpr double k_slowest = 1.02;  // growth of an exponent from stage to stage
  const double exponent = stages.back().exponent;
  if (exponent >= 1.0) return 0.0;
  const double growth = std::max(exponent / stages[stages.size() - 2].exponent, k_slowest);
  return std::ceil(-std::log(exponent) / std::log(growth));
}

}  // namespace

std::optional<double> expected_evaluations(const Islands& islands, const SamplingSettings& settings,
                                           std::int64_t asked_for) {
  double typical = 0.0;  // moves of a stage
  for (const auto& island : islands) {
    if (island->found().stages.size() < 2) return std::nullopt;
    typical += recent_moves(island->found().stages) / static_cast<double>(islands.size());
  }
  const double most = settings.max_moves;
  const double of_last_stage = std::min(most, settings.last_stage_factor * typical);
  double made = 1.0 * static_cast<double>(islands.size());  // the start counts as one
  double missing = 0.0;
  for (const auto& island : islands) {
    const std::vector<SamplingStage>& stages = island->found().stages;
    for (const SamplingStage& stage : stages) made += stage.moves;
    if (island->is_done()) continue;
    const double later = missing_stages(stages);
    const double present = later > 0.0 ? typical : of_last_stage;
    missing += std::max(0.0, present - stages.back().moves);
    if (later > 0.0) missing += (later - 1.0) * typical + of_last_stage;
  }
  return static_cast<double>(asked_for) * (1.0 + missing / made);
}

}  // namespace mottle::updating
