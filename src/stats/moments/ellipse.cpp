#include "mottle/stats/moments/ellipse.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mottle/core/error.hpp"

namespace mottle::stats {

Ellipse sigma_ellipse(const Eigen::Ref<const Eigen::VectorXd>& mean,
                      const Eigen::Ref<const Eigen::MatrixXd>& covariance, double sigmas) {
  require(mean.size() == 2 && covariance.rows() == 2 && covariance.cols() == 2,
          "ellipse: mean of {} and covariance {} x {}, must be of two variables", mean.size(), covariance.rows(),
          covariance.cols());
  require(sigmas > 0.0 && std::isfinite(sigmas), "sigmas: {} must be positive", sigmas);
  require(mean.allFinite() && covariance.allFinite(), "ellipse: an entry is not finite");
  const double a = covariance(0, 0);
  const double b = covariance(1, 1);
  const double c = 0.5 * covariance(0, 1) + 0.5 * covariance(1, 0);
  const double geometric_mean = std::sqrt(std::abs(a)) * std::sqrt(std::abs(b));
  require(a >= 0.0 && b >= 0.0 && std::abs(c) <= (1.0 + 1e-10) * geometric_mean,
          "covariance: [{}, {}; {}, {}] is not positive semi-definite", a, c, c, b);

  const double major_variance = 0.5 * (a + b) + std::hypot(0.5 * (a - b), c);
  // The determinant over the larger eigenvalue: the difference of two nearly equal numbers has no digits left.
  const double determinant = std::max(0.0, (geometric_mean - c) * (geometric_mean + c));
  Ellipse ellipse;
  ellipse.centre = mean;
  ellipse.semi_major = sigmas * std::sqrt(major_variance);
  ellipse.semi_minor = major_variance > 0.0 ? sigmas * std::sqrt(determinant / major_variance) : 0.0;
  ellipse.angle = 0.5 * std::atan2(2.0 * c, a - b);
  if (ellipse.angle <= -0.5 * std::numbers::pi) ellipse.angle += std::numbers::pi;  // c = -0.0
  return ellipse;
}

std::vector<Ellipse> pairwise_ellipses(const Eigen::Ref<const Eigen::VectorXd>& mean,
                                       const Eigen::Ref<const Eigen::MatrixXd>& covariance, double sigmas) {
  require(covariance.rows() == mean.size() && covariance.cols() == mean.size(), "covariance: {} x {} for {} variables",
          covariance.rows(), covariance.cols(), mean.size());
  std::vector<Ellipse> ellipses;
  for (Eigen::Index i = 0; i < mean.size(); ++i) {
    for (Eigen::Index j = i + 1; j < mean.size(); ++j) {
      Eigen::Matrix2d pair;
      pair << covariance(i, i), covariance(i, j), covariance(j, i), covariance(j, j);
      ellipses.push_back(sigma_ellipse(Eigen::Vector2d(mean[i], mean[j]), pair, sigmas));
      ellipses.back().first = static_cast<int>(i);
      ellipses.back().second = static_cast<int>(j);
    }
  }
  return ellipses;
}

}  // namespace mottle::stats
