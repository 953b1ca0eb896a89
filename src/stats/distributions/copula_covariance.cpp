// OpenTURNS integrates the copula on a coarse grid here (1 % off for two lognormals), hence a series of our own.
#include "stats/distributions/copula_covariance.hpp"

#include <cmath>

#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::stats {

namespace {

constexpr Eigen::Index k_terms = 200;
// The trapezoidal rule converges exponentially for a smooth function times the Gaussian; beyond 12.5 the integrand is
// below 1e-17 of its peak, and the step resolves the shortest wave of the 200th polynomial several times over.
constexpr double k_half_width = 12.5;
constexpr double k_step = 1.0 / 16.0;

/// a_k = E[X(w) h_k(w)] for k = 1 .. k_terms.
Eigen::VectorXd hermite_coefficients(const Distribution& marginal) {
  Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(k_terms);
  const int half_count = static_cast<int>(k_half_width / k_step);
  for (int node = -half_count; node <= half_count; ++node) {
    const double w = node * k_step;
    const double density = standard_normal_pdf(w);
    const double weighted = k_step * density * (marginal.from_standard_normal(w) - marginal.mean());
    double previous = 1.0;
    double current = w;
    for (Eigen::Index k = 1; k <= k_terms; ++k) {
      coefficients[k - 1] += weighted * current;
      const double order = static_cast<double>(k);
      const double next = (w * current - std::sqrt(order) * previous) / std::sqrt(order + 1.0);
      previous = current;
      current = next;
    }
  }
  return coefficients;
}

double hermite_series(const Eigen::VectorXd& a, const Eigen::VectorXd& b, double correlation) {
  double sum = 0.0;
  for (Eigen::Index k = k_terms - 1; k >= 0; --k) sum = (sum + a[k] * b[k]) * correlation;
  return sum;
}

}  // namespace

Eigen::MatrixXd copula_covariance(const std::vector<Distribution>& marginals,
                                  const Eigen::MatrixXd& copula_correlation) {
  const auto dimension = static_cast<Eigen::Index>(marginals.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(dimension, dimension);
  std::vector<Eigen::VectorXd> coefficients;
  coefficients.reserve(marginals.size());
  for (Eigen::Index i = 0; i < dimension; ++i) {
    const Distribution& marginal = marginals[static_cast<std::size_t>(i)];
    coefficients.push_back(hermite_coefficients(marginal));
    covariance(i, i) = marginal.standard_deviation() * marginal.standard_deviation();
    for (Eigen::Index j = 0; j < i; ++j) {
      covariance(i, j) = hermite_series(coefficients[static_cast<std::size_t>(i)],
                                        coefficients[static_cast<std::size_t>(j)], copula_correlation(i, j));
      covariance(j, i) = covariance(i, j);
    }
  }
  return covariance;
}

}  // namespace mottle::stats
