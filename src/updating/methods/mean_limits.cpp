#include "updating/methods/mean_limits.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/core/random.hpp"
#include "mottle/core/text.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "updating/fits/scaled_parameters.hpp"

namespace mottle::updating {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

/// Bounds that are near to the free mean: how far it lies within each, in standard errors.
struct NearBounds {
  std::vector<Eigen::Index> parameters;
  Eigen::VectorXd slack;        // negative: beyond
  Eigen::MatrixXd correlation;  // of the slacks
};

NearBounds find_near_bounds(const ScaledParameters& parameters, const FreeMean& free) {
  constexpr double k_near = 3.0;  // standard errors: bounds further away change the law by less than a per mille
  const Eigen::Index q = free.mean.size();
  const Eigen::VectorXd lower = parameters.clamp(Eigen::VectorXd::Constant(q, -k_infinity));
  const Eigen::VectorXd upper = parameters.clamp(Eigen::VectorXd::Constant(q, k_infinity));
  NearBounds near;
  std::vector<double> slack;
  std::vector<double> sign;
  for (Eigen::Index i = 0; i < q; ++i) {
    const double error = std::sqrt(free.covariance(i, i));
    if (!(error > 0.0)) continue;
    const double below = (free.mean(i) - lower(i)) / error;
    const double above = (upper(i) - free.mean(i)) / error;
    if (std::min(below, above) > k_near) continue;
    near.parameters.push_back(i);
    slack.push_back(std::min(below, above));
    sign.push_back((below < above ? 1.0 : -1.0) / error);
  }
  near.slack = Eigen::Map<const Eigen::VectorXd>(slack.data(), static_cast<Eigen::Index>(slack.size()));
  const Eigen::VectorXd scale = Eigen::Map<const Eigen::VectorXd>(sign.data(), near.slack.size());
  near.correlation = scale.asDiagonal() * free.covariance(near.parameters, near.parameters) * scale.asDiagonal();
  near.correlation.diagonal().array() += 1e-9;  // means that move only together
  return near;
}

double distance_from_cone(const Eigen::VectorXd& slack, const Eigen::MatrixXd& correlation) {
  const Eigen::VectorXd beyond = nearest_non_negative(slack, correlation) - slack;
  return std::sqrt(std::max(beyond.dot(CholeskyFactor(correlation).solve(beyond)), 0.0));
}

/// Distances of means whose truth lies on all the bounds, ascending.
std::vector<double> drawn_distances(const Eigen::MatrixXd& correlation, double degrees_of_freedom) {
  constexpr std::uint32_t k_draws = 4000;  // a level of 1 % to 0.16 %
  const Eigen::MatrixXd root = CholeskyFactor(correlation).lower();
  const bool is_known = std::isinf(degrees_of_freedom);
  const boost::math::chi_squared law(is_known ? 1.0 : degrees_of_freedom);
  std::vector<double> distances;
  for (std::uint32_t r = 0; r < k_draws; ++r) {
    RandomStream stream({.seed = 1, .purpose = StreamPurpose::bootstrap}, r);
    Eigen::VectorXd normal(correlation.rows());
    for (double& value : normal) value = standard_normal_quantile(stream.uniform());
    const double error = is_known ? 1.0 : std::sqrt(boost::math::quantile(law, stream.uniform()) / degrees_of_freedom);
    distances.push_back(distance_from_cone(root * normal, correlation) / error);
  }
  std::sort(distances.begin(), distances.end());
  return distances;
}

void add_laws(const NearBounds& near, double degrees_of_freedom, PlannedTest& test) {
  if (near.slack.size() == 1) {
    const boost::math::students_t law(std::min(degrees_of_freedom, 1e9));
    test.p_value = boost::math::cdf(complement(law, test.statistic));
    test.critical = [=](double level) { return boost::math::quantile(complement(law, level)); };
    return;
  }
  const std::vector<double> distances = drawn_distances(near.correlation, degrees_of_freedom);
  const auto count = static_cast<double>(distances.size());
  const auto first = std::lower_bound(distances.begin(), distances.end(), test.statistic);
  test.p_value = (static_cast<double>(std::distance(first, distances.end())) + 1.0) / (count + 1.0);
  test.critical = [=](double level) {
    const auto place = static_cast<std::size_t>(std::min((1.0 - level) * count, count - 1.0));
    return distances[place];
  };
}

}  // namespace

Eigen::VectorXd nearest_non_negative(const Eigen::Ref<const Eigen::VectorXd>& mean,
                                     const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  constexpr int k_max_rounds = 10000;
  constexpr double k_at_rest = 1e-12;
  const Eigen::MatrixXd precision = inverse_by_lu(covariance);
  Eigen::VectorXd u = mean.cwiseMax(0.0);
  for (int round = 0; round < k_max_rounds; ++round) {
    double change = 0.0;
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      const double gradient = precision.row(i).dot(u - mean);
      const double next = std::max(u(i) - gradient / precision(i, i), 0.0);
      change = std::max(change, std::abs(next - u(i)));
      u(i) = next;
    }
    if (change <= k_at_rest * (1.0 + mean.cwiseAbs().maxCoeff())) break;
  }
  return u;
}

void plan_bound_test(const UpdatingProblem& problem, const FreeMean& free, TestPlan& plan) {
  const ScaledParameters parameters(problem.space);
  const NearBounds near = find_near_bounds(parameters, free);
  if (near.parameters.empty() || !free.mean.allFinite()) return;
  std::vector<std::string> beyond;
  const Eigen::VectorXd values = parameters.to_variables(free.mean.transpose()).row(0);
  for (std::size_t k = 0; k < near.parameters.size(); ++k) {
    if (near.slack(static_cast<Eigen::Index>(k)) >= 0.0) continue;
    const Eigen::Index i = near.parameters[k];
    beyond.push_back(
        fmt::format("{} = {:.4g}", problem.space.parameters()[static_cast<std::size_t>(i)].name, values(i)));
  }
  PlannedTest test{.name = "bounds", .statistic = distance_from_cone(near.slack, near.correlation)};
  test.is_listed_where_it_passes = !beyond.empty();
  test.meaning = fmt::format(
      "Without bounds the means would be {}: are they, within their standard errors, still within bounds and physical "
      "limits?",
      join(beyond));
  add_laws(near, free.degrees_of_freedom, test);
  plan.add(std::move(test));
}

void plan_prior_shift(const UpdatingProblem& problem, const Eigen::Ref<const Eigen::VectorXd>& mean,
                      const Eigen::Ref<const Eigen::MatrixXd>& covariance, TestPlan& plan) {
  constexpr double k_absurd = 10.0;
  const PriorOnScales prior = prior_on_scales(problem.space);
  const Eigen::ArrayXd spread = (prior.covariance.diagonal() + covariance.diagonal()).cwiseSqrt();
  Eigen::Index worst = 0;
  const double shift = ((mean - prior.mean).array().abs() / spread).maxCoeff(&worst);
  if (!std::isfinite(shift)) return;
  plan.add({.name = "prior-shift",
            .statistic = shift,
            .p_value = std::min(1.0, 4.0 / (9.0 * std::max(shift * shift, 1e-300))),
            .critical = [](double) { return k_absurd; },
            .meaning = fmt::format(
                "Shift of a mean from its prior in standard deviations of both, largest for {}: is the prior of a "
                "structure like the one that was tested (units, model, parameter)?",
                problem.space.parameters()[static_cast<std::size_t>(worst)].name),
            .share = 0.0,
            .is_listed_where_it_passes = false});
}

}  // namespace mottle::updating
