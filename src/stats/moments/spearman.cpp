#include "mottle/stats/moments/spearman.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "mottle/core/error.hpp"

namespace mottle::stats {

Eigen::VectorXd average_ranks(const Eigen::Ref<const Eigen::VectorXd>& values) {
  const auto count = static_cast<std::size_t>(values.size());
  std::vector<std::pair<double, Eigen::Index>> sorted(count);
  for (Eigen::Index i = 0; i < values.size(); ++i) sorted[static_cast<std::size_t>(i)] = {values[i], i};
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  Eigen::VectorXd ranks(values.size());
  for (std::size_t first = 0; first < count;) {
    std::size_t end = first + 1;
    while (end < count && sorted[end].first == sorted[first].first) ++end;
    // Positions first .. end - 1 carry the ranks first + 1 .. end.
    const double shared = 0.5 * static_cast<double>(first + 1 + end);
    for (std::size_t i = first; i < end; ++i) ranks[sorted[i].second] = shared;
    first = end;
  }
  return ranks;
}

namespace {

/// Ranks of each column, centred and scaled to length 1; zero for a constant column.
Eigen::MatrixXd unit_ranks(const Eigen::Ref<const Eigen::MatrixXd>& values) {
  require(!values.array().isNaN().any(), "rank correlation: an entry is nan");
  Eigen::MatrixXd ranks(values.rows(), values.cols());
  const double mean_rank = 0.5 * static_cast<double>(values.rows() + 1);
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    ranks.col(j) = average_ranks(values.col(j)).array() - mean_rank;
    const double length = ranks.col(j).norm();
    if (length > 0.0) ranks.col(j) /= length;
  }
  return ranks;
}

}  // namespace

Eigen::MatrixXd spearman(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                         const Eigen::Ref<const Eigen::MatrixXd>& outputs) {
  require(inputs.rows() == outputs.rows(), "rank correlation: {} rows of inputs but {} rows of outputs", inputs.rows(),
          outputs.rows());
  require(inputs.rows() >= 2, "rank correlation: {} rows, need at least 2", inputs.rows());
  const Eigen::MatrixXd correlation = unit_ranks(inputs).transpose() * unit_ranks(outputs);
  return correlation.cwiseMax(-1.0).cwiseMin(1.0);
}

}  // namespace mottle::stats
