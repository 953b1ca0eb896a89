#include "updating/sampling/island.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "updating/estimate/normal_draws.hpp"
#include "updating/sampling/stage_weights.hpp"

namespace mottle::updating {
namespace {

constexpr double k_minus_infinity = -std::numeric_limits<double>::infinity();

}  // namespace

Island::Island(const SamplingTarget& target, const SamplingSettings& settings, std::uint64_t seed, std::uint32_t number)
    : target_(target),
      settings_(settings),
      seed_(seed),
      number_(number),
      follows_gradients_(follows_gradients(target, settings)) {
  gradient_.setConstant(settings.particles, follows_gradients_ ? target.dimension : 0,
                        std::numeric_limits<double>::quiet_NaN());
  difference_step_ = 2.38 / std::sqrt(2.0 * static_cast<double>(target.dimension));
}

RandomStream Island::stream(StreamPurpose purpose, std::uint32_t step, std::uint32_t particle) const {
  return {{.seed = seed_, .purpose = purpose, .iteration = (stage_ << 16U) + step}, (number_ << 24U) + particle};
}

const Eigen::MatrixXd& Island::propose() {
  constexpr std::uint32_t k_gradient_cycle = 4;  // every so many steps are of the other kinds, which jump between modes
  if (awaits_ == Awaits::start) {
    draw_start();
  } else if (awaits_ == Awaits::gradients) {
    start_trajectories();
  } else if (awaits_ == Awaits::trajectories && !trajectories_.are_done()) {
    advance_trajectories();
  } else {
    if (step_ == 0 && !is_walking_) begin_stage();
    ++step_;
    if (!follows_gradients_ || is_walking_ || step_ % k_gradient_cycle == 0)
      propose_moves();
    else
      ask_gradients();
  }
  return asked_points_;
}

void Island::receive(const Eigen::Ref<const Eigen::VectorXd>& log_likelihood,
                     const Eigen::Ref<const Eigen::MatrixXd>& gradient) {
  const Eigen::VectorXd known =
      log_likelihood.unaryExpr([](double value) { return std::isnan(value) ? k_minus_infinity : value; });
  require(known.size() == 0 || known.maxCoeff() < std::numeric_limits<double>::infinity(),
          "the likelihood is infinite at some parameters: a standard deviation of the noise is zero there");
  switch (awaits_) {
    case Awaits::start:
      return take_start(known);
    case Awaits::moves:
      return judge_moves(known);
    case Awaits::gradients:
      return keep_gradients(gradient);
    case Awaits::trajectories:
      return follow_trajectories(known, gradient);
  }
}

void Island::take_start(const Eigen::VectorXd& log_likelihood) {
  require(
      log_likelihood.maxCoeff() > k_minus_infinity,
      "none of {} draws of the prior has a likelihood above zero: the prior has no probability where the tests are, "
      "or the model fails everywhere; move or widen the prior, or give a larger measurement error",
      log_likelihood.size());
  found_.log_likelihood = log_likelihood;
  awaits_ = Awaits::moves;
}

/// Draws from the prior, again where they are impossible.
void Island::draw_start() {
  constexpr int k_max_attempts = 10000;
  const Eigen::Index particles = settings_.particles;
  proposals_.resize(particles, target_.dimension);
  found_.points.resize(particles, target_.dimension);
  std::vector<RandomStream> streams;
  std::vector<Eigen::Index> wanted;
  for (Eigen::Index i = 0; i < particles; ++i) {
    streams.push_back(stream(StreamPurpose::posterior_start, 0, static_cast<std::uint32_t>(i)));
    wanted.push_back(i);
  }
  for (int attempt = 0; !wanted.empty(); ++attempt) {
    require(
        attempt < k_max_attempts,
        "the prior is almost wholly impossible: {} draws in a row were outside the bounds or physically impossible; "
        "move its mean, or widen the bounds",
        k_max_attempts);
    Eigen::MatrixXd candidates(static_cast<Eigen::Index>(wanted.size()), target_.dimension);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      candidates.row(static_cast<Eigen::Index>(k)) =
          standard_normals(streams[static_cast<std::size_t>(wanted[k])], target_.dimension).transpose();
    }
    const std::vector<bool> possible =
        target_.is_possible ? target_.is_possible(candidates) : std::vector<bool>(wanted.size(), true);
    std::vector<Eigen::Index> rest;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      if (possible[k])
        found_.points.row(wanted[k]) = candidates.row(static_cast<Eigen::Index>(k));
      else
        rest.push_back(wanted[k]);
    }
    wanted = std::move(rest);
  }
  asked_points_ = found_.points;
}

/// The next exponent, its weights and resampling.
void Island::begin_stage() {
  ++stage_;
  const StageWeights next = next_stage(found_.log_likelihood, exponent_, settings_.effective_fraction);
  exponent_ = next.exponent;
  found_.log_evidence += next.log_mean;
  found_.stages.push_back({.exponent = exponent_, .effective_samples = next.effective_samples});
  RandomStream random = stream(StreamPurpose::posterior_resampling, 0, 0);
  start_from(systematic_parents(next.weights, random.uniform()));
}

