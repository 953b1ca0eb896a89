#include "updating/sampling/stage_correlation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::updating {
namespace {

/// Blom's normal scores of the ranks 1 to n.
std::vector<double> normal_scores(Eigen::Index count) {
  std::vector<double> scores;
  for (Eigen::Index rank = 1; rank <= count; ++rank)
    scores.push_back(
        standard_normal_quantile((static_cast<double>(rank) - 0.375) / (static_cast<double>(count) + 0.25)));
  return scores;
}

/// Scores of values, the mean of their scores for equal ones; then centred and of length 1, or 0 where all are equal.
Eigen::VectorXd unit_scores(const Eigen::Ref<const Eigen::VectorXd>& values, const std::vector<double>& of_ranks) {
  std::vector<std::pair<double, Eigen::Index>> order;
  order.reserve(of_ranks.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) order.emplace_back(values(i), i);
  std::sort(order.begin(), order.end());
  Eigen::VectorXd scores(values.size());
  for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
    double sum = 0.0;
    for (end = first; end < order.size() && order[end].first == order[first].first; ++end) sum += of_ranks[end];
    for (std::size_t k = first; k < end; ++k) scores(order[k].second) = sum / static_cast<double>(end - first);
  }
  scores.array() -= scores.mean();
  const double length = scores.norm();
  return length > 0.0 ? Eigen::VectorXd(scores / length) : Eigen::VectorXd::Zero(values.size());
}

double median_of(Eigen::VectorXd values) {
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

StageStart::StageStart(const Eigen::Ref<const Eigen::MatrixXd>& points,
                       const Eigen::Ref<const Eigen::VectorXd>& log_likelihood)
    : scores_of_ranks_(normal_scores(points.rows())),
      medians_(points.cols()),
      scores_(points.rows(), 2 * points.cols() + 1) {
  for (Eigen::Index j = 0; j < points.cols(); ++j) {
    medians_(j) = median_of(points.col(j));
    scores_.col(2 * j) = unit_scores(points.col(j), scores_of_ranks_);
    scores_.col(2 * j + 1) = unit_scores((points.col(j).array() - medians_(j)).abs(), scores_of_ranks_);
  }
  scores_.rightCols(1) = unit_scores(log_likelihood, scores_of_ranks_);
}

double StageStart::correlation_with(const Eigen::Ref<const Eigen::MatrixXd>& points,
                                    const Eigen::Ref<const Eigen::VectorXd>& log_likelihood) const {
  const auto correlation = [&](Eigen::Index column, const Eigen::Ref<const Eigen::VectorXd>& values) {
    return std::abs(scores_.col(column).dot(unit_scores(values, scores_of_ranks_)));
  };
  double largest = correlation(scores_.cols() - 1, log_likelihood);
  for (Eigen::Index j = 0; j < points.cols(); ++j) {
    largest = std::max({largest, correlation(2 * j, points.col(j)),
                        correlation(2 * j + 1, (points.col(j).array() - medians_(j)).abs())});
  }
  return largest;
}

}  // namespace mottle::updating
