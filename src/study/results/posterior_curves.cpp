#include "study/results/posterior_curves.hpp"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <numeric>
#include <vector>

#include "mottle/updating/estimate/sample_estimate.hpp"

namespace mottle::study {
namespace {

constexpr Eigen::Index k_max_bins = 20;
constexpr Eigen::Index k_draws_a_bin = 10;  // of a chain, at least: fewer make every chain look ragged

Eigen::MatrixXi rank_counts(const Eigen::VectorXd& values, Eigen::Index chains, Eigen::Index bins) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(),
            [&](Eigen::Index a, Eigen::Index b) { return values(a) < values(b) || (values(a) == values(b) && a < b); });
  const Eigen::Index draws = values.size() / chains;
  Eigen::MatrixXi counts = Eigen::MatrixXi::Zero(chains, bins);
  for (Eigen::Index rank = 0; rank < values.size(); ++rank) {
    ++counts(order[static_cast<std::size_t>(rank)] / draws, rank * bins / values.size());
  }
  return counts;
}

Json counts_json(const Eigen::MatrixXi& counts) {
  Json chains = Json::array();
  for (const auto& row : counts.rowwise()) chains.push_back(std::vector<int>(row.begin(), row.end()));
  return chains;
}

Json quantiles_json(const Eigen::MatrixXd& columns, const Json& probabilities) {
  Json rows = Json::array();
  for (const auto& column : columns.colwise()) {
    std::vector<double> known;
    std::copy_if(column.begin(), column.end(), std::back_inserter(known),
                 [](double value) { return std::isfinite(value); });
    const auto count = static_cast<Eigen::Index>(known.size());
    Json row = Json::array();
    for (const Json& probability : probabilities) {
      row.push_back(known.empty()
                        ? Json(nullptr)
                        : number_json(weighted_quantile(
                              Eigen::Map<const Eigen::VectorXd>(known.data(), count),
                              Eigen::VectorXd::Constant(count, 1.0 / static_cast<double>(count)), probability)));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Json rank_histograms(const SampledPosterior& posterior) {
  const Eigen::Index bins = std::clamp<Eigen::Index>(posterior.draws / k_draws_a_bin, 1, k_max_bins);
  constexpr double k_tail = 0.025;
  const boost::math::binomial count(static_cast<double>(posterior.draws), 1.0 / static_cast<double>(bins));
  Json counts = Json::array();
  for (const auto& column : posterior.values.colwise()) {
    counts.push_back(counts_json(rank_counts(column, posterior.chains, bins)));
  }
  counts.push_back(counts_json(rank_counts(posterior.log_likelihood, posterior.chains, bins)));
  return {{"bins", bins},
          {"expected_range", {quantile(count, k_tail), quantile(complement(count, k_tail))}},
          {"counts", std::move(counts)}};
}

Json predictive_quantiles(const SampledPosterior& posterior) {
  if (posterior.outputs.size() == 0) return nullptr;
  const Json probabilities = {0.025, 0.16, 0.5, 0.84, 0.975};
  return {{"probabilities", probabilities},
          {"outputs", quantiles_json(posterior.outputs, probabilities)},
          {"tests", quantiles_json(posterior.replicates, probabilities)}};
}

}  // namespace mottle::study
