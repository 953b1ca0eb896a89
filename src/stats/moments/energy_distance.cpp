#include "mottle/stats/moments/energy_distance.hpp"

#include "mottle/core/error.hpp"

namespace mottle::stats {
namespace {

/// Distances from one point to every sample.
Eigen::ArrayXd distances(const Eigen::Ref<const Eigen::MatrixXd>& samples,
                         const Eigen::Ref<const Eigen::RowVectorXd>& point) {
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(samples.rows());
  for (Eigen::Index k = 0; k < samples.cols(); ++k) squares += (samples.col(k).array() - point(k)).square();
  return squares.sqrt();
}

double mean_distance(const Eigen::Ref<const Eigen::MatrixXd>& first, const Eigen::Ref<const Eigen::MatrixXd>& second) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < second.rows(); ++i) sum += distances(first, second.row(i)).sum();
  return sum / (static_cast<double>(first.rows()) * static_cast<double>(second.rows()));
}

/// Of a sample with itself: each pair once.
double mean_own_distance(const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i + 1 < samples.rows(); ++i) {
    sum += distances(samples.bottomRows(samples.rows() - 1 - i), samples.row(i)).sum();
  }
  const auto count = static_cast<double>(samples.rows());
  return 2.0 * sum / (count * count);
}

}  // namespace

double energy_distance(const Eigen::Ref<const Eigen::MatrixXd>& first,
                       const Eigen::Ref<const Eigen::MatrixXd>& second) {
  require(first.rows() >= 1 && second.rows() >= 1 && first.cols() == second.cols(),
          "energy distance: {} x {} and {} x {} values, need at least a row each and the same columns", first.rows(),
          first.cols(), second.rows(), second.cols());
  return 2.0 * mean_distance(first, second) - mean_own_distance(first) - mean_own_distance(second);
}

Eigen::MatrixXd mean_unit_vectors(const Eigen::Ref<const Eigen::MatrixXd>& first,
                                  const Eigen::Ref<const Eigen::MatrixXd>& second) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(first.rows(), first.cols());
  for (Eigen::Index i = 0; i < second.rows(); ++i) {
    const Eigen::ArrayXd length = distances(first, second.row(i));
    const Eigen::ArrayXd inverse = (length > 0.0).select(length.inverse(), 0.0);
    for (Eigen::Index k = 0; k < first.cols(); ++k) {
      sum.col(k).array() += (first.col(k).array() - second(i, k)) * inverse;
    }
  }
  return sum / static_cast<double>(second.rows());
}

}  // namespace mottle::stats
