#include "updating/sampling/corrected_posterior.hpp"

#include <algorithm>
#include <memory>

#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"
#include "updating/sampling/corrected_walk.hpp"
#include "updating/sampling/island_batches.hpp"

namespace mottle::updating {
namespace {

using Walks = std::vector<CorrectedWalk*>;

/// Each walk's own share of the corrections at points and auxiliaries of all, evaluated as one batch.
template <typename Auxiliaries, typename Receive>
void correct(const Walks& walks, const Correction& correction, const RunContext& context,
             const Auxiliaries& auxiliaries_of, const Receive& receive) {
  context.throw_if_stopped();
  std::vector<const Eigen::MatrixXd*> points(walks.size());
  std::vector<const Eigen::MatrixXd*> auxiliaries(walks.size());
  const auto count = static_cast<std::int64_t>(walks.size());
  parallel_for(count, 1, context.threads, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      auxiliaries[i] = &auxiliaries_of(*walks[i]);
      points[i] = &walks[i]->points();
    }
  });
  const Eigen::MatrixXd values =
      correction.log_ratio(stacked(points, points.front()->cols()), stacked(auxiliaries, auxiliaries.front()->cols()));
  const Eigen::Index rows = points.front()->rows();
  parallel_for(count, 1, context.threads, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      receive(*walks[static_cast<std::size_t>(i)], values.middleRows(i * rows, rows));
    }
  });
}

/// Metropolis steps of a walk: as many as decorrelated the particles when the cheap likelihood was sampled, if they are
/// not so many that several shorter walks do better.
int steps_of(const Islands& islands) {
  constexpr int k_most = 50;
  int steps = 1;
  for (const auto& island : islands) {
    if (!island->found().stages.empty()) steps = std::max(steps, island->found().stages.back().moves);
  }
  return std::min(steps, k_most);
}

void sweep(const SamplingTarget& target, const Correction& correction, const Walks& walks, int steps,
           const RunContext& context) {
  using Ratio = Eigen::Ref<const Eigen::MatrixXd>;
  correct(
      walks, correction, context, [](CorrectedWalk& walk) -> const Eigen::MatrixXd& { return walk.propose_blocks(); },
      [](CorrectedWalk& walk, const Ratio& ratio) { walk.judge_blocks(ratio); });
  std::vector<Island*> islands;
  for (CorrectedWalk* walk : walks) {
    walk->begin_walk();
    islands.push_back(&walk->island());
  }
  for (int step = 0; step < steps; ++step) advance(target, islands, context.threads);
  correct(
      walks, correction, context, [](CorrectedWalk& walk) -> const Eigen::MatrixXd& { return walk.auxiliaries(); },
      [](CorrectedWalk& walk, const Ratio& ratio) { walk.judge_walk(ratio); });
}

/// Shorter walks where few are accepted, longer ones where nearly all are.
int adapted(int steps, int most, const Walks& walks) {
  constexpr double k_few = 0.2;
  constexpr double k_many = 0.6;
  double rate = 0.0;
  for (const CorrectedWalk* walk : walks) rate += walk->walk_acceptance() / static_cast<double>(walks.size());
  if (rate < k_few) return std::max(1, steps / 2);
  return rate > k_many ? std::min(most, 2 * steps) : steps;
}

}  // namespace

std::vector<CorrectedIsland> sample_corrected(const SamplingTarget& target, const Correction& correction,
                                              const SamplingSettings& settings, const RunContext& context) {
  require(correction.blocks >= 1 && correction.block_size >= 1, "{} blocks of {} variables, need at least 1 of 1",
          correction.blocks, correction.block_size);
  constexpr int k_max_particles = 1 << 23;  // the other half of a stream's numbers names walks
  require(settings.particles <= k_max_particles, "particles: {} is more than {}", settings.particles, k_max_particles);
  SamplingSettings of_cheap = settings;
  of_cheap.last_stage_factor = 1;  // its particles are no draws yet
  const Islands islands = run_islands(target, of_cheap, context, Forecast::not_told);
  std::vector<std::unique_ptr<CorrectedWalk>> walks;
  Walks working;
  for (std::size_t i = 0; i < islands.size(); ++i) {
    walks.push_back(std::make_unique<CorrectedWalk>(*islands[i], correction, settings, context.seed,
                                                    static_cast<std::uint32_t>(i)));
    working.push_back(walks.back().get());
  }
  for (const auto& walk : walks) walk->draw_possible();
  correct(
      working, correction, context, [](CorrectedWalk& walk) -> const Eigen::MatrixXd& { return walk.auxiliaries(); },
      [](CorrectedWalk& walk, const Eigen::Ref<const Eigen::MatrixXd>& ratio) { walk.receive_start(ratio); });
  const int most = steps_of(islands);
  for (int steps = most; !working.empty();) {
    sweep(target, correction, working, steps, context);
    steps = adapted(steps, most, working);
    std::erase_if(working, [](const CorrectedWalk* walk) { return walk->is_done(); });
  }
  std::vector<CorrectedIsland> found;
  for (const auto& walk : walks) found.push_back(walk->take());
  return found;
}

}  // namespace mottle::updating
