#include "updating/population/population_prior.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <map>
#include <optional>

#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/distributions/student_t.hpp"
#include "mottle/stats/distributions/transformed_moments.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/methods/posterior_target.hpp"

namespace mottle::updating {
namespace {

/// Quantiles to 15 digits are worth no long double, and a tail beyond all numbers is infinite.
using Policy =
    boost::math::policies::policy<boost::math::policies::promote_double<false>,
                                  boost::math::policies::overflow_error<boost::math::policies::ignore_error>>;
using ChiSquared = boost::math::chi_squared_distribution<double, Policy>;

/// sqrt(chi^2) of a score.
double chi(double score, double degrees_of_freedom) {
  const ChiSquared chi_squared(degrees_of_freedom);
  const double tail = standard_normal_cdf(-std::abs(score));
  return std::sqrt(score > 0.0 ? quantile(complement(chi_squared, tail)) : quantile(chi_squared, tail));
}

/// The prior's standard deviations on the scales: of the normal t that gives x its moments, to first order where there
/// is none.
Eigen::VectorXd deviations_on_scales(const ParameterSpace& space) {
  Eigen::VectorXd deviations = prior_on_scales(space).covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd mean = space.prior().mean();
  const Eigen::MatrixXd covariance = space.prior().covariance();
  for (Eigen::Index i = 0; i < deviations.size(); ++i) {
    const std::optional<TransformedMoments> exact = moments_of_transformed(
        space.parameters()[static_cast<std::size_t>(i)].transform, mean(i), std::sqrt(covariance(i, i)));
    if (exact) deviations(i) = exact->std;
  }
  return deviations;
}

std::vector<std::vector<Eigen::Index>> groups_of(const UpdatingProblem& problem) {
  std::map<int, std::vector<Eigen::Index>> groups;
  for (Eigen::Index i = 0; i < problem.space.count(); ++i) {
    const int group = problem.covariance_groups.empty() ? 0 : problem.covariance_groups[static_cast<std::size_t>(i)];
    groups[group].push_back(i);
  }
  std::vector<std::vector<Eigen::Index>> list;
  for (auto& [number, group] : groups) list.push_back(std::move(group));
  return list;
}

}  // namespace

PopulationPrior::PopulationPrior(const UpdatingProblem& problem, const HierarchicalOptions& options,
                                 const NoiseLevels& noise)
    : problem_(problem),
      options_(options),
      noise_(noise),
      scale_(options.scatter_scale * deviations_on_scales(problem.space)),
      groups_(groups_of(problem)) {
  const Eigen::VectorXd variance = problem.tests.model_error_variance();
  for (Eigen::Index k = 0; k < variance.size(); ++k) {
    if (variance(k) > 0.0) with_error_.push_back(k);
  }
}

Eigen::Index PopulationPrior::pairs() const {
  Eigen::Index sum = 0;
  for (const auto& group : groups_) sum += static_cast<Eigen::Index>(group.size() * (group.size() - 1) / 2);
  return sum;
}

Eigen::Index PopulationPrior::dimension() const {
  return 2 * problem_.space.count() + pairs() + noise_.count() + static_cast<Eigen::Index>(with_error_.size());
}

std::vector<bool> PopulationPrior::is_possible(const Eigen::MatrixXd& points) const {
  const Eigen::MatrixXd means = problem_.space.prior().from_standard_normal(points.leftCols(problem_.space.count()));
  return are_possible(problem_.space, means);
}

void PopulationPrior::require_levels(const Eigen::MatrixXd& points) const {
  noise_.require_above_zero(points.middleCols(2 * problem_.space.count() + pairs(), noise_.count()));
}

double PopulationPrior::standard_deviation(Eigen::Index parameter, double score) const {
  return scale_(parameter) * half_t_of_score(score, options_.scatter_degrees_of_freedom);
}

Eigen::VectorXd PopulationPrior::standard_deviations(double probability) const {
  const double score = standard_normal_quantile(probability);
  const double nu = options_.scatter_degrees_of_freedom;
  const bool is_lkj = options_.covariance_prior == HierarchicalOptions::CovariancePrior::lkj;
  return scale_ * (is_lkj ? half_t_of_score(score, nu) : std::sqrt(nu) / chi(-score, nu));
}

/// L L' = R of one group's correlations.
Eigen::MatrixXd PopulationPrior::lkj_factor(const std::vector<Eigen::Index>& group, const double*& correlation) const {
  const auto size = static_cast<Eigen::Index>(group.size());
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(size, size);
  factor(0, 0) = 1.0;
  for (Eigen::Index i = 1; i < size; ++i) {
    double rest = 1.0;
    for (Eigen::Index j = 0; j < i; ++j) {
      const double freedom = 2.0 * options_.correlation_shape + static_cast<double>(size - 2 - j);
      const double t = student_t_of_score(*correlation++, freedom);
      const double length = std::sqrt(freedom + t * t);
      factor(i, j) = t / length * std::sqrt(rest);
      rest *= freedom / (length * length);
    }
    factor(i, i) = std::sqrt(rest);
  }
  return factor;
}

/// @param scores  of standard deviations, then of correlations
Eigen::MatrixXd PopulationPrior::scatter_factor(const Eigen::Ref<const Eigen::VectorXd>& scores) const {
  const Eigen::Index q = problem_.space.count();
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(q, q);
  const double* correlation = scores.data() + q;
  for (const std::vector<Eigen::Index>& group : groups_) {
    const auto size = static_cast<Eigen::Index>(group.size());
    if (options_.covariance_prior == HierarchicalOptions::CovariancePrior::lkj) {
      Eigen::MatrixXd own = lkj_factor(group, correlation);
      for (Eigen::Index i = 0; i < size; ++i) {
        const Eigen::Index parameter = group[static_cast<std::size_t>(i)];
        own.row(i) *= standard_deviation(parameter, scores(parameter));
      }
      factor(group, group) = own;
      continue;
    }
    // Bartlett: B B' with an upper triangular B is Wishart with unit scale, so that A B'^-1 is a lower factor of Sigma.
    const double nu = options_.scatter_degrees_of_freedom;
    Eigen::MatrixXd bartlett = Eigen::MatrixXd::Zero(size, size);
    for (Eigen::Index i = 0; i < size; ++i) {
      bartlett(i, i) = chi(-scores(group[static_cast<std::size_t>(i)]), nu + static_cast<double>(i));
      for (Eigen::Index j = i + 1; j < size; ++j) bartlett(i, j) = *correlation++;
    }
    const Eigen::MatrixXd inverse =
        bartlett.transpose().triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(size, size));
    factor(group, group) = (std::sqrt(nu) * scale_(group)).asDiagonal() * inverse;
  }
  return factor;
}

