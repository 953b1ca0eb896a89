#include "mottle/updating/sampling/sequential_monte_carlo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"
#include "updating/sampling/island_batches.hpp"
#include "updating/sampling/run_forecast.hpp"

namespace mottle::updating {
namespace {

void require_settings(const SamplingTarget& target, const SamplingSettings& settings) {
  constexpr int k_max_islands = 256;              // 8 bits of a stream's name
  constexpr int k_max_particles = (1 << 24) - 1;  // and the 24 beside them
  constexpr int k_max_steps = (1 << 16) - 1;
  require(target.dimension >= 1, "dimension: {}, need at least 1", target.dimension);
  require(settings.islands >= 2 && settings.islands <= k_max_islands, "islands: {} is outside 2 to {}",
          settings.islands, k_max_islands);
  require(settings.particles >= 20 && settings.particles <= k_max_particles, "particles: {} is outside 20 to {}",
          settings.particles, k_max_particles);
  require(settings.effective_fraction > 0.0 && settings.effective_fraction < 1.0,
          "effective_fraction: {} is outside (0, 1)", settings.effective_fraction);
  require(settings.max_moves >= 1 && settings.max_moves <= k_max_steps, "max_moves: {} is outside 1 to {}",
          settings.max_moves, k_max_steps);
  require(settings.max_stages >= 1 && settings.max_stages <= k_max_steps, "max_stages: {} is outside 1 to {}",
          settings.max_stages, k_max_steps);
  const std::int64_t start = std::int64_t{settings.islands} * settings.particles;
  require(settings.max_evaluations == 0 || settings.max_evaluations >= start,
          "max_evaluations: {} is less than the {} particles of the start", settings.max_evaluations, start);
}

bool goes_on(const SamplingTarget& target, const Islands& islands) {
  if (!target.before_batch) return true;
  std::vector<const Eigen::MatrixXd*> points;
  for (const auto& island : islands) points.push_back(&island->points());
  return target.before_batch(stacked(points, target.dimension));
}

/// What islands ask for, evaluated as one batch.
void evaluate(const SamplingTarget& target, const std::vector<Island*>& islands,
              const std::vector<const Eigen::MatrixXd*>& asked, int threads) {
  const Eigen::MatrixXd batch = stacked(asked, target.dimension);
  LikelihoodGradient found;
  if (batch.rows() > 0 && islands.front()->wants_gradient())
    found = target.with_gradient(batch);
  else if (batch.rows() > 0)
    found.log_likelihood = target.log_likelihood(batch);
  std::vector<Eigen::Index> first(islands.size(), 0);
  for (std::size_t i = 1; i < islands.size(); ++i) first[i] = first[i - 1] + asked[i - 1]->rows();
  parallel_for(static_cast<std::int64_t>(islands.size()), 1, threads, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const Eigen::Index rows = asked[i]->rows();
      const Eigen::MatrixXd gradient =
          found.gradient.rows() > 0 ? found.gradient.middleRows(first[i], rows) : Eigen::MatrixXd(0, target.dimension);
      islands[i]->receive(found.log_likelihood.segment(first[i], rows), gradient);
    }
  });
}

/// Whether the next batch, of one point for each particle at most, may be more than is allowed.
bool may_exceed(const SamplingSettings& settings, std::int64_t evaluations, std::size_t islands) {
  const std::int64_t batch = static_cast<std::int64_t>(islands) * settings.particles;
  return settings.max_evaluations > 0 && evaluations + batch > settings.max_evaluations;
}

/// Tells the observer after each stage how many evaluations are expected.
class ExpectedRuns {
 public:
  explicit ExpectedRuns(const RunContext& context) : context_(context) {}
  void tell(const Islands& islands, const SamplingSettings& settings, std::int64_t evaluations) {
    std::size_t stages = 0;
    for (const auto& island : islands) stages += island->found().stages.size();
    if (stages == stages_) return;
    const std::optional<double> total = expected_evaluations(islands, settings, evaluations);
    if (!total) return;
    const std::string text = fmt::format("about {:.2g} million model runs expected in all", 1e-6 * *total);
    if (stages_ == 0) context_.finding(text);
    context_.detail(text);
    stages_ = stages;
  }

 private:
  const RunContext& context_;
  std::size_t stages_ = 0;  // of all islands, when it was told last
};

}  // namespace

Eigen::MatrixXd stacked(const std::vector<const Eigen::MatrixXd*>& parts, Eigen::Index columns) {
  Eigen::Index rows = 0;
  for (const Eigen::MatrixXd* part : parts) rows += part->rows();
  Eigen::MatrixXd all(rows, columns);
  Eigen::Index first = 0;
  for (const Eigen::MatrixXd* part : parts) {
    all.middleRows(first, part->rows()) = *part;
    first += part->rows();
  }
  return all;
}

/// One batch without gradients, one with them.
std::int64_t advance(const SamplingTarget& target, const std::vector<Island*>& working, int threads) {
  std::vector<const Eigen::MatrixXd*> asked(working.size());
  parallel_for(static_cast<std::int64_t>(working.size()), 1, threads, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      asked[i] = &working[i]->propose();
    }
  });
  std::int64_t evaluations = 0;
  for (const Eigen::MatrixXd* points : asked) evaluations += points->rows();
  for (const bool with_gradient : {false, true}) {
    std::vector<Island*> islands;
    std::vector<const Eigen::MatrixXd*> theirs;
    for (std::size_t i = 0; i < working.size(); ++i) {
      if (working[i]->wants_gradient() != with_gradient) continue;
      islands.push_back(working[i]);
      theirs.push_back(asked[i]);
    }
    if (!islands.empty()) evaluate(target, islands, theirs, threads);
  }
  return evaluations;
}

bool follows_gradients(const SamplingTarget& target, const SamplingSettings& settings) {
  if (!target.with_gradient || settings.gradients == GradientMoves::never) return false;
  return settings.gradients == GradientMoves::always || target.dimension > k_many_dimensions;
}

Islands run_islands(const SamplingTarget& target, const SamplingSettings& settings, const RunContext& context,
                    Forecast forecast) {
  require_settings(target, settings);
  Islands islands;
  for (int i = 0; i < settings.islands; ++i) {
    islands.push_back(std::make_unique<Island>(target, settings, context.seed, static_cast<std::uint32_t>(i)));
  }
  ExpectedRuns expected(context);
  std::int64_t evaluations = 0;
  for (bool is_first = true;; is_first = false) {
    std::vector<Island*> working;
    for (const auto& island : islands) {
      if (!island->is_done()) working.push_back(island.get());
    }
    if (working.empty()) break;
    if (may_exceed(settings, evaluations, working.size())) {
      for (Island* island : working) island->give_up();
      break;
    }
    context.throw_if_stopped();
    if (!is_first && !goes_on(target, islands)) throw Stopped("stopped on request");
    evaluations += advance(target, working, context.threads);
    if (forecast == Forecast::told) expected.tell(islands, settings, evaluations);
  }
  return islands;
}

std::vector<SampledIsland> sample_posterior(const SamplingTarget& target, const SamplingSettings& settings,
                                            const RunContext& context) {
  std::vector<SampledIsland> found;
  for (const auto& island : run_islands(target, settings, context, Forecast::told)) found.push_back(island->take());
  return found;
}

}  // namespace mottle::updating
