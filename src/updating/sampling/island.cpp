#include "updating/sampling/island.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "updating/estimate/normal_draws.hpp"

namespace mottle::updating {
namespace {

constexpr double k_minus_infinity = -std::numeric_limits<double>::infinity();

/// (sum w)^2 / sum w^2 of weights exp(increment log_likelihood), the largest of which is 1.
double effective_of(const Eigen::VectorXd& log_likelihood, double largest, double increment) {
  double sum = 0.0;
  double squares = 0.0;
  for (const double value : log_likelihood) {
    if (value == k_minus_infinity) continue;
    const double weight = std::exp(increment * (value - largest));
    sum += weight;
    squares += weight * weight;
  }
  return sum * sum / squares;
}

double correlation(const Eigen::ArrayXd& first, const Eigen::ArrayXd& second) {
  const Eigen::ArrayXd a = first - first.mean();
  const Eigen::ArrayXd b = second - second.mean();
  const double scale = std::sqrt(a.square().sum() * b.square().sum());
  return scale > 0.0 ? (a * b).sum() / scale : 0.0;
}

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
    if (step_ == 0) begin_stage();
    ++step_;
    if (!follows_gradients_ || step_ % k_gradient_cycle == 0)
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

/// The next exponent, its weights, resampling, and the mixture that moves are drawn from.
void Island::begin_stage() {
  ++stage_;
  const double largest = found_.log_likelihood.maxCoeff();
  const double increment = next_increment();
  exponent_ = exponent_ + increment >= 1.0 ? 1.0 : exponent_ + increment;
  const Eigen::VectorXd weights =
      found_.log_likelihood.unaryExpr([&](double value) { return std::exp(increment * (value - largest)); });
  found_.log_evidence += increment * largest + std::log(weights.mean());
  found_.stages.push_back(
      {.exponent = exponent_, .effective_samples = weights.sum() * weights.sum() / weights.squaredNorm()});
  resample(weights / weights.sum());
  start_points_ = found_.points;
  start_log_likelihood_ = found_.log_likelihood;
  accepted_ = 0.0;
  if (follows_gradients_) trajectories_.fit(found_.points);
  for (std::uint32_t k = 0; k < 2; ++k) {
    const Eigen::Index first = k == 0 ? 0 : half();
    const Eigen::Index count = k == 0 ? half() : found_.points.rows() - half();
    mixtures_[k] = std::make_unique<const NormalMixture>(found_.points.middleRows(first, count),
                                                         stream(StreamPurpose::posterior_proposal, 0, k));
  }
  log_mixture_.resize(found_.points.rows());
  for (Eigen::Index i = 0; i < log_mixture_.size(); ++i) {
    log_mixture_(i) = mixture_for(i).log_density(found_.points.row(i).transpose());
  }
}

double Island::next_increment() const {
  constexpr int k_halvings = 100;
  const double largest = found_.log_likelihood.maxCoeff();
  const auto alive = static_cast<double>((found_.log_likelihood.array() > k_minus_infinity).count());
  const double wanted = settings_.effective_fraction * alive;
  double high = 1.0 - exponent_;
  if (effective_of(found_.log_likelihood, largest, high) >= wanted) return high;
  double low = 0.0;
  for (int halving = 0; halving < k_halvings; ++halving) {
    const double middle = 0.5 * (low + high);
    if (!(middle > low && middle < high)) break;
    (effective_of(found_.log_likelihood, largest, middle) >= wanted ? low : high) = middle;
  }
  return high;
}

void Island::resample(const Eigen::VectorXd& weights) {
  const Eigen::Index particles = found_.points.rows();
  RandomStream random = stream(StreamPurpose::posterior_resampling, 0, 0);
  const double shift = random.uniform();
  Eigen::MatrixXd points(particles, target_.dimension);
  Eigen::VectorXd log_likelihood(particles);
  Eigen::MatrixXd gradient(particles, gradient_.cols());
  Eigen::Index parent = 0;
  double sum = weights(0);
  for (Eigen::Index i = 0; i < particles; ++i) {
    const double place = (static_cast<double>(i) + shift) / static_cast<double>(particles);
    while (sum < place && parent + 1 < particles) sum += weights(++parent);
    points.row(i) = found_.points.row(parent);
    log_likelihood(i) = found_.log_likelihood(parent);
    gradient.row(i) = gradient_.row(parent);
  }
  found_.points = std::move(points);
  found_.log_likelihood = std::move(log_likelihood);
  gradient_ = std::move(gradient);
}

void Island::end_move() {
  constexpr int k_of_last_stage = 4;  // times as many moves: its particles are the draws, and it is one of many stages
  SamplingStage& stage = found_.stages.back();
  stage.moves = static_cast<int>(step_);
  stage.acceptance = accepted_ / static_cast<double>(step_);
  if (wanted_moves_ == 0) {
    stage.correlation = correlation_with_start();
    stage.is_decorrelated = stage.correlation <= std::max(settings_.decorrelation, correlation_by_chance());
    if (!stage.is_decorrelated && stage.moves < settings_.max_moves) return;
    wanted_moves_ = std::min(settings_.max_moves, (exponent_ >= 1.0 ? k_of_last_stage : 1) * stage.moves);
  }
  if (stage.moves < wanted_moves_) return;
  step_ = 0;
  wanted_moves_ = 0;
  if (exponent_ >= 1.0) is_done_ = true;
  if (!is_done_ && static_cast<int>(found_.stages.size()) >= settings_.max_stages) {
    is_done_ = true;
    found_.is_finished = false;
  }
}

/// What is exceeded once in 20 stages whose particles have nothing in common with their start.
double Island::correlation_by_chance() const {
  constexpr double k_level = 0.05;
  const auto count = static_cast<double>(2 * target_.dimension + 1);
  return -standard_normal_quantile(0.5 * k_level / count) / std::sqrt(static_cast<double>(found_.points.rows()));
}

/// Of coordinates, of their squares about the mean, which see the tails, and of the log-likelihood.
double Island::correlation_with_start() const {
  double largest = std::abs(correlation(start_log_likelihood_.array(), found_.log_likelihood.array()));
  for (Eigen::Index j = 0; j < start_points_.cols(); ++j) {
    const Eigen::ArrayXd start = start_points_.col(j).array() - start_points_.col(j).mean();
    const Eigen::ArrayXd now = found_.points.col(j).array() - found_.points.col(j).mean();
    largest =
        std::max({largest, std::abs(correlation(start, now)), std::abs(correlation(start.square(), now.square()))});
  }
  return largest;
}

}  // namespace mottle::updating
