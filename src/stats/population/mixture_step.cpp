#include "stats/population/mixture_step.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace mottle::stats {
namespace {

/// Least variance of the common scatter, of effects whose variance in all units together is about 1: two batches of
/// identical units have a finite likelihood.
constexpr double k_least_variance = 1e-6;

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& information) {
  const CholeskyFactor factor(information);
  if (!factor.is_positive_definite()) return semidefinite_pseudo_inverse(information);
  return factor.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(information.rows(), information.cols())));
}

void keep_groups(Eigen::MatrixXd& covariance, const std::vector<int>& groups) {
  for (Eigen::Index i = 0; i < covariance.rows() && !groups.empty(); ++i) {
    for (Eigen::Index j = 0; j < covariance.cols(); ++j) {
      if (groups[static_cast<std::size_t>(i)] != groups[static_cast<std::size_t>(j)]) covariance(i, j) = 0.0;
    }
  }
}

}  // namespace

std::optional<SeenNormal> see_normal(const MixtureDesign& design, const Eigen::VectorXd& mean,
                                     const Eigen::MatrixXd& covariance) {
  constexpr double k_floor = 1e-13;
  const Eigen::Index rows = design.design.rows();
  Eigen::MatrixXd total = design.design * covariance * design.design.transpose() + design.noise;
  total.diagonal() *= 1.0 + k_floor;
  const CholeskyFactor factor(total);
  if (!factor.is_positive_definite() || !total.allFinite()) return std::nullopt;
  SeenNormal seen;
  seen.centre = design.design * mean;
  seen.root = factor.solve_lower(Eigen::MatrixXd(Eigen::MatrixXd::Identity(rows, rows)));
  seen.log_peak = -0.5 * (factor.log_determinant() + static_cast<double>(rows) * std::log(2.0 * std::numbers::pi));
  const Eigen::MatrixXd whitened = seen.root * design.design;
  seen.weighted = whitened.transpose() * seen.root;
  seen.seen = whitened.transpose() * whitened;
  return seen;
}

MixtureStep::MixtureStep(const MixtureData& data, const MixtureSettings& settings) : data_(data), settings_(settings) {
  const auto units = static_cast<Eigen::Index>(data.size());
  outlier_density_ = Eigen::VectorXd::Constant(units, -std::numeric_limits<double>::infinity());
  const OutlierPopulation& outliers = settings.outliers;
  if (!(outliers.fraction > 0.0)) return;
  std::vector<std::optional<SeenNormal>> seen;
  for (const MixtureDesign& design : data.designs) {
    seen.push_back(see_normal(design, outliers.mean, outliers.covariance));
  }
  for (std::size_t s = 0; s < data.size(); ++s) {
    const auto& own = seen[data.design_of[s]];
    if (own) {
      outlier_density_(static_cast<Eigen::Index>(s)) =
          std::log(outliers.fraction) + own->log_density(data.responses[s]);
    }
  }
}

bool MixtureStep::expect(MixtureFit& fit) {
  const auto components = static_cast<Eigen::Index>(fit.components.size());
  const auto units = static_cast<Eigen::Index>(data_.size());
  seen_.assign(fit.components.size(), {});
  for (std::size_t k = 0; k < fit.components.size(); ++k) {
    for (const MixtureDesign& design : data_.designs) {
      auto seen = see_normal(design, fit.components[k].mean, fit.components[k].covariance);
      if (!seen) return false;
      seen_[k].push_back(*std::move(seen));
    }
  }
  fit.probabilities.resize(units, components + 1);
  fit.log_likelihood = 0.0;
  const double belonging = std::log1p(-settings_.outliers.fraction);
  for (Eigen::Index s = 0; s < units; ++s) {
    const auto unit = static_cast<std::size_t>(s);
    const Eigen::VectorXd& response = data_.responses[unit];
    for (Eigen::Index k = 0; k < components; ++k) {
      const SeenNormal& seen = seen_[static_cast<std::size_t>(k)][data_.design_of[unit]];
      double square = 0.0;
      for (Eigen::Index i = 0; i < response.size(); ++i) {
        double sum = 0.0;
        for (Eigen::Index j = 0; j <= i; ++j) sum += seen.root(i, j) * (response(j) - seen.centre(j));
        square += sum * sum;
      }
      fit.probabilities(s, k) =
          belonging + std::log(fit.components[static_cast<std::size_t>(k)].weight) + seen.log_peak - 0.5 * square;
    }
    fit.probabilities(s, components) = outlier_density_(s);
    const double highest = fit.probabilities.row(s).maxCoeff();
    fit.probabilities.row(s) = (fit.probabilities.row(s).array() - highest).exp();
    const double sum = fit.probabilities.row(s).sum();
    fit.probabilities.row(s) /= sum;
    fit.log_likelihood += highest + std::log(sum);
  }
  return std::isfinite(fit.log_likelihood);
}