std::vector<PopulationAt> PopulationPrior::populations(const Eigen::Ref<const Eigen::MatrixXd>& points) const {
  const Eigen::Index q = problem_.space.count();
  const Eigen::MatrixXd means =
      from_variables(problem_.space.transforms(), problem_.space.prior().from_standard_normal(points.leftCols(q)));
  const Eigen::VectorXd error_std = problem_.tests.model_error_variance().cwiseSqrt();
  std::vector<PopulationAt> populations(static_cast<std::size_t>(points.rows()));
  for (Eigen::Index row = 0; row < points.rows(); ++row) {
    PopulationAt& at = populations[static_cast<std::size_t>(row)];
    at.mean = means.row(row);
    at.factor = scatter_factor(points.row(row).segment(q, q + pairs()).transpose());
    at.levels = points.row(row).segment(2 * q + pairs(), noise_.count());
    for (double& level : at.levels) level = noise_.level(level);
    at.noise = noise_.variances(at.levels);
    at.model_error = Eigen::VectorXd::Zero(error_std.size());
    Eigen::Index place = 2 * q + pairs() + noise_.count();
    for (const Eigen::Index k : with_error_) at.model_error(k) = error_std(k) * points(row, place++);
  }
  return populations;
}

std::vector<std::string> PopulationPrior::names() const {
  const std::vector<std::string> parameters = problem_.space.names();
  std::vector<std::string> names;
  for (const std::string& name : parameters) names.push_back("mu:" + name);
  for (const std::string& name : parameters) names.push_back("sigma:" + name);
  for (const auto& group : groups_) {
    for (std::size_t j = 1; j < group.size(); ++j) {
      for (std::size_t i = 0; i < j; ++i) {
        names.push_back("rho:" + parameters[static_cast<std::size_t>(group[i])] + ":" +
                        parameters[static_cast<std::size_t>(group[j])]);
      }
    }
  }
  names.insert(names.end(), noise_.names().begin(), noise_.names().end());
  for (const Eigen::Index k : with_error_) {
    names.push_back("error:" + problem_.model.outputs()[static_cast<std::size_t>(k)].name());
  }
  return names;
}

Eigen::VectorXd PopulationPrior::values(const PopulationAt& population) const {
  const Eigen::Index q = problem_.space.count();
  const Eigen::MatrixXd covariance = population.factor * population.factor.transpose();
  Eigen::VectorXd values(dimension());
  values.head(q) = population.mean;
  values.segment(q, q) = covariance.diagonal().cwiseSqrt();
  Eigen::Index place = 2 * q;
  for (const auto& group : groups_) {
    for (std::size_t j = 1; j < group.size(); ++j) {
      for (std::size_t i = 0; i < j; ++i) {
        values(place++) = covariance(group[i], group[j]) / (values(q + group[i]) * values(q + group[j]));
      }
    }
  }
  values.segment(place, noise_.count()) = population.levels;
  place += noise_.count();
  for (const Eigen::Index k : with_error_) values(place++) = population.model_error(k);
  return values;
}

}  // namespace mottle::updating
