#include "updating/sampling/island.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::updating {
namespace {

constexpr double k_minus_infinity = -std::numeric_limits<double>::infinity();
constexpr double k_wanted_acceptance = 0.3;
constexpr double k_jump = 0.2;  // of the steps along differences go all the way: from one mode to another
constexpr std::size_t k_kinds = 3;

Eigen::VectorXd draw_normals(RandomStream& random, Eigen::Index count) {
  Eigen::VectorXd normals(count);
  for (double& value : normals) value = standard_normal_quantile(random.uniform());
  return normals;
}

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
    : target_(target), settings_(settings), seed_(seed), number_(number) {
  difference_step_ = 2.38 / std::sqrt(2.0 * static_cast<double>(target.dimension));
}

RandomStream Island::stream(StreamPurpose purpose, std::uint32_t step, std::uint32_t particle) const {
  return {{.seed = seed_, .purpose = purpose, .iteration = (stage_ << 16U) + step}, (number_ << 24U) + particle};
}

const Eigen::MatrixXd& Island::propose() {
  if (!is_started_) {
    draw_start();
  } else {
    if (step_ == 0) begin_stage();
    propose_moves();
  }
  return asked_points_;
}

void Island::receive(const Eigen::Ref<const Eigen::VectorXd>& log_likelihood) {
  const Eigen::VectorXd known =
      log_likelihood.unaryExpr([](double value) { return std::isnan(value) ? k_minus_infinity : value; });
  require(known.size() == 0 || known.maxCoeff() < std::numeric_limits<double>::infinity(),
          "the likelihood is infinite at some parameters: a standard deviation of the noise is zero there");
  if (is_started_) return judge_moves(known);
  require(
      known.maxCoeff() > k_minus_infinity,
      "none of {} draws of the prior has a likelihood above zero: the prior has no probability where the tests are, "
      "or the model fails everywhere; move or widen the prior, or give a larger measurement error",
      known.size());
  found_.log_likelihood = known;
  is_started_ = true;
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
          draw_normals(streams[static_cast<std::size_t>(wanted[k])], target_.dimension).transpose();
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
  Eigen::Index parent = 0;
  double sum = weights(0);
  for (Eigen::Index i = 0; i < particles; ++i) {
    const double place = (static_cast<double>(i) + shift) / static_cast<double>(particles);
    while (sum < place && parent + 1 < particles) sum += weights(++parent);
    points.row(i) = found_.points.row(parent);
    log_likelihood(i) = found_.log_likelihood(parent);
  }
  found_.points = std::move(points);
  found_.log_likelihood = std::move(log_likelihood);
}

void Island::propose_moves() {
  ++step_;
  const Eigen::Index particles = found_.points.rows();
  proposals_.resize(particles, target_.dimension);
  proposed_log_mixture_.resize(particles);
  thresholds_.resize(particles);
  kinds_.resize(static_cast<std::size_t>(particles));
  for (Eigen::Index i = 0; i < particles; ++i) {
    RandomStream random = stream(StreamPurpose::posterior_move, step_, static_cast<std::uint32_t>(i));
    thresholds_(i) = std::log(random.uniform());
    const double kind = random.uniform();
    const double local_share = 0.5 * (1.0 - global_share_);
    kinds_[static_cast<std::size_t>(i)] = kind < global_share_                 ? Move::global
                                          : kind < global_share_ + local_share ? Move::local
                                                                               : Move::difference;
    proposals_.row(i) = propose_move(i, random).transpose();
    proposed_log_mixture_(i) = mixture_for(i).log_density(proposals_.row(i).transpose());
  }
  keep_possible();
}

Eigen::VectorXd Island::propose_move(Eigen::Index particle, RandomStream& random) {
  const Eigen::VectorXd x = found_.points.row(particle).transpose();
  const double uniform = random.uniform();
  const NormalMixture& mixture = mixture_for(particle);
  switch (kinds_[static_cast<std::size_t>(particle)]) {
    case Move::global:
      return mixture.move(mixture.draw_component(uniform), x, draw_normals(random, x.size()), 1.0);
    case Move::local:
      return mixture.move(mixture.component_of(x, uniform), x, draw_normals(random, x.size()), local_step_);
    case Move::difference:
      break;
  }
  const Eigen::Index begin = particle < half() ? half() : 0;
  const auto count = static_cast<double>(begin == 0 ? half() : start_points_.rows() - half());
  const auto first = begin + static_cast<Eigen::Index>(random.uniform() * count);
  const auto second = begin + static_cast<Eigen::Index>(random.uniform() * count);
  const double step = uniform < k_jump ? 1.0 : difference_step_;
  return x + step * (start_points_.row(first) - start_points_.row(second)).transpose();
}

void Island::keep_possible() {
  const std::vector<bool> possible = target_.is_possible
                                         ? target_.is_possible(proposals_)
                                         : std::vector<bool>(static_cast<std::size_t>(proposals_.rows()), true);
  asked_.clear();
  for (std::size_t i = 0; i < possible.size(); ++i) {
    if (possible[i]) asked_.push_back(static_cast<Eigen::Index>(i));
  }
  asked_points_.resize(static_cast<Eigen::Index>(asked_.size()), target_.dimension);
  for (std::size_t k = 0; k < asked_.size(); ++k) {
    asked_points_.row(static_cast<Eigen::Index>(k)) = proposals_.row(asked_[k]);
  }
}

void Island::judge_moves(const Eigen::Ref<const Eigen::VectorXd>& log_likelihood) {
  std::vector<double> tried(k_kinds, 0.0);
  std::vector<double> accepted(k_kinds, 0.0);
  for (const Move kind : kinds_) tried[static_cast<std::size_t>(kind)] += 1.0;
  for (std::size_t k = 0; k < asked_.size(); ++k) {
    const Eigen::Index i = asked_[k];
    const auto kind = kinds_[static_cast<std::size_t>(i)];
    const double proposed = log_likelihood(static_cast<Eigen::Index>(k));
    double gain = exponent_ * (proposed - found_.log_likelihood(i)) -
                  0.5 * (proposals_.row(i).squaredNorm() - found_.points.row(i).squaredNorm());
    if (kind != Move::difference) gain += log_mixture_(i) - proposed_log_mixture_(i);
    if (!(thresholds_(i) < gain)) continue;
    found_.points.row(i) = proposals_.row(i);
    found_.log_likelihood(i) = proposed;
    log_mixture_(i) = proposed_log_mixture_(i);
    accepted[static_cast<std::size_t>(kind)] += 1.0;
  }
  adapt(tried, accepted);
  end_move();
}

/// Steps by acceptance, and more draws of the mixture where these are accepted.
void Island::adapt(const std::vector<double>& tried, const std::vector<double>& accepted) {
  constexpr double k_least_share = 0.1;
  constexpr double k_most_share = 0.6;
  constexpr double k_smallest_step = 1e-3;
  const auto rate = [&](Move kind) {
    const auto k = static_cast<std::size_t>(kind);
    return tried[k] > 0.0 ? accepted[k] / tried[k] : k_wanted_acceptance;
  };
  global_share_ = std::clamp(2.0 * rate(Move::global), k_least_share, k_most_share);
  local_step_ = std::clamp(local_step_ * std::exp(rate(Move::local) - k_wanted_acceptance), k_smallest_step, 1.0);
  difference_step_ =
      std::max(difference_step_ * std::exp(rate(Move::difference) - k_wanted_acceptance), k_smallest_step);
  double sum = 0.0;
  for (const double count : accepted) sum += count;
  accepted_ += sum / static_cast<double>(kinds_.size());
}

void Island::end_move() {
  SamplingStage& stage = found_.stages.back();
  stage.moves = static_cast<int>(step_);
  stage.acceptance = accepted_ / static_cast<double>(step_);
  stage.correlation = correlation_with_start();
  if (stage.correlation > settings_.decorrelation && stage.moves < settings_.max_moves) return;
  step_ = 0;
  if (exponent_ >= 1.0) is_done_ = true;
  if (!is_done_ && static_cast<int>(found_.stages.size()) >= settings_.max_stages) {
    is_done_ = true;
    found_.is_finished = false;
  }
}

double Island::correlation_with_start() const {
  double largest = std::abs(correlation(start_log_likelihood_.array(), found_.log_likelihood.array()));
  for (Eigen::Index j = 0; j < start_points_.cols(); ++j) {
    largest = std::max(largest, std::abs(correlation(start_points_.col(j).array(), found_.points.col(j).array())));
  }
  return largest;
}

}  // namespace mottle::updating
