#include "mottle/stats/chains/chain_diagnostics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/quantiles.hpp"

namespace mottle::stats {
namespace {

constexpr Eigen::Index k_min_draws = 4;
constexpr double k_unknown = std::numeric_limits<double>::quiet_NaN();

bool tells_nothing(const Eigen::MatrixXd& draws) {
  return draws.rows() < k_min_draws || draws.cols() == 0 || !draws.allFinite() || draws.maxCoeff() == draws.minCoeff();
}

/// First and second half of each chain; the middle draw of an odd number is left out.
Eigen::MatrixXd split(const Eigen::MatrixXd& draws) {
  const Eigen::Index half = draws.rows() / 2;
  Eigen::MatrixXd halves(half, 2 * draws.cols());
  for (Eigen::Index c = 0; c < draws.cols(); ++c) {
    halves.col(2 * c) = draws.col(c).head(half);
    halves.col(2 * c + 1) = draws.col(c).tail(half);
  }
  return halves;
}

/// Normal scores of the ranks among all draws; equal draws share the mean of their ranks.
Eigen::MatrixXd normal_scores(const Eigen::MatrixXd& draws) {
  const Eigen::Index count = draws.size();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const double* values = draws.data();
  std::sort(order.begin(), order.end(), [values](Eigen::Index a, Eigen::Index b) {
    return values[a] < values[b] || (values[a] == values[b] && a < b);
  });
  Eigen::MatrixXd scores(draws.rows(), draws.cols());
  for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
    end = first + 1;
    while (end < order.size() && values[order[end]] == values[order[first]]) ++end;
    const double rank = 0.5 * static_cast<double>(first + 1 + end);
    const double score = standard_normal_quantile((rank - 0.375) / (static_cast<double>(count) + 0.25));
    for (std::size_t k = first; k < end; ++k) scores.data()[order[k]] = score;
  }
  return scores;
}

double quantile_of(const Eigen::MatrixXd& draws, double probability) {
  return quantile({draws.data(), draws.data() + draws.size()}, probability, QuantileRule::ends);
}

double mean_of_variances(const Eigen::MatrixXd& chains) {
  const Eigen::MatrixXd apart = chains.rowwise() - chains.colwise().mean();
  return apart.squaredNorm() / static_cast<double>((chains.rows() - 1) * chains.cols());
}

double variance_of_means(const Eigen::MatrixXd& chains) {
  if (chains.cols() < 2) return 0.0;
  const Eigen::RowVectorXd means = chains.colwise().mean();
  return (means.array() - means.mean()).square().sum() / static_cast<double>(chains.cols() - 1);
}

double r_hat(const Eigen::MatrixXd& chains) {
  const auto n = static_cast<double>(chains.rows());
  const double within = mean_of_variances(chains);
  return within > 0.0 ? std::sqrt(variance_of_means(chains) / within + (n - 1.0) / n) : k_unknown;
}

/// Autocorrelations of several chains together, each computed when it is asked for.
class Autocorrelation {
 public:
  explicit Autocorrelation(const Eigen::MatrixXd& chains)
      : apart_(chains.rowwise() - chains.colwise().mean()), within_(mean_of_variances(chains)) {
    const auto n = static_cast<double>(chains.rows());
    total_ = within_ * (n - 1.0) / n + variance_of_means(chains);
  }
  double at(Eigen::Index lag) const {
    const Eigen::Index n = apart_.rows();
    const double sum = (apart_.topRows(n - lag).array() * apart_.bottomRows(n - lag).array()).sum();
    return 1.0 - (within_ - sum / static_cast<double>(n * apart_.cols())) / total_;
  }

 private:
  Eigen::MatrixXd apart_;
  double within_ = 0.0;
  double total_ = 0.0;
};

/// Sum over Geyer's initial monotone sequence.
double autocorrelation_time(const Eigen::MatrixXd& chains) {
  const Eigen::Index n = chains.rows();
  const Autocorrelation rho(chains);
  double even = 1.0;
  double odd = rho.at(1);
  std::vector<double> kept{even, odd};
  Eigen::Index t = 0;
  while (t < n - 5 && even + odd > 0.0) {
    t += 2;
    even = rho.at(t);
    odd = rho.at(t + 1);
    kept.resize(static_cast<std::size_t>(t) + 2, 0.0);
    if (even + odd >= 0.0) {
      kept[static_cast<std::size_t>(t)] = even;
      kept[static_cast<std::size_t>(t) + 1] = odd;
    }
  }
  const auto last = static_cast<std::size_t>(t);
  if (even > 0.0) kept[last] = even;
  for (std::size_t k = 2; k + 2 <= last; k += 2) {
    const double before = kept[k - 2] + kept[k - 1];
    if (kept[k] + kept[k + 1] > before) kept[k] = kept[k + 1] = 0.5 * before;
  }
  double sum = 0.0;
  for (std::size_t k = 0; k < last; ++k) sum += kept[k];
  return -1.0 + 2.0 * sum + kept[last];
}

double effective_sample_size(const Eigen::MatrixXd& chains) {
  if (chains.maxCoeff() == chains.minCoeff() || chains.rows() < 3) return k_unknown;
  const auto count = static_cast<double>(chains.size());
  return count / std::max(autocorrelation_time(chains), 1.0 / std::log10(count));
}

double effective_sample_size_of_quantile(const Eigen::MatrixXd& draws, double probability) {
  const double quantile = quantile_of(draws, probability);
  const Eigen::MatrixXd is_below = (draws.array() <= quantile).cast<double>();
  return effective_sample_size(split(is_below));
}

}  // namespace

double rank_normalised_r_hat(const Eigen::Ref<const Eigen::MatrixXd>& draws) {
  if (tells_nothing(draws)) return k_unknown;
  const Eigen::MatrixXd folded = (draws.array() - quantile_of(draws, 0.5)).abs();
  return std::max(r_hat(normal_scores(split(draws))), r_hat(normal_scores(split(folded))));
}

double bulk_effective_sample_size(const Eigen::Ref<const Eigen::MatrixXd>& draws) {
  return tells_nothing(draws) ? k_unknown : effective_sample_size(normal_scores(split(draws)));
}

double tail_effective_sample_size(const Eigen::Ref<const Eigen::MatrixXd>& draws) {
  constexpr double k_tail = 0.05;
  if (tells_nothing(draws)) return k_unknown;
  const double low = effective_sample_size_of_quantile(draws, k_tail);
  const double high = effective_sample_size_of_quantile(draws, 1.0 - k_tail);
  return std::isnan(low) || std::isnan(high) ? k_unknown : std::min(low, high);
}

}  // namespace mottle::stats