MixtureStep::Moments MixtureStep::moments_of(const MixtureFit& fit, Eigen::Index component) const {
  const Eigen::Index q = data_.effects();
  const MixtureComponent& old = fit.components[static_cast<std::size_t>(component)];
  const std::vector<SeenNormal>& seen = seen_[static_cast<std::size_t>(component)];
  // Sums over the units of a design, about the old mean: it is near the new one, so that nothing cancels.
  std::vector<double> sizes(data_.designs.size(), 0.0);
  std::vector<Eigen::VectorXd> sums;
  std::vector<Eigen::MatrixXd> squares;
  for (const SeenNormal& own : seen) {
    sums.emplace_back(Eigen::VectorXd::Zero(own.centre.size()));
    squares.emplace_back(Eigen::MatrixXd::Zero(own.centre.size(), own.centre.size()));
  }
  for (std::size_t s = 0; s < data_.size(); ++s) {
    const double probability = fit.probabilities(static_cast<Eigen::Index>(s), component);
    if (!(probability > 0.0)) continue;
    const std::size_t d = data_.design_of[s];
    const Eigen::VectorXd rest = data_.responses[s] - seen[d].centre;
    sizes[d] += probability;
    sums[d] += probability * rest;
    squares[d].noalias() += probability * rest * rest.transpose();
  }
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(q, q);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(q);
  for (std::size_t d = 0; d < seen.size(); ++d) {
    information += sizes[d] * seen[d].seen;
    gradient += seen[d].weighted * sums[d];
  }
  Moments moments;
  moments.mean_covariance = inverse_of(information);
  moments.mean = old.mean + moments.mean_covariance * gradient;
  if (settings_.confine) moments.mean = settings_.confine(moments.mean, information);
  const Eigen::VectorXd step = moments.mean - old.mean;
  moments.scatter = Eigen::MatrixXd::Zero(q, q);
  Eigen::MatrixXd removed = Eigen::MatrixXd::Zero(q, q);
  for (std::size_t d = 0; d < seen.size(); ++d) {
    if (!(sizes[d] > 0.0)) continue;
    const Eigen::VectorXd moved = data_.designs[d].design * step;
    const Eigen::MatrixXd about =
        squares[d] - sums[d] * moved.transpose() - moved * sums[d].transpose() + sizes[d] * moved * moved.transpose();
    moments.scatter += seen[d].weighted * about * seen[d].weighted.transpose();
    removed += sizes[d] * seen[d].seen;
    if (settings_.is_restricted) removed -= sizes[d] * seen[d].seen * moments.mean_covariance * seen[d].seen;
    moments.size += sizes[d];
  }
  moments.scatter = old.covariance * (moments.scatter - removed) * old.covariance + moments.size * old.covariance;
  moments.scatter = (0.5 * (moments.scatter + moments.scatter.transpose())).eval();
  return moments;
}

void MixtureStep::take(const std::vector<Moments>& moments, MixtureFit& fit) const {
  const Eigen::Index q = data_.effects();
  Eigen::MatrixXd pooled = Eigen::MatrixXd::Zero(q, q);
  double sizes = 0.0;
  for (const Moments& own : moments) {
    pooled += own.scatter;
    sizes += own.size;
  }
  pooled /= sizes;
  keep_groups(pooled, settings_.covariance_groups);
  fit.mean_covariances.clear();
  const double nu = settings_.prior_weight;
  for (std::size_t k = 0; k < moments.size(); ++k) {
    MixtureComponent& component = fit.components[k];
    component.weight = moments[k].size / sizes;
    component.mean = moments[k].mean;
    component.covariance = moments[k].scatter / moments[k].size;
    if (settings_.has_common_covariance) {
      component.covariance = pooled;
    } else if (nu > 0.0) {
      component.covariance = (moments[k].scatter + nu * pooled) / (moments[k].size + nu);
    }
    if (nu > 0.0) component.covariance.diagonal().array() += k_least_variance * nu / (moments[k].size + nu);
    keep_groups(component.covariance, settings_.covariance_groups);
    fit.mean_covariances.push_back(moments[k].mean_covariance);
  }
}

bool MixtureStep::maximise(MixtureFit& fit) const {
  std::vector<Moments> moments;
  for (std::size_t k = 0; k < fit.components.size(); ++k) {
    moments.push_back(moments_of(fit, static_cast<Eigen::Index>(k)));
    if (!(moments.back().size > 1.0) || !moments.back().scatter.allFinite()) return false;
  }
  take(moments, fit);
  return true;
}

bool MixtureStep::begin(const Eigen::MatrixXd& points, MixtureFit& fit) const {
  std::vector<Moments> moments;
  const auto components = static_cast<std::size_t>(fit.probabilities.cols());
  fit.components.assign(components, {});
  for (std::size_t k = 0; k < components; ++k) {
    const Eigen::VectorXd own = fit.probabilities.col(static_cast<Eigen::Index>(k));
    Moments now;
    now.size = own.sum();
    if (!(now.size > 1.0)) return false;
    now.mean = points.transpose() * own / now.size;
    const Eigen::MatrixXd rest = points.rowwise() - now.mean.transpose();
    now.scatter = rest.transpose() * own.asDiagonal() * rest;
    moments.push_back(std::move(now));
  }
  take(moments, fit);
  return true;
}

}  // namespace mottle::stats
