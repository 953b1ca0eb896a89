#include "mottle/stats/chains/leave_one_out.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "mottle/core/error.hpp"

namespace mottle::stats {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

double log_sum_exp(const Eigen::Ref<const Eigen::ArrayXd>& logs) {
  const double largest = logs.maxCoeff();
  return largest + std::log((logs - largest).exp().sum());
}

struct ParetoFit {
  double shape = 0.0;
  double scale = 0.0;
};

/// Generalised Pareto distribution of excesses over 0: the mean of the profile posterior of [Zhang2009], its shape
/// drawn towards 1/2 as by ten observations.
///
/// @param excesses  ascending, >= 0
ParetoFit fit_pareto(const Eigen::ArrayXd& excesses) {
  constexpr double k_prior = 3.0;
  constexpr double k_prior_weight = 10.0;
  constexpr double k_prior_shape = 0.5;
  const Eigen::Index count = excesses.size();
  const auto n = static_cast<double>(count);
  const double quartile = excesses(static_cast<Eigen::Index>(std::floor(n / 4.0 + 0.5)) - 1);
  const Eigen::Index points = 30 + static_cast<Eigen::Index>(std::floor(std::sqrt(n)));
  const Eigen::ArrayXd number = Eigen::ArrayXd::LinSpaced(points, 0.5, static_cast<double>(points) - 0.5);
  const Eigen::ArrayXd theta =
      1.0 / excesses(count - 1) + (1.0 - (static_cast<double>(points) / number).sqrt()) / (k_prior * quartile);
  Eigen::ArrayXd logs(points);
  for (Eigen::Index j = 0; j < points; ++j) {
    const double shape = (-theta(j) * excesses).log1p().mean();
    logs(j) = n * (std::log(-theta(j) / shape) - shape - 1.0);
  }
  const double best = (theta * (logs - log_sum_exp(logs)).exp()).sum();
  const double shape = (-best * excesses).log1p().mean();
  return {(n * shape + k_prior_weight * k_prior_shape) / (n + k_prior_weight), -shape / best};
}

/// Smooths the largest of logarithms of weights, whose maximum is 0; returns the shape.
double smooth_tail(Eigen::ArrayXd& logs, Eigen::Index tail) {
  constexpr Eigen::Index k_min_tail = 5;
  constexpr double k_alike = 1e-17;
  if (tail < k_min_tail) return k_infinity;
  std::vector<Eigen::Index> order(static_cast<std::size_t>(logs.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(),
            [&](Eigen::Index a, Eigen::Index b) { return logs(a) < logs(b) || (logs(a) == logs(b) && a < b); });
  const Eigen::Index* const largest = order.data() + order.size() - tail;
  if (logs(largest[tail - 1]) - logs(largest[0]) < k_alike) return 0.0;
  const double cut = std::exp(logs(largest[-1]));
  Eigen::ArrayXd excesses(tail);
  for (Eigen::Index k = 0; k < tail; ++k) excesses(k) = std::exp(logs(largest[k])) - cut;
  const ParetoFit fit = fit_pareto(excesses);
  if (!std::isfinite(fit.shape) || !std::isfinite(fit.scale)) return k_infinity;
  for (Eigen::Index k = 0; k < tail; ++k) {
    const double p = (static_cast<double>(k) + 0.5) / static_cast<double>(tail);
    const double excess = fit.scale * std::expm1(-fit.shape * std::log1p(-p)) / fit.shape;
    logs(largest[k]) = std::min(std::log(cut + excess), 0.0);
  }
  return fit.shape;
}

/// How many of the weights count as the largest.
Eigen::Index tail_of(double draws, double relative_efficiency) {
  const double r = relative_efficiency > 0.0 ? relative_efficiency : 1.0;
  return static_cast<Eigen::Index>(std::ceil(std::min(0.2 * draws, 3.0 * std::sqrt(draws / r))));
}

void require_draws(const Eigen::Ref<const Eigen::MatrixXd>& log_likelihood, Eigen::Index least) {
  require(log_likelihood.cols() >= 1 && log_likelihood.rows() >= least,
          "log_likelihood: {} draws of {} data, need at least {} draws of one", log_likelihood.rows(),
          log_likelihood.cols(), least);
  require(log_likelihood.allFinite(), "log_likelihood: an entry is not finite");
}

/// Sum and standard error of `pointwise`, and how far it is below the densities in sample.
void add_up(const Eigen::Ref<const Eigen::MatrixXd>& log_likelihood, PredictiveAccuracy& found) {
  const auto n = static_cast<double>(found.pointwise.size());
  double in_sample = 0.0;
  for (Eigen::Index i = 0; i < log_likelihood.cols(); ++i) {
    in_sample += log_sum_exp(log_likelihood.col(i).array()) - std::log(static_cast<double>(log_likelihood.rows()));
  }
  found.elpd = found.pointwise.sum();
  found.effective_parameters = in_sample - found.elpd;
  found.standard_error = n > 1.0 ? std::sqrt(n * (found.pointwise.array() - found.elpd / n).square().sum() / (n - 1.0))
                                 : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

double pareto_k_of(const Eigen::Ref<const Eigen::ArrayXd>& log_weights) {
  Eigen::ArrayXd logs = log_weights - log_weights.maxCoeff();
  return smooth_tail(logs, tail_of(static_cast<double>(logs.size()), 1.0));
}

LeaveOneOut leave_one_out(const Eigen::Ref<const Eigen::MatrixXd>& log_likelihood,
                          const Eigen::Ref<const Eigen::VectorXd>& relative_efficiency) {
  require_draws(log_likelihood, 1);
  require(relative_efficiency.size() == log_likelihood.cols(), "relative_efficiency: {} entries for {} data",
          relative_efficiency.size(), log_likelihood.cols());
  const auto draws = static_cast<double>(log_likelihood.rows());
  LeaveOneOut found;
  found.pointwise.resize(log_likelihood.cols());
  found.pareto_k.resize(log_likelihood.cols());
  for (Eigen::Index i = 0; i < log_likelihood.cols(); ++i) {
    Eigen::ArrayXd logs = -log_likelihood.col(i).array();
    logs -= logs.maxCoeff();
    found.pareto_k(i) = smooth_tail(logs, tail_of(draws, relative_efficiency(i)));
    found.pointwise(i) = log_sum_exp(logs + log_likelihood.col(i).array()) - log_sum_exp(logs);
  }
  add_up(log_likelihood, found);
  return found;
}

PredictiveAccuracy widely_applicable_information(const Eigen::Ref<const Eigen::MatrixXd>& log_likelihood) {
  require_draws(log_likelihood, 2);
  const auto draws = static_cast<double>(log_likelihood.rows());
  PredictiveAccuracy found;
  found.pointwise.resize(log_likelihood.cols());
  for (Eigen::Index i = 0; i < log_likelihood.cols(); ++i) {
    const auto logs = log_likelihood.col(i).array();
    const double variance = (logs - logs.mean()).square().sum() / (draws - 1.0);
    found.pointwise(i) = log_sum_exp(logs) - std::log(draws) - variance;
  }
  add_up(log_likelihood, found);
  return found;
}

}  // namespace mottle::stats
