#include "updating/population/population_coordinates.hpp"

#include <cmath>
#include <utility>

namespace mottle::updating {
namespace {

constexpr double k_least_deviation = 1e-3;  // of the prior's: no scatter for every purpose
constexpr double k_largest_deviation = 30.0;
constexpr double k_most_fisher_z = 2.65;  // a correlation of 0.99
constexpr double k_least_level = 1e-4;
constexpr double k_largest_level = 30.0;
constexpr double k_farthest_mean = 100.0;  // prior standard deviations

}  // namespace

PopulationCoordinates::PopulationCoordinates(const UpdatingProblem& problem, const ScaledParameters& parameters,
                                             NoiseModel noise, bool has_correlations)
    : noise_(std::move(noise)), prior_mean_(parameters.start()), prior_std_(parameters.standard_deviation()) {
  const Eigen::Index q = parameters.count();
  const std::vector<int>& groups = problem.covariance_groups;
  for (Eigen::Index i = 0; has_correlations && i < q; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const bool is_free = groups.empty() || groups[static_cast<std::size_t>(i)] == groups[static_cast<std::size_t>(j)];
      if (is_free) pairs_.push_back({i, j});
    }
  }
  const Eigen::Index count = 2 * q + correlations() + levels();
  start_ = Eigen::VectorXd::Zero(count);
  lower_.resize(count);
  upper_.resize(count);
  const auto in_prior = [&](const Eigen::VectorXd& t) {
    return Eigen::VectorXd((t - prior_mean_).cwiseQuotient(prior_std_));
  };
  const Eigen::VectorXd far = k_farthest_mean * prior_std_;
  lower_.head(q) = in_prior(parameters.clamp(prior_mean_ - far));
  upper_.head(q) = in_prior(parameters.clamp(prior_mean_ + far));
  start_.head(q) = in_prior(parameters.clamp(prior_mean_));
  lower_.segment(q, q).setConstant(std::log(k_least_deviation));
  upper_.segment(q, q).setConstant(std::log(k_largest_deviation));
  lower_.segment(2 * q, correlations()).setConstant(-k_most_fisher_z);
  upper_.segment(2 * q, correlations()).setConstant(k_most_fisher_z);
  lower_.tail(levels()).setConstant(std::log(k_least_level));
  upper_.tail(levels()).setConstant(std::log(k_largest_level));
}

Eigen::VectorXd PopulationCoordinates::widths() const {
  constexpr double k_mean = 30.0;
  constexpr double k_logarithm = 3.0;
  constexpr double k_fisher_z = 2.0;
  Eigen::VectorXd widths = Eigen::VectorXd::Constant(count(), k_logarithm);
  widths.head(parameters()).setConstant(k_mean);
  widths.segment(2 * parameters(), correlations()).setConstant(k_fisher_z);
  return widths;
}

Eigen::VectorXd PopulationCoordinates::standard_deviations(const Eigen::Ref<const Eigen::VectorXd>& coordinates) const {
  return prior_std_.array() * coordinates.segment(parameters(), parameters()).array().exp();
}

SampledPopulation PopulationCoordinates::at(const Eigen::Ref<const Eigen::VectorXd>& coordinates) const {
  const Eigen::Index q = parameters();
  SampledPopulation population;
  population.mean = prior_mean_ + prior_std_.cwiseProduct(coordinates.head(q));
  Eigen::MatrixXd root = Eigen::MatrixXd::Identity(q, q);
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    // Of the row's squared length, what earlier columns left is shared out to this one; the diagonal keeps the rest.
    const auto& [row, column] = pairs_[k];
    const double partial = std::tanh(coordinates(2 * q + static_cast<Eigen::Index>(k)));
    root(row, column) = partial * root(row, row);
    root(row, row) *= std::sqrt(1.0 - partial * partial);
  }
  population.factor = standard_deviations(coordinates).asDiagonal() * root;
  population.noise_std = noise_.base.cwiseSqrt();
  for (Eigen::Index k = 0; k < population.noise_std.size(); ++k) {
    const int level = noise_.factor[static_cast<std::size_t>(k)];
    if (level >= 0) population.noise_std(k) *= std::exp(coordinates(2 * q + correlations() + level));
  }
  return population;
}

}  // namespace mottle::updating
