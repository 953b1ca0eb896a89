#include "mottle/stats/outliers.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <cmath>
#include <numeric>

#include "mottle/stats/descriptive.hpp"

namespace mottle {
namespace {

/// Squared Mahalanobis distances in the directions in which the samples scatter, and how many those are.
std::pair<Eigen::VectorXd, Eigen::Index> squared_distances(const Eigen::MatrixXd& samples) {
  constexpr double k_no_scatter = 1e-10;
  const Eigen::RowVectorXd mean = samples.colwise().mean();
  const Eigen::VectorXd deviation = sample_standard_deviation(samples);
  const Eigen::VectorXd scale = (deviation.array() > 0.0).select(deviation.cwiseInverse(), 0.0);
  const Eigen::MatrixXd centred = (samples.rowwise() - mean) * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(centred.transpose() * centred /
                                                              static_cast<double>(samples.rows() - 1));
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(samples.rows());
  Eigen::Index rank = 0;
  for (Eigen::Index k = 0; k < solver.eigenvalues().size(); ++k) {
    const double variance = solver.eigenvalues()(k);
    if (!(variance > k_no_scatter * solver.eigenvalues().maxCoeff())) continue;
    squares += (centred * solver.eigenvectors().col(k)).cwiseAbs2() / variance;
    ++rank;
  }
  return {squares, rank};
}

}  // namespace

std::vector<Outlier> find_outliers(const Eigen::Ref<const Eigen::MatrixXd>& samples, double level) {
  std::vector<Eigen::Index> left(static_cast<std::size_t>(samples.rows()));
  std::iota(left.begin(), left.end(), Eigen::Index{0});
  std::vector<Outlier> outliers;
  const std::size_t most = left.size() / 3;
  while (outliers.size() < most && static_cast<Eigen::Index>(left.size()) >= samples.cols() + 3) {
    const auto [squares, rank] = squared_distances(samples(left, Eigen::all));
    const auto n = static_cast<double>(left.size());
    const double half_freedom = 0.5 * (n - static_cast<double>(rank) - 1.0);
    if (rank == 0 || half_freedom <= 0.0) break;
    Eigen::Index farthest = 0;
    const double square = squares.maxCoeff(&farthest);
    const boost::math::beta_distribution<double> law(0.5 * static_cast<double>(rank), half_freedom);
    const double p_value =
        std::min(1.0, n * boost::math::cdf(complement(law, std::min(n * square / ((n - 1.0) * (n - 1.0)), 1.0))));
    if (p_value > level) break;
    const auto place = left.begin() + static_cast<std::ptrdiff_t>(farthest);
    outliers.push_back({*place, std::sqrt(square), p_value});
    left.erase(place);
  }
  return outliers;
}

}  // namespace mottle
