#include "updating/sampling/corrected_walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "updating/sampling/stage_weights.hpp"

namespace mottle::updating {
namespace {

constexpr double k_minus_infinity = -std::numeric_limits<double>::infinity();
constexpr double k_wanted_acceptance = 0.3;
constexpr double k_smallest_step = 1e-3;
constexpr int k_least_sweeps = 3;       // correlations say little of tails
constexpr int k_moves_of_a_sweep = 10;  // or more: a stage has a tenth of the most moves as sweeps at most

Eigen::MatrixXd known(const Eigen::Ref<const Eigen::MatrixXd>& log_ratio) {
  return log_ratio.unaryExpr([](double value) { return std::isnan(value) ? k_minus_infinity : value; });
}

}  // namespace

CorrectedWalk::CorrectedWalk(Island& island, const Correction& correction, const SamplingSettings& settings,
                             std::uint64_t seed, std::uint32_t number)
    : island_(island), correction_(correction), settings_(settings), seed_(seed), number_(number) {
  random_step_ = 2.4 / std::sqrt(static_cast<double>(correction.block_size));
  is_random_step_.resize(static_cast<std::size_t>(settings.particles));
  auxiliaries_.resize(settings.particles, correction.blocks * correction.block_size);
  for (Eigen::Index i = 0; i < auxiliaries_.rows(); ++i) {
    RandomStream random = stream(StreamPurpose::corrected_auxiliaries, static_cast<std::uint32_t>(i));
    for (double& value : auxiliaries_.row(i)) value = standard_normal_quantile(random.uniform());
  }
}

RandomStream CorrectedWalk::stream(StreamPurpose purpose, std::uint32_t particle) const {
  return {{.seed = seed_, .purpose = purpose, .iteration = (stage_ << 16U) + sweep_}, (number_ << 24U) + particle};
}

void CorrectedWalk::draw_possible() {
  if (!correction_.is_possible) return;
  constexpr int k_wanted = 5;
  constexpr int k_most = 1000;  // draws; a block that is possible more seldom counts as impossible
  const Eigen::Index size = correction_.block_size;
  std::vector<RandomStream> streams;
  for (Eigen::Index i = 0; i < auxiliaries_.rows(); ++i)
    streams.push_back(stream(StreamPurpose::corrected_start, static_cast<std::uint32_t>(i)));
  Eigen::MatrixXd drawn = auxiliaries_;
  Eigen::ArrayXXi successes = Eigen::ArrayXXi::Zero(auxiliaries_.rows(), correction_.blocks);
  Eigen::ArrayXXi draws = successes;
  for (int draw = 0; draw < k_most && (successes < k_wanted).any(); ++draw) {
    for (Eigen::Index i = 0; draw > 0 && i < drawn.rows(); ++i) {
      for (double& value : drawn.row(i))
        value = standard_normal_quantile(streams[static_cast<std::size_t>(i)].uniform());
    }
    const Correction::IsPossible possible = correction_.is_possible(island_.points(), drawn);
    for (Eigen::Index s = 0; s < correction_.blocks; ++s) {
      for (Eigen::Index i = 0; i < drawn.rows(); ++i) {
        if (successes(i, s) == k_wanted) continue;
        ++draws(i, s);
        if (!possible(i, s)) continue;
        if (++successes(i, s) == 1) auxiliaries_.row(i).segment(s * size, size) = drawn.row(i).segment(s * size, size);
      }
    }
  }
  if ((draws == k_wanted).all()) return;
  log_weight_ = ((k_wanted - 1.0) / (draws.cast<double>() - 1.0)).log().rowwise().sum();
}

void CorrectedWalk::weigh_start() {
  if (log_weight_.size() == 0) return;
  const double largest = log_weight_.maxCoeff();
  const Eigen::VectorXd weights = (log_weight_.array() - largest).exp();
  log_evidence_ += largest + std::log(weights.mean());
  RandomStream random = stream(StreamPurpose::corrected_resampling, 0);
  const std::vector<Eigen::Index> parents = systematic_parents(weights / weights.sum(), random.uniform());
  island_.begin_walk(parents);
  auxiliaries_ = auxiliaries_(parents, Eigen::all).eval();
  log_ratio_ = log_ratio_(parents, Eigen::all).eval();
}

void CorrectedWalk::receive_start(const Eigen::Ref<const Eigen::MatrixXd>& log_ratio) {
  log_ratio_ = known(log_ratio);
  weigh_start();
  require(log_ratio_.rowwise().sum().maxCoeff() > k_minus_infinity,
          "none of {} draws has a likelihood above zero: the model fails, or is physically impossible, where the tests "
          "put its parameters",
          log_ratio_.rows());
}

void CorrectedWalk::begin_stage() {
  const StageWeights next = next_stage(log_ratio_.rowwise().sum(), exponent_, settings_.effective_fraction);
  exponent_ = next.exponent;
  log_evidence_ += next.log_mean;
  stages_.push_back({.exponent = exponent_, .effective_samples = next.effective_samples});
  ++stage_;
  RandomStream random = stream(StreamPurpose::corrected_resampling, 0);
  const std::vector<Eigen::Index> parents = systematic_parents(next.weights, random.uniform());
  island_.begin_walk(parents);
  auxiliaries_ = auxiliaries_(parents, Eigen::all).eval();
  log_ratio_ = log_ratio_(parents, Eigen::all).eval();
  start_points_ = island_.points();
  start_auxiliaries_ = auxiliaries_;
  start_log_ratio_ = log_ratio_.rowwise().sum();
  accepted_ = 0.0;
}

const Eigen::MatrixXd& CorrectedWalk::propose_blocks() {
  if (sweep_ == 0) begin_stage();
  ++sweep_;
  proposed_.resize(auxiliaries_.rows(), auxiliaries_.cols());
  const double kept = std::sqrt(std::max(0.0, 1.0 - step_ * step_));
  for (Eigen::Index i = 0; i < proposed_.rows(); ++i) {
    RandomStream random = stream(StreamPurpose::corrected_auxiliaries, static_cast<std::uint32_t>(i));
    const bool is_random = random.uniform() < 0.5;
    is_random_step_[static_cast<std::size_t>(i)] = is_random;
    for (Eigen::Index j = 0; j < proposed_.cols(); ++j) {
      proposed_(i, j) = (is_random ? 1.0 : kept) * auxiliaries_(i, j) +
                        (is_random ? random_step_ : step_) * standard_normal_quantile(random.uniform());
    }
  }
  return proposed_;
}

void CorrectedWalk::judge_blocks(const Eigen::Ref<const Eigen::MatrixXd>& log_ratio) {
  const Eigen::MatrixXd ratio = known(log_ratio);
  const Eigen::Index size = correction_.block_size;
  std::array<double, 2> accepted = {0.0, 0.0};  // of either kind
  std::array<double, 2> tried = {0.0, 0.0};
  for (Eigen::Index i = 0; i < ratio.rows(); ++i) {
    RandomStream random = stream(StreamPurpose::corrected_decision, static_cast<std::uint32_t>(i));
    const bool is_random = is_random_step_[static_cast<std::size_t>(i)];
    for (Eigen::Index s = 0; s < ratio.cols(); ++s) {
      auto now = auxiliaries_.row(i).segment(s * size, size);
      const auto next = proposed_.row(i).segment(s * size, size);
      double gain = exponent_ * (ratio(i, s) - log_ratio_(i, s));
      if (is_random) gain -= 0.5 * (next.squaredNorm() - now.squaredNorm());
      tried[is_random ? 1 : 0] += 1.0;
      if (!(std::log(random.uniform()) < gain)) continue;
      log_ratio_(i, s) = ratio(i, s);
      now = next;
      accepted[is_random ? 1 : 0] += 1.0;
    }
  }
  const double rate = accepted[0] / std::max(tried[0], 1.0);
  const double random_rate = accepted[1] / std::max(tried[1], 1.0);
  step_ = std::clamp(step_ * std::exp(rate - k_wanted_acceptance), k_smallest_step, 1.0);
  random_step_ = std::max(random_step_ * std::exp(random_rate - k_wanted_acceptance), k_smallest_step);
  accepted_ += 0.5 * (accepted[0] + accepted[1]) / static_cast<double>(ratio.size());
}

void CorrectedWalk::begin_walk() {
  walked_from_ = island_.points();
  walked_from_log_likelihood_ = island_.found().log_likelihood;
}

void CorrectedWalk::judge_walk(const Eigen::Ref<const Eigen::MatrixXd>& log_ratio) {
  const Eigen::MatrixXd ratio = known(log_ratio);
  double accepted = 0.0;
  for (Eigen::Index i = 0; i < ratio.rows(); ++i) {
    constexpr std::uint32_t k_of_walks = 1U << 23U;  // beyond the particles' own numbers
    RandomStream random = stream(StreamPurpose::corrected_decision, static_cast<std::uint32_t>(i) + k_of_walks);
    if (std::log(random.uniform()) < exponent_ * (ratio.row(i).sum() - log_ratio_.row(i).sum())) {
      log_ratio_.row(i) = ratio.row(i);
      accepted += 1.0;
    } else {
      island_.put_back(i, walked_from_.row(i).transpose(), walked_from_log_likelihood_(i));
    }
  }
  walk_acceptance_ = accepted / static_cast<double>(ratio.rows());
  accepted_ += 0.5 * walk_acceptance_;
  SamplingStage& stage = stages_.back();
  stage.moves = static_cast<int>(sweep_);
  stage.acceptance = accepted_ / static_cast<double>(sweep_);
  const int most = std::max(k_least_sweeps, settings_.max_moves / k_moves_of_a_sweep);
  if (wanted_sweeps_ == 0) {
    stage.correlation = correlation_with_start();
    stage.is_decorrelated = stage.correlation <= correlation_limit(settings_.decorrelation, settings_.particles);
    if ((!stage.is_decorrelated || stage.moves < k_least_sweeps) && stage.moves < most) return;
    wanted_sweeps_ = std::min(most, (exponent_ >= 1.0 ? settings_.last_stage_factor : 1) * stage.moves);
  }
  if (stage.moves < wanted_sweeps_) return;
  sweep_ = 0;
  wanted_sweeps_ = 0;
  is_finished_ = static_cast<int>(stages_.size()) < settings_.max_stages || exponent_ >= 1.0;
  is_done_ = exponent_ >= 1.0 || !is_finished_;
}

double CorrectedWalk::correlation_with_start() const {
  const Eigen::VectorXd sum = log_ratio_.rowwise().sum();
  double largest = std::abs(correlation_of(start_log_ratio_.array(), sum.array()));
  for (Eigen::Index j = 0; j < start_points_.cols(); ++j) {
    const double own = correlation_of(start_points_.col(j).array(), island_.points().col(j).array());
    largest = std::max(largest, std::abs(own));
  }
  const Eigen::Index size = correction_.block_size;
  for (Eigen::Index s = 0; s < correction_.blocks; ++s) {
    const Eigen::MatrixXd before = start_auxiliaries_.middleCols(s * size, size);
    const Eigen::MatrixXd now = auxiliaries_.middleCols(s * size, size);
    largest = std::max(largest, std::abs(correlation_of(before.reshaped().array(), now.reshaped().array())));
  }
  return largest;
}

CorrectedIsland CorrectedWalk::take() {
  CorrectedIsland found{island_.take(), std::move(auxiliaries_), std::move(log_ratio_)};
  found.island.log_evidence += log_evidence_;
  found.island.is_finished = found.island.is_finished && is_finished_;
  found.island.stages.insert(found.island.stages.end(), stages_.begin(), stages_.end());
  return found;
}

}  // namespace mottle::updating
