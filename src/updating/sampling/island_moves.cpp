// Moves of an island's particles within a stage.
#include <algorithm>
#include <cmath>
#include <limits>

#include "updating/estimate/normal_draws.hpp"
#include "updating/sampling/island.hpp"

namespace mottle::updating {
namespace {

constexpr double k_wanted_acceptance = 0.3;
constexpr double k_jump = 0.2;  // of the steps along differences go all the way: from one mode to another
constexpr std::size_t k_kinds = 3;

}  // namespace

void Island::propose_moves() {
  awaits_ = Awaits::moves;
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
  ask(open_proposals());
}

Eigen::VectorXd Island::propose_move(Eigen::Index particle, RandomStream& random) {
  const Eigen::VectorXd x = found_.points.row(particle).transpose();
  const double uniform = random.uniform();
  const NormalMixture& mixture = mixture_for(particle);
  switch (kinds_[static_cast<std::size_t>(particle)]) {
    case Move::global:
      return mixture.draw(mixture.draw_component(uniform), random);
    case Move::local:
      return mixture.move(mixture.component_of(x, uniform), x, random, local_step_);
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

/// Beyond 37 a normal's tail probability is no number any more: what heavy tails propose there is impossible, and is
/// not put to the target.
std::vector<bool> Island::possible_proposals() const {
  constexpr double k_farthest = 37.0;
  Eigen::MatrixXd near = proposals_;
  std::vector<bool> is_near(static_cast<std::size_t>(near.rows()));
  for (std::size_t i = 0; i < is_near.size(); ++i) {
    auto row = near.row(static_cast<Eigen::Index>(i));
    is_near[i] = row.allFinite() && row.cwiseAbs().maxCoeff() <= k_farthest;
    if (!is_near[i]) row.setZero();
  }
  if (!target_.is_possible) return is_near;
  std::vector<bool> possible = target_.is_possible(near);
  for (std::size_t i = 0; i < is_near.size(); ++i) possible[i] = possible[i] && is_near[i];
  return possible;
}

/// ln of the ratio that a move of the particle is accepted by, with the proposal's log-likelihood.
double Island::gain_of(Eigen::Index particle, double log_likelihood) const {
  const double gain = exponent_ * (log_likelihood - found_.log_likelihood(particle)) -
                      0.5 * (proposals_.row(particle).squaredNorm() - found_.points.row(particle).squaredNorm());
  if (kinds_[static_cast<std::size_t>(particle)] == Move::difference) return gain;
  return gain + log_mixture_(particle) - proposed_log_mixture_(particle);
}

/// Possible proposals but for those that the largest likelihood there can be would reject: the decision is known
/// without the model, and the far tails, where a model is dearest, are not put to it.
std::vector<bool> Island::open_proposals() const {
  constexpr double k_rounding = 1e-9;
  std::vector<bool> open = possible_proposals();
  if (!target_.largest_log_likelihood) return open;
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (open[i]) rows.push_back(static_cast<Eigen::Index>(i));
  }
  const Eigen::VectorXd largest = target_.largest_log_likelihood(proposals_(rows, Eigen::all));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double most = largest(static_cast<Eigen::Index>(k));
    open[static_cast<std::size_t>(rows[k])] =
        !(gain_of(rows[k], most + k_rounding * (1.0 + std::abs(most))) <= thresholds_(rows[k]));
  }
  return open;
}

/// For the likelihoods of some proposals.
void Island::ask(const std::vector<bool>& is_wanted) {
  asked_.clear();
  for (std::size_t i = 0; i < is_wanted.size(); ++i) {
    if (is_wanted[i]) asked_.push_back(static_cast<Eigen::Index>(i));
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
    if (!(thresholds_(i) < gain_of(i, proposed))) continue;
    found_.points.row(i) = proposals_.row(i);
    found_.log_likelihood(i) = proposed;
    log_mixture_(i) = proposed_log_mixture_(i);
    if (follows_gradients_) gradient_.row(i).setConstant(std::numeric_limits<double>::quiet_NaN());
    accepted[static_cast<std::size_t>(kind)] += 1.0;
  }
  if (is_walking_) return;
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
  global_moves_[0] += tried[static_cast<std::size_t>(Move::global)];
  global_moves_[1] += accepted[static_cast<std::size_t>(Move::global)];
  global_share_ = std::clamp(2.0 * rate(Move::global), k_least_share, k_most_share);
  local_step_ = std::clamp(local_step_ * std::exp(rate(Move::local) - k_wanted_acceptance), k_smallest_step, 1.0);
  difference_step_ =
      std::max(difference_step_ * std::exp(rate(Move::difference) - k_wanted_acceptance), k_smallest_step);
  double sum = 0.0;
  for (const double count : accepted) sum += count;
  accepted_ += sum / static_cast<double>(kinds_.size());
}

/// Where a particle has moved by other means since its gradient was known, it is asked for before trajectories start.
void Island::ask_gradients() {
  awaits_ = Awaits::gradients;
  proposals_ = found_.points;
  std::vector<bool> is_missing(static_cast<std::size_t>(proposals_.rows()));
  for (std::size_t i = 0; i < is_missing.size(); ++i) {
    is_missing[i] = !gradient_.row(static_cast<Eigen::Index>(i)).allFinite();
  }
  ask(is_missing);
  if (asked_.empty()) start_trajectories();
}

void Island::keep_gradients(const Eigen::Ref<const Eigen::MatrixXd>& gradient) {
  for (std::size_t k = 0; k < asked_.size(); ++k) {
    gradient_.row(asked_[k]) = gradient.row(static_cast<Eigen::Index>(k));
  }
}

void Island::start_trajectories() {
  awaits_ = Awaits::trajectories;
  std::vector<RandomStream> streams;
  thresholds_.resize(found_.points.rows());
  for (Eigen::Index i = 0; i < thresholds_.size(); ++i) {
    streams.push_back(stream(StreamPurpose::posterior_move, step_, static_cast<std::uint32_t>(i)));
    thresholds_(i) = std::log(streams.back().uniform());
  }
  trajectories_.start({found_.points, found_.log_likelihood, gradient_}, exponent_, streams);
  advance_trajectories();
}

void Island::advance_trajectories() {
  proposals_ = trajectories_.advance();
  const std::vector<bool> possible = possible_proposals();
  for (std::size_t i = 0; i < possible.size(); ++i) {
    if (!possible[i] && trajectories_.are_moving()[i]) trajectories_.stop(static_cast<Eigen::Index>(i));
  }
  ask(trajectories_.are_moving());
}

void Island::follow_trajectories(const Eigen::Ref<const Eigen::VectorXd>& log_likelihood,
                                 const Eigen::Ref<const Eigen::MatrixXd>& gradient) {
  for (std::size_t k = 0; k < asked_.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    trajectories_.receive(asked_[k], log_likelihood(row), gradient.row(row));
  }
  trajectories_.finish_step();
  if (trajectories_.are_done()) judge_trajectories();
}

void Island::judge_trajectories() {
  const ParticleStates& ends = trajectories_.ends();
  double accepted = 0.0;
  for (Eigen::Index i = 0; i < thresholds_.size(); ++i) {
    if (!(thresholds_(i) < trajectories_.gains()(i))) continue;
    found_.points.row(i) = ends.points.row(i);
    found_.log_likelihood(i) = ends.log_likelihood(i);
    gradient_.row(i) = ends.gradient.row(i);
    log_mixture_(i) = mixture_for(i).log_density(found_.points.row(i).transpose());
    accepted += 1.0;
  }
  accepted_ += accepted / static_cast<double>(thresholds_.size());
  SamplingStage& stage = found_.stages.back();
  stage.trajectories += thresholds_.size();
  stage.divergences += trajectories_.divergences();
  trajectories_.adapt();
  end_move();
}

}  // namespace mottle::updating
