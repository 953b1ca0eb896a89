#include "updating/sampling/trajectories.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/linalg/dense/decompositions.hpp"
#include "updating/estimate/normal_draws.hpp"

namespace mottle::updating {
namespace {

constexpr double k_wanted_acceptance = 0.8;  // at which a step is cheapest, [Neal2011]
constexpr double k_smallest_step = 0.01;
constexpr double k_largest_step = 1.5;  // beyond 2 a normal posterior is unstable
constexpr double k_divergence = 1000.0;
constexpr double k_minus_infinity = -std::numeric_limits<double>::infinity();

/// L of the covariance of particles, drawn towards its diagonal as by as many particles as a matrix has rows.
Eigen::MatrixXd covariance_factor(const Eigen::Ref<const Eigen::MatrixXd>& points) {
  const auto n = static_cast<double>(points.rows());
  const auto d = static_cast<double>(points.cols());
  const Eigen::MatrixXd apart = points.rowwise() - points.colwise().mean();
  Eigen::MatrixXd covariance = apart.transpose() * apart / (n + d);
  covariance.diagonal() *= (n + d) / n;
  covariance.diagonal() = covariance.diagonal().cwiseMax(1e-24);  // of a coordinate in which no particle differs
  return CholeskyFactor(covariance).lower();
}

}  // namespace

void Trajectories::fit(const Eigen::MatrixXd& points) {
  const Eigen::Index first_half = points.rows() / 2;
  factors_[0] = covariance_factor(points.bottomRows(points.rows() - first_half));
  factors_[1] = covariance_factor(points.topRows(first_half));
  if (step_ == 0.0) step_ = std::pow(static_cast<double>(points.cols()), -0.25);
}

void Trajectories::start(const ParticleStates& from, double exponent, std::vector<RandomStream>& streams) {
  constexpr double k_shortest = 0.25 * std::numbers::pi;
  constexpr double k_longest = 0.75 * std::numbers::pi;
  now_ = from;
  exponent_ = exponent;
  divergences_ = 0;
  const Eigen::Index particles = from.points.rows();
  momenta_.resize(particles, from.points.cols());
  steps_.resize(particles);
  start_energy_.resize(particles);
  gains_ = Eigen::VectorXd::Constant(particles, k_minus_infinity);
  left_.resize(static_cast<std::size_t>(particles));
  is_moving_.assign(left_.size(), true);
  moving_ = particles;
  for (Eigen::Index i = 0; i < particles; ++i) {
    RandomStream& random = streams[static_cast<std::size_t>(i)];
    const double time = k_shortest + random.uniform() * (k_longest - k_shortest);
    momenta_.row(i) = standard_normals(random, from.points.cols()).transpose();
    const double steps = std::ceil(time / step_);
    left_[static_cast<std::size_t>(i)] = static_cast<int>(steps);
    steps_(i) = time / steps;
    start_energy_(i) = energy(i);
    if (!now_.gradient.row(i).allFinite()) {
      ++divergences_;
      stop(i);
    }
  }
}

double Trajectories::energy(Eigen::Index particle) const {
  return 0.5 * (now_.points.row(particle).squaredNorm() + momenta_.row(particle).squaredNorm()) -
         exponent_ * now_.log_likelihood(particle);
}

void Trajectories::stop(Eigen::Index particle) {
  steps_(particle) = 0.0;
  is_moving_[static_cast<std::size_t>(particle)] = false;
  --moving_;
  now_.gradient.row(particle).setZero();  // which is not to be known where it does not count
}

/// Half a step of the momenta.
void Trajectories::kick() {
  const Eigen::MatrixXd force = exponent_ * now_.gradient - now_.points;
  const Eigen::Index rest = force.rows() - half();
  momenta_.topRows(half()) += (0.5 * steps_.head(half())).asDiagonal() * (force.topRows(half()) * factors_[0]);
  momenta_.bottomRows(rest) += (0.5 * steps_.tail(rest)).asDiagonal() * (force.bottomRows(rest) * factors_[1]);
}

const Eigen::MatrixXd& Trajectories::advance() {
  kick();
  const Eigen::Index rest = momenta_.rows() - half();
  now_.points.topRows(half()) +=
      steps_.head(half()).asDiagonal() * (momenta_.topRows(half()) * factors_[0].transpose());
  now_.points.bottomRows(rest) +=
      steps_.tail(rest).asDiagonal() * (momenta_.bottomRows(rest) * factors_[1].transpose());
  return now_.points;
}

void Trajectories::receive(Eigen::Index particle, double log_likelihood,
                           const Eigen::Ref<const Eigen::RowVectorXd>& gradient) {
  now_.log_likelihood(particle) = log_likelihood;
  now_.gradient.row(particle) = gradient;
  if (std::isfinite(log_likelihood) && gradient.allFinite()) return;
  if (std::isfinite(log_likelihood)) ++divergences_;
  stop(particle);
}

void Trajectories::finish_step() {
  kick();
  for (std::size_t k = 0; k < left_.size(); ++k) {
    if (!is_moving_[k]) continue;
    const auto i = static_cast<Eigen::Index>(k);
    const double gain = start_energy_(i) - energy(i);
    if (!(gain > -k_divergence)) {
      ++divergences_;
      stop(i);
    } else if (--left_[k] == 0) {
      gains_(i) = gain;
      steps_(i) = 0.0;
      is_moving_[k] = false;
      --moving_;
    }
  }
}

void Trajectories::adapt() {
  const double acceptance = gains_.unaryExpr([](double gain) { return std::exp(std::min(gain, 0.0)); }).mean();
  step_ = std::clamp(step_ * std::exp(acceptance - k_wanted_acceptance), k_smallest_step, k_largest_step);
}

}  // namespace mottle::updating