/// Copies of particles, and the mixtures that moves are drawn from.
void Island::start_from(const std::vector<Eigen::Index>& parents) {
  constexpr double k_few = 0.9;  // of the mixture's draws: else more components can bring little
  found_.points = found_.points(parents, Eigen::all).eval();
  found_.log_likelihood = found_.log_likelihood(parents).eval();
  gradient_ = gradient_(parents, Eigen::all).eval();
  start_points_ = found_.points;
  for (std::size_t k = 0; k < 2; ++k) {
    starts_of_half_[k] = StageStart(start_points_(rows_of_half(k), Eigen::all), found_.log_likelihood(rows_of_half(k)));
  }
  accepted_ = 0.0;
  if (follows_gradients_) trajectories_.fit(found_.points);
  const bool accepts_few = global_moves_[1] < k_few * global_moves_[0];
  for (std::uint32_t k = 0; k < 2; ++k) {
    const Eigen::Index before = mixtures_[k] ? mixtures_[k]->normal_components() : 0;
    mixtures_[k] = std::make_unique<const NormalMixture>(
        found_.points(rows_of_half(k), Eigen::all), stream(StreamPurpose::posterior_proposal, 0, k),
        NormalMixture::Size{.components = before, .may_grow = accepts_few});
  }
  global_moves_ = {};
  log_mixture_.resize(found_.points.rows());
  for (Eigen::Index i = 0; i < log_mixture_.size(); ++i) {
    log_mixture_(i) = mixture_for(i).log_density(found_.points.row(i).transpose());
  }
}

void Island::give_up() {
  is_done_ = true;
  found_.is_finished = false;
}

void Island::begin_walk(const std::vector<Eigen::Index>& parents) {
  ++stage_;
  step_ = 0;
  is_walking_ = true;
  start_from(parents);
}

void Island::put_back(Eigen::Index particle, const Eigen::Ref<const Eigen::VectorXd>& point, double log_likelihood) {
  found_.points.row(particle) = point.transpose();
  found_.log_likelihood(particle) = log_likelihood;
  log_mixture_(particle) = mixture_for(particle).log_density(point);
}

/// A half moves until the other half has decorrelated: one that ended by its own particles would end when those in the
/// tails have left them.
void Island::end_move() {
  SamplingStage& stage = found_.stages.back();
  stage.moves = static_cast<int>(step_);
  stage.acceptance = accepted_ / static_cast<double>(step_);
  const int factor = exponent_ >= 1.0 ? settings_.last_stage_factor : 1;
  for (std::size_t k = 0; k < 2; ++k) {
    if (moves_of_half_[k] == 0) {
      const double correlation = correlation_with_start(1 - k);
      const bool is_decorrelated = correlation <= std::max(settings_.decorrelation, correlation_by_chance());
      if (is_decorrelated || stage.moves >= settings_.max_moves) {
        moves_of_half_[k] = std::min(settings_.max_moves, factor * stage.moves);
        stage.correlation = std::max(stage.correlation, correlation);
        stage.is_decorrelated = stage.is_decorrelated && is_decorrelated;
      }
    }
    if (stage.moves == moves_of_half_[k]) ends_of_half_[k] = state_of_half(k);
  }
  if (std::ranges::min(moves_of_half_) == 0 || stage.moves < std::ranges::max(moves_of_half_)) return;
  for (std::size_t k = 0; k < 2; ++k) take_state(k, ends_of_half_[k]);
  moves_of_half_ = {0, 0};
  step_ = 0;
  if (exponent_ >= 1.0) is_done_ = true;
  if (!is_done_ && static_cast<int>(found_.stages.size()) >= settings_.max_stages) {
    is_done_ = true;
    found_.is_finished = false;
  }
}

ParticleStates Island::state_of_half(std::size_t k) const {
  const auto rows = rows_of_half(k);
  return {found_.points(rows, Eigen::all), found_.log_likelihood(rows), gradient_(rows, Eigen::all)};
}

void Island::take_state(std::size_t k, const ParticleStates& state) {
  const auto rows = rows_of_half(k);
  found_.points(rows, Eigen::all) = state.points;
  found_.log_likelihood(rows) = state.log_likelihood;
  gradient_(rows, Eigen::all) = state.gradient;
}

/// What is exceeded once in 20 stages whose particles have nothing in common with their start.
double Island::correlation_by_chance() const {
  constexpr double k_level = 0.05;
  const auto count = static_cast<double>(2 * target_.dimension + 1);
  return -standard_normal_quantile(0.5 * k_level / count) / std::sqrt(static_cast<double>(found_.points.rows()));
}

double Island::correlation_with_start(std::size_t k) const {
  const auto rows = rows_of_half(k);
  return starts_of_half_[k].correlation_with(found_.points(rows, Eigen::all), found_.log_likelihood(rows));
}

}  // namespace mottle::updating
